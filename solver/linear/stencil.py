"""Galerkin entries between hats in the bulk: one stencil for all of them.

Where all particles of two hats' supports are the bulk's, the entry between the hats depends on
how far apart their nodes are. With K's coupling K_o to the neighbour at offset o and the overlap
R(s) = Σ φ(k) φ(k + s) of two hats that are s apart,

    entry(Δ) = Σ_o K_o R(o − Δ), o = 0 included, Δ the cells from one node to the other.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse

from ..arrays import Array, Indices
from ..operators import BondOperator
from ..operators.blocks import bond_blocks
from .coarse_grid import CoarseGrid


def entries(operator: BondOperator, phase: int, grid: CoarseGrid, window: tuple[int, int]) -> Array:
    """Entries between a hat and those up to `window` rows and columns of nodes away.

    Returns
    -------
    ndarray, shape (2 window[0] + 1, 2 window[1] + 1, c, c)
        By how many rows and columns of nodes the other hat is further on.
    """
    family = operator.bonds.family
    own = operator.moduli.each[phase]
    couplings = np.concatenate([operator.bulk_blocks[phase][None], bond_blocks(family, own)[1]])
    offsets = np.concatenate([np.zeros((1, 2), dtype=np.int64), family.offsets])
    row, column = (np.arange(-far, far + 1) for far in window)
    away = np.stack(
        [grid.along[axis] * column + grid.across[axis] * row[:, None] for axis in range(2)],
        axis=-1,
    )
    apart = offsets - away[:, :, None]
    overlap = _overlap(grid)
    middle = np.array(overlap.shape)[::-1] // 2
    far = np.abs(apart).max(axis=(0, 1, 2)) - middle
    overlap = np.pad(overlap, [(max(0, far[1]),) * 2, (max(0, far[0]),) * 2])
    middle = np.array(overlap.shape)[::-1] // 2
    x, y = np.moveaxis(apart + middle, -1, 0)
    return np.asarray(np.einsum("rko,oab->rkab", overlap[y, x], couplings))


def _overlap(grid: CoarseGrid) -> Array:
    """R(s) by rows and columns of s, zero in the middle."""
    hat = grid.hat
    if grid.rectangular:
        along, up = (hat[hat.shape[0] // 2], hat[:, hat.shape[1] // 2])
        return np.outer(*(np.correlate(axis, axis, "full") for axis in (up, along)))
    height, width = hat.shape
    found = np.zeros((2 * height - 1, 2 * width - 1))
    for row, column in np.argwhere(hat):
        found[
            height - 1 - row : 2 * height - 1 - row, width - 1 - column : 2 * width - 1 - column
        ] += hat[row, column] * hat
    return found


def phases(operator: BondOperator, grid: CoarseGrid, prolongation: sparse.csr_array) -> Indices:
    """Phase of each hat if all particles of its support are the bulk's, else −1.

    Parameters
    ----------
    operator : BondOperator
    grid : CoarseGrid
    prolongation : csr_array, shape (active, hats)
    """
    found = np.full(prolongation.shape[1], -1)
    whole = np.count_nonzero(grid.hat)
    bulk = np.ones(len(operator.active), dtype=bool)
    bulk[operator.own] = False
    for number in range(len(operator.bulk)):
        mine = bulk & (operator.phase == number)
        of_each = np.repeat(mine, np.diff(prolongation.indptr))
        count = np.bincount(prolongation.indices[of_each], minlength=len(found))
        found[count == whole] = number
    return found
