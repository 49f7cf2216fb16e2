"""Shapes: which points belong to a body, and how far they are from its edge.

Membership and distance of discs are exact (a polygon would miscount particles); polygons go
through shapely. Shapes combine: ``a - b`` has holes and notches, ``a | b`` is both, ``a & b`` what
they have in common. Where shapes meet along an edge they are one body, rounding or not; where they
meet in a point they are two.

Who owns the edge: **a point on the edge of a shape belongs to the shape that was drawn**, discs and
polygons alike, within rounding. So a body has the particles on its outer edge; those on the rim of
a hole or notch belong to the hole, and not to the body; a region that selects particles or edges
takes those on its edge with it. The rule knows no left or right: mirror images have mirrored
particles, and an oblique edge through particle centres stays straight.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import EmptyRegionError, NoOutlineError

Point = tuple[float, float]

# Points nearer to an edge than this share of the shape's size lie on it,
_EDGE = 1e-9
# and those nearer than so many roundings of its coordinates.
_ROUNDINGS = 4 * np.finfo(np.float64).eps
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

        Shapes of this module move their own coordinates, so that nothing is lost to rounding far
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
    return _snapped(given + by, np.maximum(np.abs(given), np.abs(by)), grid)


def _snapped(there: Array, size: Array, grid: float) -> tuple[Point, ...]:
    """Points on the multiples of `grid` that they meet within the rounding of numbers of a size."""
    if grid > 0:
        near = np.rint(there / grid) * grid
        there = np.where(np.abs(near - there) <= _ROUNDINGS * size, near, there)
    return tuple((float(x), float(y)) for x, y in there)


def _require_regions(*regions: Region) -> None:
    for region in regions:
        if not isinstance(region, Region):
            raise TypeError(f"a region combines with a Region, not {type(region).__name__}")


def _same(*regions: Region) -> float:
    """Lengths (m) that rounding may make of nothing where some regions meet."""
    box = np.array([region.bounds for region in regions])
    size = float(np.ptp(box.reshape(-1, 2), axis=0).max())
    return max(_EDGE * size, _ROUNDINGS * float(np.abs(box).max()))


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
class Disc(Region):
    """Disc of `radius` about `centre`, m; `slack` (m) is the rounding of where it was drawn."""

    radius: float
    centre: Point = (0.0, 0.0)
    slack: float = field(default=0.0, compare=False, repr=False)

    def __post_init__(self) -> None:
        if not (np.isfinite(self.radius) and self.radius > 0):
            raise ValueError(f"a disc needs a positive radius, not {self.radius}")

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        (x, y), r = self.centre, self.radius
        return x - r, y - r, x + r, y + r

    def contains(self, x: Array, y: Array) -> NDArray[np.bool_]:
        tie = self._tie
        return np.asarray(np.hypot(x - self.centre[0], y - self.centre[1]) <= self.radius + tie)

    @property
    def _tie(self) -> float:
        return max(self.slack, _EDGE * self.radius, _ROUNDINGS * float(np.abs(self.centre).max()))

    def moved(self, by: Point, grid: float = 0.0) -> Disc:
        return Disc(self.radius, moved_points((self.centre,), by, grid)[0], self._tie)

    def loosened(self) -> Disc:
        return Disc(self.radius, self.centre, 2 * self._tie)

    def outline(self, step: float) -> shapely.Geometry:
        # A multiple of four keeps the lattice's symmetry.
        count = max(24, 4 * int(np.ceil(0.5 * np.pi * self.radius / step - 1e-9)))
        angle = 2 * np.pi * np.arange(count) / count
        x, y = self.centre
        return shapely.Polygon(
            np.column_stack([x + self.radius * np.cos(angle), y + self.radius * np.sin(angle)])
        )

    def edge_distance(self, x: Array, y: Array) -> Array:
        return np.abs(self.radius - np.hypot(x - self.centre[0], y - self.centre[1]))


@dataclass(frozen=True)
class Polygon(Region):
    """Simple polygon through `vertices` (without holes; subtract those).

    A vertex that repeats the one before it, as in a ring that says its first one again, is one.
    `slack` (m) is the rounding of where it was drawn; `about` its centre and the vertices from
    there, where they are known better than the vertices are.
    """

    vertices: tuple[Point, ...]
    slack: float = field(default=0.0, compare=False, repr=False)
    about: tuple[Point, tuple[Point, ...]] | None = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        if not np.all(np.isfinite(np.asarray(self.vertices, dtype=np.float64))):
            raise ValueError(f"a polygon with a vertex that is not finite: {self.vertices}")
        before = self.vertices[-1:] + self.vertices[:-1]
        if self.about is None and any(a == b for a, b in zip(before, self.vertices, strict=True)):
            # A side without length has no normal.
            single = [b for a, b in zip(before, self.vertices, strict=True) if a != b]
            object.__setattr__(self, "vertices", tuple(single))
        shape = shapely.Polygon(self.vertices) if len(self.vertices) > 2 else None
        if shape is None or not shape.is_valid or shape.area == 0:
            raise ValueError(f"not a simple polygon with an area: {self.vertices}")
        shapely.prepare(shape)
        object.__setattr__(self, "_shape", shape)
        object.__setattr__(self, "_edge", shape.exterior)
        shapely.prepare(self._edge)  # type: ignore[attr-defined]

    @property
    def shape(self) -> shapely.Polygon:
        """The shapely polygon."""
        return self._shape  # type: ignore[attr-defined]

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        x0, y0, x1, y1 = self.shape.bounds
        return float(x0), float(y0), float(x1), float(y1)

    def contains(self, x: Array, y: Array) -> NDArray[np.bool_]:
        x, y = np.broadcast_arrays(x, y)
        x0, y0, x1, y1 = self.bounds
        tie = self._tie
        inside = np.array(shapely.contains_xy(self.shape, x, y))
        near = ~inside & (x >= x0 - tie) & (x <= x1 + tie) & (y >= y0 - tie) & (y <= y1 + tie)
        edge = self._edge  # type: ignore[attr-defined]
        inside[near] = shapely.dwithin(edge, shapely.points(x[near], y[near]), tie)
        return inside

    @property
    def _tie(self) -> float:
        x0, y0, x1, y1 = self.bounds
        size = max(x1 - x0, y1 - y0)
        return max(self.slack, _EDGE * size, _ROUNDINGS * float(np.abs(self.bounds).max()))

    def moved(self, by: Point, grid: float = 0.0) -> Polygon:
        if self.about is None:
            return Polygon(moved_points(self.vertices, by, grid), self._tie)
        centre, corners = self.about
        (there,) = moved_points((centre,), by, grid)
        size = np.maximum(np.abs(self.vertices), np.abs(by))
        vertices = _snapped(np.add(corners, there), size, grid)
        return Polygon(vertices, self._tie, (there, corners))

    def loosened(self) -> Polygon:
        return Polygon(self.vertices, 2 * self._tie, self.about)

    def outline(self, step: float) -> shapely.Geometry:
        return self.shape

    def edge_distance(self, x: Array, y: Array) -> Array:
        return shapely.distance(self.shape.exterior, shapely.points(x, y))


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


def disc(radius: float, centre: Point = (0.0, 0.0)) -> Disc:
    """Disc of `radius` about `centre`, m."""
    return Disc(float(radius), centre)


def polygon(vertices: Sequence[Point]) -> Polygon:
    """Polygon through `vertices`, m."""
    return Polygon(tuple((float(x), float(y)) for x, y in vertices))


def rectangle(
    width: float, height: float, centre: Point = (0.0, 0.0), angle: float = 0.0
) -> Polygon:
    """Rectangle of `width` × `height` (m) about `centre`, turned anticlockwise by `angle` (rad).

    Raises
    ------
    ValueError
        If a side is not positive.
    """
    if not (width > 0 and height > 0):
        raise ValueError(f"a rectangle needs positive sides, not {width} × {height}")
    c, s = np.cos(angle), np.sin(angle)
    corners = [(-width / 2, -height / 2), (width / 2, -height / 2)]
    corners += [(-x, -y) for x, y in corners]
    turned = tuple((float(c * x - s * y), float(s * x + c * y)) for x, y in corners)
    vertices = tuple((float(centre[0] + x), float(centre[1] + y)) for x, y in turned)
    return Polygon(vertices, about=(centre, turned))


@dataclass(frozen=True)
class Crack:
    """Cut along the polyline through `points`; bonds that cross it are cut.

    Cracks may share ends, cross, branch and overlap: they act as the one set of points that they
    are, see `solver.geometry.crack_set`. An end that lies in the body is a tip and belongs to the
    uncut material: a bond through the very tip stays. One on the body's edge, beyond it, or less
    than half a cell before it is a mouth.

    Raises
    ------
    ValueError
        If there are fewer than two points, all coincide, or one is not finite.

    Examples
    --------
    >>> Crack((-1.0, 0.0), (0.0, 0.0)).segments
    (((-1.0, 0.0), (0.0, 0.0)),)
    """

    points: tuple[Point, ...]

    def __init__(self, *points: Point) -> None:
        array = np.array(points, dtype=np.float64)
        if array.ndim != 2 or array.shape[1] != 2 or len(array) < 2:
            raise ValueError(f"a crack runs through two or more points of the plane, not {points}")
        if not np.all(np.isfinite(array)):
            raise ValueError(f"a crack with a point that is not finite: {points}")
        # A point drawn twice is one.
        fresh = np.append(True, (np.diff(array, axis=0) != 0).any(axis=1))
        array = array[fresh]
        if len(array) < 2:
            raise ValueError(f"a crack of no length: {points}")
        object.__setattr__(self, "points", tuple((float(x), float(y)) for x, y in array))

    def moved(self, by: Point, grid: float = 0.0) -> Crack:
        """As `Region.moved`; the crack remembers as what it was drawn."""
        result = Crack(*moved_points(self.points, by, grid))
        object.__setattr__(result, "_drawn", self.drawn)
        return result

    @property
    def drawn(self) -> tuple[Point, ...]:
        """The points that the user gave, m: what messages say."""
        drawn: tuple[Point, ...] = getattr(self, "_drawn", self.points)
        return drawn

    @property
    def closed(self) -> bool:
        """Whether it ends where it starts: then it has no tips."""
        return self.points[0] == self.points[-1]

    @property
    def segments(self) -> tuple[tuple[Point, Point], ...]:
        """Its straight pieces."""
        return tuple(pairwise(self.points))


#: A part of the plane: a region, or a function of the coordinates that says yes or no.
Where = Region | Callable[[Array, Array], Any]
