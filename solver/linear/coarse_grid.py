"""Where the coarse nodes are: a lattice in the lattice, turned and stretched for strong anisotropy.

The smoother takes what costs much energy in one cell. In a strongly anisotropic solid short waves
across the strong axis cost little, and only a coarse grid that resolves them does. So nodes come
close across that axis and far apart along it.

Both vectors between nodes are whole numbers of cells. All hats are then the same hat at other
places, wherever the strong axis points to, and their entries in the bulk one stencil
(`solver.linear.stencil`). With the vectors a and b, cell (x, y) lies at x = i a + j b, and a hat is
the product of the linear hats of i and j: bilinear on parallelograms.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array, Indices
from ..material import Family
from ..material.moduli import effective_tensor
from ..operators import BondOperator

# Energy of the weakest long wave (rad per cell) over that of a single particle moved alike, below
# which a square grid costs more iterations than a stretched one. It is 0.9 to 1 in isotropic solids
# and in bone, 0.25 in a conductor of ratio 10, 0.14 in a ply.
_WEAK = 0.4
# Energy, over the weakest, up to which long waves are about as weak.
_TIED = 1.05
# Distances of nodes along the strong axis and across it by unknowns a particle, relative to those
# that the energies of long waves ask for.
_STRETCH = {1: (1.7, 1.2), 2: (1.2, 1.0), 3: (1.2, 1.0)}
# Cells more or less along the axis that are worth a radian of direction.
_DIRECTION = 50.0
_DIRECTIONS = 360
# Gap between hats, in windows, that is not worth a product.
_GAP = 6


@dataclass(frozen=True)
class CoarseGrid:
    """A grid of coarse nodes.

    Attributes
    ----------
    along, across : tuple of int
        Cells from a node to the next of its row and to the next row, (columns, rows),
        anticlockwise.
    shape : tuple of int
        Of the padded lattice, rows and columns.
    """

    along: tuple[int, int]
    across: tuple[int, int]
    shape: tuple[int, int]

    @classmethod
    def of(cls, operator: BondOperator, coarsening: int) -> CoarseGrid:
        """The grid that suits the solid of most particles.

        Parameters
        ----------
        operator : BondOperator
        coarsening : int
            Distance of the nodes in cells where the solid is not strongly anisotropic.
        """
        phase = int(np.bincount(operator.phase, minlength=1).argmax())
        weak, energy = _axes(operator, phase)
        shape = operator.bonds.lattice.shape
        if energy[0] >= _WEAK:
            return cls((coarsening, 0), (0, coarsening), shape)
        along, across = _STRETCH[operator.components]
        length = along * coarsening * max(1.0, np.sqrt(energy[1]))
        x, y = _whole_vector(np.array([weak[1], -weak[0]]), length)
        # Across, a vector along rows or columns does: what counts is how far the rows of nodes are
        # apart. Anticlockwise to it, by the whole vector: it decides which of the two it is.
        steep = abs(y) > abs(x)
        if (y if steep else x) < 0:
            x, y = -x, -y
        share = abs(weak[0 if steep else 1])
        step = max(1, round(across * coarsening * np.sqrt(energy[0]) / share))
        if not x:
            return cls((step, 0), (0, y), shape)
        return cls((x, y), (-step, 0) if steep else (0, step), shape)

    @property
    def cells(self) -> int:
        """Cells a node."""
        return self.along[0] * self.across[1] - self.along[1] * self.across[0]

    @property
    def rectangular(self) -> bool:
        """Whether the vectors lie along rows and columns."""
        return self.along[1] == self.across[0] == 0

    def numerators(self, rows: Indices, columns: Indices) -> tuple[Indices, Indices]:
        """Coordinates (row and column of the grid) of differences of cells, times `cells`."""
        (ax, ay), (bx, by) = self.along, self.across
        return ax * rows - ay * columns, by * columns - bx * rows

    @cached_property
    def _nodes(self) -> tuple[int, int, int, int]:
        """First row and column of nodes that the lattice needs, and how many rows and columns."""
        rows, columns = np.array([[0, 0], [0, 1], [1, 0], [1, 1]]).T
        row, column = (
            axis // self.cells
            for axis in self.numerators(rows * self.shape[0], columns * self.shape[1])
        )
        first, last = (int(row.min()), int(column.min())), (int(row.max()), int(column.max()))
        return (*first, last[0] - first[0] + 2, last[1] - first[1] + 2)

    @property
    def size(self) -> tuple[int, int]:
        """Rows and columns of nodes."""
        return self._nodes[2:]

    def places(self, rows: Indices, columns: Indices) -> tuple[Indices, Indices]:
        """Row and column of the lattice's cells on the grid, times `cells`; none is negative."""
        row, column = self.numerators(rows, columns)
        return row - self._nodes[0] * self.cells, column - self._nodes[1] * self.cells

    def cells_of(self, row: Indices, column: Indices) -> tuple[Indices, Indices]:
        """Rows and columns of the lattice on which nodes lie."""
        j, i = row + self._nodes[0], column + self._nodes[1]
        return (
            self.along[1] * i + self.across[1] * j,
            self.along[0] * i + self.across[0] * j,
        )

    def reach(self, family: Family) -> tuple[int, int]:
        """Farthest bond in rows and columns of the grid, times `cells`."""
        columns, rows = family.offsets.T
        row, column = self.numerators(rows, columns)
        return int(row.max()), int(column.max())

    def windows(self, family: Family) -> tuple[int, int]:
        """Rows and columns between the farthest nodes whose hats meet through a bond."""
        row, column = self.reach(family)
        # No cell is nearer to a hat's end than this.
        last_row, last_column = int(np.gcd(*self.along)), int(np.gcd(*self.across))
        return (
            (2 * (self.cells - last_row) + row) // self.cells,
            (2 * (self.cells - last_column) + column) // self.cells,
        )

    def boxes(self, row: Indices, column: Indices, reach: int) -> Indices:
        """Disjoint boxes of cells within reach of hats that are `windows` apart.

        Parameters
        ----------
        row, column : ndarray of int, shape (n,)
            Of the hats' nodes, row by row.
        reach : int
            Of bonds, in cells.

        Returns
        -------
        ndarray, shape (boxes, 4)
            First row, first column, last row, last column.
        """
        if not self.rectangular:
            return self._single_rows(row, column, reach)
        width, height = self.along[0], self.across[1]
        high, wide = height - 1 + reach, width - 1 + reach
        # One window for neighbours in a node row: short runs of particles cost the kernel more
        # than the gaps between such hats do.
        apart = (np.diff(row) > 0) | (np.diff(column) > _GAP * wide // width)
        first = np.concatenate([[0], np.nonzero(apart)[0] + 1])
        last = np.append(first[1:], len(row)) - 1
        level, low, top = height * row[first], width * column[first], width * column[last]
        return np.column_stack([level - high, low - wide, level + high, top + wide])

    def _single_rows(self, row: Indices, column: Indices, reach: int) -> Indices:
        """Boxes of one row of cells each: bounding boxes of slanted hats would overlap."""
        levels, first, last = self._around(reach)
        y, x = (axis[:, None] for axis in self.cells_of(row, column))
        y, low, high = (axis.ravel() for axis in (y + levels, x + first, x + last))
        order = np.lexsort((low, y))
        y, low, high = y[order], low[order], high[order]
        apart = np.ones(len(y), dtype=bool)
        apart[1:] = (np.diff(y) > 0) | (low[1:] > high[:-1] + 1)
        start = np.nonzero(apart)[0]
        return np.column_stack([y[start], low[start], y[start], np.maximum.reduceat(high, start)])

    def _around(self, reach: int) -> tuple[Indices, Indices, Indices]:
        """Rows within reach of the hat about 0, and the first and last column of each."""
        inside = np.pad(self.hat > 0, ((2 * reach,) * 2, (0, 0)))
        windows = np.lib.stride_tricks.sliding_window_view(inside, 2 * reach + 1, 0)
        near = np.asarray(windows.any(axis=-1))
        levels = np.nonzero(near.any(axis=1))[0]
        first = near[levels].argmax(axis=1)
        last = near.shape[1] - 1 - near[levels, ::-1].argmax(axis=1)
        row, column = (size // 2 for size in near.shape)
        return levels - row, first - column - reach, last - column + reach

    @cached_property
    def hat(self) -> Array:
        """The hat on the cells about its node, which is in the middle, by row and column."""
        width, height = (abs(a) + abs(b) for a, b in zip(self.along, self.across, strict=True))
        rows, columns = np.mgrid[-height : height + 1, -width : width + 1]
        row, column = (np.abs(axis) / self.cells for axis in self.numerators(rows, columns))
        return np.maximum(1.0 - row, 0.0) * np.maximum(1.0 - column, 0.0)


def _axes(operator: BondOperator, phase: int) -> tuple[Array, Array]:
    """The direction in which the weakest wave runs, and energies of waves along it and across.

    Of the long waves of each direction the weakest, over what a particle's own bonds resist to the
    same motion, cells taken out.
    """
    family, moduli = operator.bonds.family, operator.moduli.each[phase]
    # Not the operator's diagonal, which holds inertia in implicit steps.
    own = operator.as_blocks(operator.blocks[phase].sum(axis=0)[:, None])[0]
    angle = np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    rows = moduli.wave_rows(np.column_stack([np.cos(angle), np.sin(angle)]))
    acoustic = rows.swapaxes(-1, -2) @ effective_tensor(family, moduli) @ rows
    scale = family.spacing * np.sqrt(np.diagonal(own)[: acoustic.shape[-1]])
    energies = np.linalg.eigvalsh(acoustic / np.outer(scale, scale))
    energy = energies[:, 0]
    # A ply shears as easily along its fibres as across them: of waves that are about as weak those
    # count that are weak in every motion, and rounding does not choose.
    tied = energy <= _TIED * energy.min()
    least = int(np.where(tied, energies.sum(axis=1), np.inf).argmin())
    across = (least + _DIRECTIONS // 2) % _DIRECTIONS
    weak = np.array([np.cos(angle[least]), np.sin(angle[least])])
    return weak, np.asarray(energy[[least, across]], dtype=np.float64)


def _whole_vector(direction: Array, length: float) -> tuple[int, int]:
    """The vector of whole numbers about as long as asked for that points there best."""
    most = int(np.ceil(1.25 * length))
    x, y = (axis.ravel() for axis in np.mgrid[-most : most + 1, -most : most + 1])
    size, lead = np.hypot(x, y), x * direction[0] + y * direction[1]
    fits = (size >= 0.75 * length) & (size <= 1.25 * length) & (lead > 0)
    off = np.abs(x * direction[1] - y * direction[0]) / np.maximum(size, 1.0)
    best = np.argmin(np.where(fits, _DIRECTION * off + np.abs(size - length), np.inf))
    return int(x[best]), int(y[best])
