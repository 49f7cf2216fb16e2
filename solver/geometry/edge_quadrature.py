"""Points on a body's edges at which its edge loads are evaluated."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Mask
from ..errors import SceneError
from .outline import Outline
from .regions import Point, Region, Where, moved_points

# Quadrature points on an edge of the outline: closer than the particles, which may have to carry
# each its own share.
_POINTS = 24
# An edge belongs to a straight line if both its ends lie within this share of its length.
_ALONG = 0.02
# Smaller shares of an edge are rounding of where a load begins.
_SLIVER = 1e-9
# Halvings that find where a load begins within a part of an edge.
_HALVINGS = 44


@dataclass(frozen=True, eq=False)
class Quadrature:
    """Points on the body's edges with weights, and what acts there.

    Attributes
    ----------
    outline : Outline
    edge : ndarray of int, shape (k,)
    position : ndarray, shape (k,)
        Along the edge, 0 to 1.
    weight : ndarray, shape (k,), m
    density : ndarray, shape (k, components)
        Per length (and unit thickness).
    shift : pair of float
        What to add to the outline's coordinates for the user's, m.
    """

    outline: Outline
    edge: NDArray[np.int64]
    position: Array
    weight: Array
    density: Array
    shift: Point = (0.0, 0.0)

    @classmethod
    def over(
        cls,
        outline: Outline,
        where: Where | None = None,
        shift: Point = (0.0, 0.0),
        grid: float = 0.0,
    ) -> Quadrature:
        """The region's edges, or the part that `where` selects, cut off where it ends.

        Parts shorter than a point's share of an edge may be overlooked. What a region has lost to
        rounding far from the origin is restored on multiples of `grid` (`Region.moved`).

        Raises
        ------
        SceneError
            If nothing is selected.
        """
        edge = np.nonzero(outline.face == 0)[0]
        if where is None:
            whole = cls._rule(outline, edge, np.zeros(len(edge)), np.ones(len(edge)))
            return replace(whole, shift=shift)
        edge = np.repeat(edge, _POINTS)
        low = np.tile(np.arange(_POINTS) / _POINTS, len(edge) // _POINTS)
        high = low + 1.0 / _POINTS
        if isinstance(where, Region):
            x, y = shift
            where = where.moved((-x, -y), grid)
            # Within rounding points on the rim are selected: twice the rounding tells how much
            # that adds.
            once, twice = (
                _clip(_selector(outline, w), edge, low, high) for w in (where, where.loosened())
            )
            low, high = (2 * a - b for a, b in zip(once, twice, strict=True))
        else:
            low, high = _clip(_selector(outline, where, shift), edge, low, high)
        kept = high - low > _SLIVER
        if not kept.any():
            raise SceneError("a load on the edge acts nowhere: no point of the edge is selected")
        edge, low, high = edge[kept], low[kept], high[kept]
        weight = (high - low) * outline.length[edge]
        nothing = np.zeros((len(edge), 0))
        return cls(outline, edge, 0.5 * (low + high), weight, nothing, shift)

    @classmethod
    def between(
        cls,
        outline: Outline,
        start: Array,
        end: Array,
        shift: Point = (0.0, 0.0),
        grid: float = 0.0,
    ) -> Quadrature:
        """The edges, or parts of them, along a straight line (in the user's coordinates)."""
        back = -shift[0], -shift[1]
        start, end = np.array(moved_points((tuple(start), tuple(end)), back, grid))
        first, last = (outline.nodes[outline.edges[:, k]] for k in (0, 1))
        length = float(np.hypot(*(end - start)))
        along = (end - start) / length
        across = np.array([-along[1], along[0]])
        near = (outline.face == 0) & (np.abs(outline.outward @ along) < 1e-6)
        for point in (first, last):
            near &= np.abs((point - start) @ across) < _ALONG * outline.length
        edge = np.nonzero(near)[0]
        a, b = ((point[edge] - start) @ along for point in (first, last))
        # Edges may run either way.
        ends = [np.clip((x - a) / (b - a), 0.0, 1.0) for x in (0.0, length)]
        low, high = np.minimum(*ends), np.maximum(*ends)
        kept = high > low + _SLIVER
        return replace(cls._rule(outline, edge[kept], low[kept], high[kept]), shift=shift)

    @classmethod
    def _rule(
        cls, outline: Outline, edge: NDArray[np.int64], low: Array, high: Array
    ) -> Quadrature:
        """Midpoints of equal parts of every edge between two positions."""
        middle = (np.arange(_POINTS) + 0.5) / _POINTS
        position = (low[:, None] + (high - low)[:, None] * middle).ravel()
        weight = np.repeat((high - low) * outline.length[edge] / _POINTS, _POINTS)
        return cls(outline, np.repeat(edge, _POINTS), position, weight, np.zeros((len(weight), 0)))

    def __len__(self) -> int:
        return len(self.edge)

    @property
    def points(self) -> Array:
        """Shape (k, 2), m."""
        first, last = (self.outline.nodes[self.outline.edges[self.edge, k]] for k in (0, 1))
        return first + self.position[:, None] * (last - first)

    @property
    def places(self) -> Array:
        """The same in the user's coordinates."""
        return self.points + self.shift

    @property
    def normals(self) -> Array:
        """Outward, shape (k, 2)."""
        return self.outline.outward[self.edge]

    def carrying(self, density: Array) -> Quadrature:
        """The same points with a density."""
        return replace(self, density=density)

    @property
    def force(self) -> Array:
        """What acts at each point, shape (k, components)."""
        return self.weight[:, None] * self.density


def _selector(
    outline: Outline, where: Where, shift: Point = (0.0, 0.0)
) -> Callable[[NDArray[np.int64], Array], Mask]:
    """Whether points at positions along edges are selected."""
    first = outline.nodes[outline.edges[:, 0]]
    along = outline.nodes[outline.edges[:, 1]] - first

    def inside(edge: NDArray[np.int64], position: Array) -> Mask:
        points = first[edge] + position[:, None] * along[edge] + shift
        if isinstance(where, Region):
            return where.contains(*points.T)
        with np.errstate(all="ignore"):
            found = np.asarray(where(*points.T))
        if found.dtype != bool or found.shape != position.shape:
            raise SceneError("a selection must return one boolean a point")
        return found

    return inside


def _clip(
    inside: Callable[[NDArray[np.int64], Array], Mask],
    edge: NDArray[np.int64],
    low: Array,
    high: Array,
) -> tuple[Array, Array]:
    """Parts of edges cut off where the selection ends; empty ones where it has no end of them."""
    ends = inside(edge, low), inside(edge, high)
    cut = np.nonzero(ends[0] != ends[1])[0]
    within, beyond = (np.where(ends[0] == first, low, high)[cut] for first in (True, False))
    for _ in range(_HALVINGS):
        middle = 0.5 * (within + beyond)
        here = inside(edge[cut], middle)
        within, beyond = np.where(here, middle, within), np.where(here, beyond, middle)
    none = ~(ends[0] | ends[1])
    low, high = low.copy(), high.copy()
    low[cut] = np.where(ends[0][cut], low[cut], within)
    high[cut] = np.where(ends[1][cut], high[cut], within)
    # Where only the ends lie on the rim, nothing between them is selected.
    none[~none] = ~inside(edge[~none], 0.5 * (low + high)[~none])
    high[none] = low[none]
    return low, high
