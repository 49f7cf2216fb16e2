"""The lattice: the body's particles on a regular grid, in a padded rectangular array.

A particle is a cell of the grid, and belongs to the body if its centre does (who owns the edge is
said in `solver.geometry.regions`). Where the grid lies is decided by the body, in each direction
by itself (`_border`):

* between two straight sides along the grid the cells lie symmetrically, and fill the body if it is
  a whole number of cells;
* from one such side cells begin;
* a body without (a disc, a turned rectangle) lies on the grid whose cells begin at the origin, as
  the paper's do, if its middle is then on a border or in a centre of cells, and has a border there
  if not.

So the same body has the same particles wherever it stands (but for a disc that is put on a centre
of cells, or half a cell beside it). Everything that asks what lies where is
computed in coordinates from a corner of cells near the middle of the body (`Lattice.centred`),
in which nothing is lost to rounding however far the body is from the origin; the user's coordinates
come in and go out as they are.

Fields live either one value a particle (row by row, the order of `points`) or
on the padded grid, where a rim of width `pad` and every cell outside the body stay zero, so that
kernels may read any neighbour without asking whether it exists.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.spatial import KDTree

from ..arrays import Array, Indices, Mask
from ..errors import SceneError
from .regions import Point, Region, Where

# Refuse grids whose index arithmetic or memory nobody meant to ask for.
_LARGEST_GRID = 200_000_000
# Cells within which a border is met: far above rounding, far below anything that is drawn.
_TIE = 1e-6


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
    phase : pair of float, optional
        Where cells begin: at (k + phase) Δx for whole k. (0, 0) has centres at half-integer
        multiples of the spacing, (0.5, 0.5) at the multiples. Chosen from the body by default.
    shift : pair of float
        What to add to its coordinates for the user's, m.

    Raises
    ------
    SceneError
        If the spacing is not positive, the phase is not finite, or no particle lies in the region.
    """

    region: Region
    spacing: float
    pad: int
    phase: Point | None = None
    shift: Point = (0.0, 0.0)

    def __post_init__(self) -> None:
        if not (np.isfinite(self.spacing) and self.spacing > 0):
            raise SceneError(f"the grid spacing must be positive, not {self.spacing}")
        if self.phase is not None and not (
            np.shape(self.phase) == (2,) and np.all(np.isfinite(self.phase))
        ):
            raise SceneError(f"the lattice's phase is a pair of shares of a cell: {self.phase}")
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
    def origin(self) -> Point:
        """The corner of cells near the body's middle from which everything is computed, m."""
        x0, y0, x1, y1 = self.region.bounds
        straight = self.straight
        phase = (None, None) if self.phase is None else self.phase
        x = _border(x0, x1, self.spacing, straight[:2], phase[0])
        y = _border(y0, y1, self.spacing, straight[2:], phase[1])
        return x, y

    @cached_property
    def straight(self) -> tuple[bool, bool, bool, bool]:
        """Whether the body's sides run along the grid: at its least and greatest x, then y."""
        return _straight_sides(self.region, self.spacing)

    @property
    def grid(self) -> float:
        """Multiples of it are where borders, centres and what is drawn between them meet, m."""
        return self.spacing / 8

    @cached_property
    def centred(self) -> Lattice:
        """The same particles in coordinates from `origin`, centres at half-integer multiples."""
        x, y = self.origin
        if (x, y) == (0.0, 0.0) and self.phase == (0.0, 0.0):
            return self
        shift = self.shift[0] + x, self.shift[1] + y
        region = self.region
        if (x, y) != (0.0, 0.0):
            region = region.moved((-x, -y), self.grid)
        near = Lattice.__new__(Lattice)
        for name, value in (
            ("region", region),
            ("spacing", self.spacing),
            ("pad", self.pad),
            ("phase", (0.0, 0.0)),
            ("shift", shift),
            ("origin", (0.0, 0.0)),
        ):
            near.__dict__[name] = value
        return near

    @cached_property
    def _box(self) -> tuple[int, int, int, int]:
        x0, y0, x1, y1 = self.centred.region.bounds
        low = np.floor(np.array([x0, y0]) / self.spacing + _TIE).astype(int)
        high = np.ceil(np.array([x1, y1]) / self.spacing - _TIE).astype(int)
        # A centre on the very edge is inside.
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
        return (
            np.multiply(x, self.spacing) + self.origin[0],
            np.multiply(y, self.spacing) + self.origin[1],
        )

    @cached_property
    def mask(self) -> Mask:
        """Which cells of the padded grid hold a particle, shape `shape`."""
        if self.centred is not self:
            return self.centred.mask
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

    @property
    def places(self) -> Array:
        """Centres in the user's coordinates, shape (N, 2), m."""
        return self.points + self.shift

    def middle(self, mask: Mask) -> Array:
        """Mean place of some particles, (N,), in the user's coordinates; rounding of 0 is 0."""
        found = self.places[mask].mean(axis=0)
        return np.where(np.abs(found) < 1e-9 * self.spacing, 0.0, found)

    @cached_property
    def edge_distance(self) -> Array:
        """Distance of each particle to the body's edge, shape (N,), m."""
        if self.centred is not self:
            return self.centred.edge_distance
        return self.region.edge_distance(self.points[:, 0], self.points[:, 1])

    @cached_property
    def tree(self) -> KDTree:
        """The centres, for finding the nearest."""
        return KDTree(self.points)

    @cached_property
    def known(self) -> dict[tuple[str, int], tuple[Any, Any]]:
        """What has been found out about parts of the plane, by the id of the part.

        With the part itself, so that its id stays its own. What varies in time asks every step.
        """
        return {}

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
    """Particles in a region, or those for which ``where(x, y)`` is true, shape (N,).

    Both in the user's coordinates.
    """
    key = "particles", id(where)
    if key not in lattice.known:
        found = _select(lattice, where)
        found.setflags(write=False)
        lattice.known[key] = where, found
    selected: Mask = lattice.known[key][1]
    return selected


