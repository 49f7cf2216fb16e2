"""Regions: which points belong to a body, and how far they are from its edge.

Shapes (`solver.geometry.shapes`) combine: ``a - b`` has holes and notches, ``a | b`` is both,
``a & b`` what they have in common. Where shapes meet along an edge they are one body, rounding or
not; where they meet in a point they are two.

Who owns the edge: **a point on the edge of a shape belongs to the shape that was drawn**, discs and
polygons alike, within rounding. So a body has the particles on its outer edge; those on the rim of
a hole or notch belong to the hole, and not to the body; a region that selects particles or edges
takes those on its edge with it. The rule knows no left or right: mirror images have mirrored
particles, and an oblique edge through particle centres stays straight.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import EmptyRegionError, NoOutlineError

Point = tuple[float, float]

# Points nearer to an edge than this share of the shape's size lie on it,
EDGE = 1e-9
# and those nearer than so many roundings of its coordinates.
ROUNDINGS = 4 * np.finfo(np.float64).eps
# Share of that by which a point may lie off the line between its neighbours and be no corner.
_STRAIGHT = 1e-3
# Chords of curves, as a share of the size, from which the edge of a union is measured.
_FINE = 1.0 / 4096.0
# Points each way that are tried before a region's outline is asked whether it is empty.
_TRIED = 16


class Region(ABC):
    """A bounded part of the plane."""

    #: Whether the vertices of its outline stay as they are, however close.
    settled = False

    @property
    @abstractmethod
    def bounds(self) -> tuple[float, float, float, float]:
        """(x_min, y_min, x_max, y_max), m."""

    @abstractmethod
    def contains(self, x: Array, y: Array) -> NDArray[np.bool_]:
        """Whether each point is inside or on the edge."""

    @abstractmethod
    def edge_distance(self, x: Array, y: Array) -> Array:
        """Distance (m) of each inside point to the nearest point of the edge."""

    def outline(self, step: float) -> shapely.Geometry:
        """The region as shapely polygons; chords of curves are about `step` (m) long.

        Raises
        ------
        NoOutlineError
            If this kind of region has no outline: then only surface treatments that need none
            can be used, and bonds are judged by their particles alone.
        """
        raise NoOutlineError(
            f"a {type(self).__name__} has no outline: surface='extrapolated' and loads on edges "
            f"need one"
        )

    def moved(self, by: Point, grid: float = 0.0) -> Region:
        """The same shape `by` (m) further.

        Discs and polygons move their own coordinates, so that nothing is lost to rounding far
        from the origin. What had been lost there is restored where the coordinates then are
        multiples of `grid` (m) within that rounding: they become so exactly.
        """
        return Moved(self, by)

    def loosened(self) -> Region:
        """The same shape with twice the rounding within which a point lies on its edge.

        Where an edge really is, follows from the two.
        """
        return self

    def __sub__(self, hole: Region) -> Region:
        """This region without `hole`.

        Raises
        ------
        EmptyRegionError
            If nothing is left.
        """
        left = Difference(self, hole)
        if _empty(left, self, hole):
            raise EmptyRegionError("nothing is left of a region: what is subtracted covers it")
        return left

    def __or__(self, other: Region) -> Region:
        """This region and `other` in one."""
        return Union(self, other)

    def __and__(self, other: Region) -> Region:
        """What this region and `other` have in common.

        Raises
        ------
        EmptyRegionError
            If that is nothing, or but a line or a point.
        """
        common = Intersection(self, other)
        if _empty(common, self, other):
            raise EmptyRegionError("two regions that lie apart have nothing in common")
        return common


def moved_points(points: Sequence[Point], by: Point, grid: float) -> tuple[Point, ...]:
    """Points `by` further, exactly on multiples of `grid` that they meet within rounding."""
    given = np.array(points, dtype=np.float64)
    return snapped(given + by, np.maximum(np.abs(given), np.abs(by)), grid)


def snapped(there: Array, size: Array, grid: float) -> tuple[Point, ...]:
    """Points on the multiples of `grid` that they meet within the rounding of numbers of a size."""
    if grid > 0:
        near = np.rint(there / grid) * grid
        there = np.where(np.abs(near - there) <= ROUNDINGS * size, near, there)
    return tuple((float(x), float(y)) for x, y in there)


def _require_regions(*regions: Region) -> None:
    for region in regions:
        if not isinstance(region, Region):
            raise TypeError(f"a region combines with a Region, not {type(region).__name__}")


def _same(*regions: Region) -> float:
    """Lengths (m) that rounding may make of nothing where some regions meet."""
    box = np.array([region.bounds for region in regions])
    size = float(np.ptp(box.reshape(-1, 2), axis=0).max())
    return max(EDGE * size, ROUNDINGS * float(np.abs(box).max()))


def _empty(made: Region, one: Region, other: Region) -> bool:
    """Whether a region made of two has no area."""
    x0, y0, x1, y1 = made.bounds
    if not (x0 < x1 and y0 < y1):
        return True
    x, y = (
        low + (np.arange(_TRIED) + 0.5) / _TRIED * (high - low)
        for low, high in ((x0, x1), (y0, y1))
    )
    if made.contains(*np.meshgrid(x, y)).any():
        return False
    box = np.array([one.bounds, other.bounds])
    size = float((box[:, 2:] - box[:, :2]).max())
    try:
        shape = made.outline(_FINE * size)
    except NoOutlineError:
        return False
    return bool(shape.area <= _same(one, other) * shape.length)


@dataclass(frozen=True)
class Moved(Region):
    """Any `shape`, moved `by` so much (m)."""

    shape: Region
    by: Point

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        (x0, y0, x1, y1), (dx, dy) = self.shape.bounds, self.by
        return x0 + dx, y0 + dy, x1 + dx, y1 + dy

    def contains(self, x: Array, y: Array) -> NDArray[np.bool_]:
        return self.shape.contains(x - self.by[0], y - self.by[1])

    def outline(self, step: float) -> shapely.Geometry:
        return shapely.transform(self.shape.outline(step), lambda points: points + self.by)

    def edge_distance(self, x: Array, y: Array) -> Array:
        return self.shape.edge_distance(x - self.by[0], y - self.by[1])


@dataclass(frozen=True)
class Difference(Region):
    """`body` without `hole`.

    The distance to the edge is the smaller of the distances to both outlines: a part of one
    outline that is not an edge (inside the hole, outside the body) is never the nearer one.
    """

    body: Region
    hole: Region

    def __post_init__(self) -> None:
        _require_regions(self.body, self.hole)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        return self.body.bounds

    def contains(self, x: Array, y: Array) -> NDArray[np.bool_]:
        return self.body.contains(x, y) & ~self.hole.contains(x, y)

    def outline(self, step: float) -> shapely.Geometry:
        return shapely.difference(self.body.outline(step), self.hole.outline(step))

    def moved(self, by: Point, grid: float = 0.0) -> Difference:
        return Difference(self.body.moved(by, grid), self.hole.moved(by, grid))

    def loosened(self) -> Difference:
        return Difference(self.body.loosened(), self.hole.loosened())

    def edge_distance(self, x: Array, y: Array) -> Array:
        return np.minimum(self.body.edge_distance(x, y), self.hole.edge_distance(x, y))


@dataclass(frozen=True)
class _Pair(Region):
    """Two regions in one rule."""

    one: Region
    other: Region

    def __post_init__(self) -> None:
        _require_regions(self.one, self.other)

    def moved(self, by: Point, grid: float = 0.0) -> _Pair:
        return type(self)(self.one.moved(by, grid), self.other.moved(by, grid))

    def loosened(self) -> _Pair:
        return type(self)(self.one.loosened(), self.other.loosened())


def without_middles(shape: shapely.Geometry, tolerance: float) -> shapely.Geometry:
    """A polygon, or several, less the vertices that lie on the line between their neighbours.

    `shapely.simplify` keeps one where an edge is parallel to what it divides the ring by.
    """
    if isinstance(shape, shapely.MultiPolygon):
        return shapely.MultiPolygon([without_middles(one, tolerance) for one in shape.geoms])
    if not isinstance(shape, shapely.Polygon):
        return shape

    def corners(ring: shapely.LinearRing) -> Array:
        points = shapely.get_coordinates(ring)[:-1]
        while len(points) > 3:
            back, ahead = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
            along, here = ahead - back, points - back
            length = np.hypot(*along.T)
            off = np.abs(along[:, 0] * here[:, 1] - along[:, 1] * here[:, 0])
            share = (along * here).sum(axis=1)
            middle = (off <= tolerance * length) & (share > 0) & (share < length**2)
            # Never two neighbours at once: what one of them goes by is the other.
            middle[1:] &= ~middle[:-1]
            middle[0] &= not middle[-1]
            if not middle.any():
                break
            points = points[~middle]
        return np.asarray(points)

    rings = [corners(ring) for ring in shape.interiors]
    return shapely.Polygon(corners(shape.exterior), rings)


@dataclass(frozen=True)
class Union(_Pair):
    """`one` and `other` together: what either of them holds.

    The edge is that of the whole: what lies inside the other is none.
    """

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        (a, b, c, d), (e, f, g, h) = self.one.bounds, self.other.bounds
        return min(a, e), min(b, f), max(c, g), max(d, h)

    def contains(self, x: Array, y: Array) -> NDArray[np.bool_]:
        return self.one.contains(x, y) | self.other.contains(x, y)

    def outline(self, step: float) -> shapely.Geometry:
        one, other = self.one.outline(step), self.other.outline(step)
        # Edges that coincide but for rounding would leave a slit: corners of each take the place of
        # those of the other that they lie on.
        same = _same(self.one, self.other)
        other = shapely.snap(other, one, same)
        one = shapely.snap(one, other, same)
        # Where two edges go on in one line no corner is left.
        return without_middles(shapely.union(one, other), _STRAIGHT * same)

    def edge_distance(self, x: Array, y: Array) -> Array:
        x0, y0, x1, y1 = self.bounds
        size = max(x1 - x0, y1 - y0)
        edge = shapely.boundary(self.outline(_FINE * size))
        shapely.prepare(edge)
        found = np.asarray(shapely.distance(edge, shapely.points(x, y)))
        # Chords stand for curves: what is an edge of either shape is known exactly.
        for region in (self.one, self.other):
            exact = region.edge_distance(x, y)
            found = np.where(np.abs(found - exact) < _FINE**2 * size, exact, found)
        return found


@dataclass(frozen=True)
class Intersection(_Pair):
    """What `one` and `other` have in common."""

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        (a, b, c, d), (e, f, g, h) = self.one.bounds, self.other.bounds
        return max(a, e), max(b, f), min(c, g), min(d, h)

    def contains(self, x: Array, y: Array) -> NDArray[np.bool_]:
        return self.one.contains(x, y) & self.other.contains(x, y)

    def outline(self, step: float) -> shapely.Geometry:
        return shapely.intersection(self.one.outline(step), self.other.outline(step))

    def edge_distance(self, x: Array, y: Array) -> Array:
        # A part of one outline beyond the other is never the nearer one.
        return np.minimum(self.one.edge_distance(x, y), self.other.edge_distance(x, y))


#: A part of the plane: a region, or a function of the coordinates that says yes or no.
Where = Region | Callable[[Array, Array], Any]
