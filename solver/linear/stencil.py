"""Galerkin entries between hats in the bulk: one stencil for all of them.

Where all particles of two hats' supports are the bulk's, the entry between the hats depends on
how far apart their nodes are. With K's coupling K_o to the neighbour at offset o and the overlap
R(s) = Σ φ(k) φ(k + s) of two hats along an axis,

    entry(Δ) = Σ_o K_o R(o₁ − Δ₁ h) R(o₂ − Δ₂ h), o = 0 included.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array, Indices
from ..operators import BondOperator
from ..operators import segments as runs
from ..operators.blocks import bond_blocks


def entries(operator: BondOperator, phase: int, coarsening: int, window: int) -> Array:
    """Entries between a hat and those up to `window` nodes away.

    Returns
    -------
    ndarray, shape (2 window + 1, 2 window + 1, c, c)
        By how many rows and columns of nodes the other hat is further on.
    """
    family = operator.bonds.family
    own = operator.moduli.each[phase]
    couplings = np.concatenate([operator.bulk_blocks[phase][None], bond_blocks(family, own)[1]])
    offsets = np.concatenate([np.zeros((1, 2), dtype=np.int64), family.offsets])
    hat = 1.0 - np.abs(np.arange(1 - coarsening, coarsening)) / coarsening
    reach = len(hat) - 1
    overlap = np.zeros(2 * reach + 1 + 2 * family.reach + 2 * window * coarsening)
    middle = len(overlap) // 2
    overlap[middle - reach : middle + reach + 1] = np.correlate(hat, hat, "full")
    away = coarsening * np.arange(-window, window + 1)
    along, up = (overlap[middle + axis - away[:, None]] for axis in offsets.T)
    return np.asarray(np.einsum("ro,ko,oab->rkab", up, along, couplings))


def phases(operator: BondOperator, rows: Indices, columns: Indices, coarsening: int) -> Indices:
    """Phase of the hats at some nodes if all their particles are the bulk's, else −1.

    Parameters
    ----------
    operator : BondOperator
    rows, columns : ndarray of int, shape (n,)
        Of the nodes, in coarse cells.
    coarsening : int
    """
    found = np.full(len(rows), -1)
    shape = operator.bonds.lattice.shape
    cell, size, _, kind, _, _, phase = operator.segments.astype(np.int64).T
    for number in range(len(operator.bulk)):
        mine = (kind == runs.BULK) & (phase == number)
        # Sums over rectangles of cells from sums over those that begin at the grid's corner.
        edges = np.zeros(shape[0] * shape[1] + 1, dtype=np.int64)
        np.add.at(edges, cell[mine], 1)
        np.add.at(edges, (cell + size)[mine], -1)
        whole = np.cumsum(edges[:-1]).reshape(shape)
        sums = np.zeros((shape[0] + 1, shape[1] + 1), dtype=np.int64)
        sums[1:, 1:] = whole.cumsum(axis=0).cumsum(axis=1)
        low_row, low_column = (coarsening * (axis - 1) + 1 for axis in (rows, columns))
        high_row, high_column = (coarsening * (axis + 1) for axis in (rows, columns))
        inside = (low_row >= 0) & (low_column >= 0)
        inside &= (high_row <= shape[0]) & (high_column <= shape[1])
        r0, r1, c0, c1 = (a[inside] for a in (low_row, high_row, low_column, high_column))
        area = sums[r1, c1] - sums[r0, c1] - sums[r1, c0] + sums[r0, c0]
        full = area == (2 * coarsening - 1) ** 2
        found[np.nonzero(inside)[0][full]] = number
    return found