def _select(lattice: Lattice, where: Where) -> Mask:
    if isinstance(where, Region):
        near = lattice.centred
        there = (
            where.moved((-near.shift[0], -near.shift[1]), near.grid) if any(near.shift) else where
        )
        return there.contains(*near.points.T)
    x, y = lattice.places.T
    with np.errstate(all="ignore"):
        selected = np.asarray(where(x, y))
    if selected.dtype != bool or selected.shape != x.shape:
        raise SceneError("a selection must return one boolean a particle")
    return selected


def _border(
    low: float, high: float, spacing: float, straight: tuple[bool, bool], phase: float | None
) -> float:
    """A border of cells near the middle of a body that extends from `low` to `high` (m).

    `straight` tells which of the two sides run along the grid.
    """
    middle = 0.5 * low + 0.5 * high
    if abs(middle) < 1e-12 * (high - low):
        middle = 0.0
    if phase is not None:
        cells = middle / spacing - phase
        # Exactly where it was drawn, if that is on a border or a centre.
        rounding = 8 * np.finfo(np.float64).eps * (abs(middle) / spacing + 1.0)
        if abs(cells - np.rint(cells)) < rounding:
            return middle
        if abs(cells - np.floor(cells) - 0.5) < rounding:
            return middle - 0.5 * spacing
        return float((np.rint(cells) + phase) * spacing)
    if straight[0] != straight[1]:
        side = low if straight[0] else high
        return float(side + np.rint((middle - side) / spacing) * spacing)
    if straight[0]:
        centre = np.ceil((high - low) / spacing - 0.5 - _TIE) % 2 == 1
    else:
        centre = abs(middle / spacing - np.floor(middle / spacing) - 0.5) < _TIE
    return middle - 0.5 * spacing if centre else middle


def _straight_sides(region: Region, spacing: float) -> tuple[bool, bool, bool, bool]:
    """Whether the region has a straight edge at its lowest and highest x, lowest and highest y."""
    try:
        edge = shapely.boundary(region.outline(spacing))
    except SceneError:
        return False, False, False, False
    x0, y0, x1, y1 = region.bounds
    found = []
    lines = [shapely.get_coordinates(line) for line in shapely.get_parts(edge)]
    for axis, side in ((0, x0), (0, x1), (1, y0), (1, y1)):
        length = 0.0
        for line in lines:
            on = np.abs(line[:, axis] - side) < _TIE * spacing
            pieces = np.abs(np.diff(line[:, 1 - axis]))
            length += float(pieces[on[1:] & on[:-1]].sum())
        found.append(length > 0.5 * spacing)
    return found[0], found[1], found[2], found[3]
