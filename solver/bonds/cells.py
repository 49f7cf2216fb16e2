"""The particles' cells as a surface to look at: squares that share corners where bonds are whole.

A program such as ParaView draws cells, not particles. Each particle owns a square; two neighbours
share the corners of their common side if the bond between them carries, so that cracks and broken
bonds open when the surface is warped by its displacement, and bodies that lie a cell apart stay
apart.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Mask
from .bonds import Bonds

# A cell's corners in turn, and where each cell lies about its corner: 0 below left, 1 below
# right, 2 above right, 3 above left of it.
_CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))
_SEEN_FROM = (2, 3, 0, 1)


@dataclass(frozen=True, eq=False)
class Cells:
    """Squares of a lattice, split along what does not carry.

    Attributes
    ----------
    corners : ndarray, shape (c, 2), m
        In the user's coordinates. Those that several cells share stand once; where a crack passes
        there is one a side.
    quads : ndarray of int, shape (N, 4)
        Corners of each particle's cell, anticlockwise.
    towards : ndarray, shape (N, 4)
        Its neighbours to the right, above, to the left and below; −1 where none is bonded to it.
    """

    corners: Array
    quads: NDArray[np.int64]
    towards: NDArray[np.int64]

    @classmethod
    def of(cls, bonds: Bonds) -> Cells:
        """Cells of a lattice with these bonds."""
        lattice = bonds.lattice
        right, above = _whole(bonds, (1, 0)), _whole(bonds, (0, 1))
        number = np.asarray(lattice.number())
        rows, columns = lattice.rows_columns
        grid_right, grid_above = (lattice.to_grid(w.astype(float)) != 0 for w in (right, above))
        left, below = grid_right[rows, columns - 1], grid_above[rows - 1, columns]
        towards = np.stack(
            [
                np.where(right, number[rows, columns + 1], -1),
                np.where(above, number[rows + 1, columns], -1),
                np.where(left, number[rows, columns - 1], -1),
                np.where(below, number[rows - 1, columns], -1),
            ],
            axis=1,
        )
        # About each corner of the grid: the place (0 … 3) that stands for each cell's group.
        height, width = lattice.mask.shape
        group = np.broadcast_to(np.arange(4)[:, None, None], (4, height + 1, width + 1)).copy()

        def pair(one: int, other: int, joined: Mask) -> None:
            least = np.minimum(group[one], group[other])
            group[one] = np.where(joined, least, group[one])
            group[other] = np.where(joined, least, group[other])

        padded_right = np.pad(grid_right, 1)
        padded_above = np.pad(grid_above, 1)
        for _ in range(3):
            pair(0, 1, padded_right[:-1, :-1])
            pair(3, 2, padded_right[1:, :-1])
            pair(0, 3, padded_above[:-1, :-1])
            pair(1, 2, padded_above[:-1, 1:])
        at = [(rows + dy, columns + dx) for dx, dy in _CORNERS]
        labels = np.stack(
            [
                ((r * (width + 1) + c) * 4 + group[place, r, c])
                for (r, c), place in zip(at, _SEEN_FROM, strict=True)
            ],
            axis=1,
        )
        kept, quads = np.unique(labels, return_inverse=True)
        spacing = lattice.spacing
        # Bonds know the lattice centred; who looks at the body wants it where it is.
        offset = lattice.places[0] - (np.array([columns[0], rows[0]]) + 0.5) * spacing
        row, column = np.divmod(kept // 4, width + 1)
        corners = offset + spacing * np.column_stack([column, row])
        return cls(corners, quads.reshape(-1, 4).astype(np.int64), towards)

    @cached_property
    def _shares(self) -> Array:
        """How many cells meet at each corner, shape (c,)."""
        return np.bincount(self.quads.ravel(), minlength=len(self.corners)).astype(float)

    def at_corners(self, values: Array) -> Array:
        """Values at the corners from those of the particles, exact for linear fields.

        The mean over the cells that share a corner, each carried there by its slopes between
        bonded neighbours.

        Parameters
        ----------
        values : ndarray, shape (N,) or (N, k)

        Returns
        -------
        ndarray, shape (c,) or (c, k)
        """
        slope_x = self._slope(values, 0, 2)
        slope_y = self._slope(values, 1, 3)
        found = np.zeros((len(self.corners), *values.shape[1:]))
        for k, (dx, dy) in enumerate(_CORNERS):
            carried = values + (dx - 0.5) * slope_x + (dy - 0.5) * slope_y
            np.add.at(found, self.quads[:, k], carried)
        shares = self._shares
        return found / (shares if found.ndim == 1 else shares[:, None])

    def _slope(self, values: Array, ahead: int, behind: int) -> Array:
        """Difference a cell in one direction, one-sided at edges, zero without a neighbour."""
        ends = self.towards[:, [ahead, behind]]
        there = ends >= 0
        shape = (-1,) + (1,) * (values.ndim - 1)
        difference: Any = 0.0
        for column, sign in ((0, 1.0), (1, -1.0)):
            known = there[:, column].reshape(shape)
            difference = difference + sign * np.where(known, values[ends[:, column]] - values, 0.0)
        return np.asarray(difference / np.maximum(there.sum(axis=1), 1).reshape(shape))


def _whole(bonds: Bonds, step: tuple[int, int]) -> Mask:
    """Whether each particle's bond to the neighbour at (dx, dy) carries, shape (N,)."""
    # A horizon is a cell at least: nearest neighbours are always there.
    which = np.flatnonzero((bonds.family.offsets == np.array(step)).all(axis=1))[0]
    whole = bonds.strength(int(which)) != 0
    if bonds.phases is not None and bonds.body is not None:
        # Across an interface neighbours are joined by its nodes, if the body does not end there.
        (dx, dy), lattice = step, bonds.lattice
        rows, columns = lattice.rows_columns
        there = lattice.number()[rows + dy, columns + dx]
        across = (there >= 0) & (bonds.phases.of != bonds.phases.of[there])
        at, leaving = bonds.body.leaving(lattice, bonds.family.offsets)
        across[at] &= ~leaving[which]
        whole = whole | across
    return np.asarray(whole)
