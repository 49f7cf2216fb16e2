"""The lattice: the body's particles on a regular grid, in a padded rectangular array.

Particle centres lie at half-integer multiples of the spacing; a particle belongs to the body if
its centre does. Fields live either one value a particle (row by row, the order of `points`) or
on the padded grid, where a rim of width `pad` and every cell outside the body stay zero, so that
kernels may read any neighbour without asking whether it exists.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Indices, Mask
from ..errors import SceneError
from .regions import Region, Where

# Refuse grids whose index arithmetic or memory nobody meant to ask for.
_LARGEST_GRID = 200_000_000


@dataclass(frozen=True, eq=False)
class Lattice:
    """Particles of a region.

    Parameters
    ----------
    region : Region
    spacing : float
        Δx, m.
    pad : int
        Width of the empty rim in cells, at least the reach of the family.

    Raises
    ------
    SceneError
        If the spacing is not positive, or no particle lies in the region.
    """

    region: Region
    spacing: float
    pad: int

    def __post_init__(self) -> None:
        if not (np.isfinite(self.spacing) and self.spacing > 0):
            raise SceneError(f"the grid spacing must be positive, not {self.spacing}")
        x0, y0, x1, y1 = self.region.bounds
        cells = ((x1 - x0) / self.spacing + 1) * ((y1 - y0) / self.spacing + 1)
        if not np.isfinite(cells) or cells > _LARGEST_GRID:
            raise SceneError(
                f"spacing {self.spacing:g} m makes a grid of {cells:.3g} cells for this region"
            )
        if not self.mask.any():
            raise SceneError(
                f"the region holds no particle: it is empty or thinner than the spacing "
                f"{self.spacing:g} m"
            )

    @cached_property
    def _box(self) -> tuple[int, int, int, int]:
        x0, y0, x1, y1 = self.region.bounds
        low = np.floor(np.array([x0, y0]) / self.spacing).astype(int)
        high = np.ceil(np.array([x1, y1]) / self.spacing).astype(int)
        return int(low[0]), int(low[1]), int(high[0]), int(high[1])

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of the padded grid."""
        i0, j0, i1, j1 = self._box
        return j1 - j0 + 2 * self.pad, i1 - i0 + 2 * self.pad

    @cached_property
    def axes(self) -> tuple[Array, Array]:
        """x of the columns and y of the rows of the padded grid, m."""
        i0, j0, _, _ = self._box
        rows, columns = self.shape
        x = np.arange(columns, dtype=np.float64) - self.pad + i0 + 0.5
        y = np.arange(rows, dtype=np.float64) - self.pad + j0 + 0.5
        return np.multiply(x, self.spacing), np.multiply(y, self.spacing)

    @cached_property
    def mask(self) -> Mask:
        """Which cells of the padded grid hold a particle, shape `shape`."""
        x, y = self.axes
        mask = np.zeros(self.shape, dtype=bool)
        p = self.pad
        inner = (slice(p, -p or None), slice(p, -p or None))
        xx, yy = np.meshgrid(x[inner[1]], y[inner[0]])
        mask[inner] = self.region.contains(xx, yy)
        return mask

    @cached_property
    def rows_columns(self) -> tuple[Indices, Indices]:
        """Row and column of each particle on the padded grid."""
        rows, columns = np.nonzero(self.mask)
        return rows, columns

    @property
    def count(self) -> int:
        """Number of particles N."""
        return len(self.rows_columns[0])

    @cached_property
    def points(self) -> Array:
        """Centres, shape (N, 2), m."""
        x, y = self.axes
        rows, columns = self.rows_columns
        return np.column_stack([x[columns], y[rows]])

    @cached_property
    def edge_distance(self) -> Array:
        """Distance of each particle to the body's edge, shape (N,), m."""
        return self.region.edge_distance(self.points[:, 0], self.points[:, 1])

    def number(self) -> NDArray[np.int64]:
        """Particle number of every cell of the padded grid, −1 where there is none."""
        numbers = np.full(self.shape, -1, dtype=np.int64)
        numbers[self.mask] = np.arange(self.count)
        return numbers

    def to_grid(self, values: Array) -> Array:
        """Put per-particle values, shape (..., N), on the padded grid, shape (..., *shape)."""
        grid = np.zeros((*values.shape[:-1], *self.shape))
        grid[..., self.mask] = values
        return grid


def select(lattice: Lattice, where: Where) -> Mask:
    """Particles in a region, or those for which ``where(x, y)`` is true, shape (N,)."""
    x, y = lattice.points.T
    if isinstance(where, Region):
        return where.contains(x, y)
    selected = np.asarray(where(x, y))
    if selected.dtype != bool or selected.shape != x.shape:
        raise SceneError("a selection must return one boolean a particle")
    return selected
