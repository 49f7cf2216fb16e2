"""Shapes: which points belong to a body, and how far they are from its edge.

Membership and distance of discs are exact (a polygon would miscount particles); polygons go
through shapely. Shapes combine by subtraction, which is what holes and notches are.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import NoOutlineError

Point = tuple[float, float]

# Points nearer to a polygon's edge than this share of its size lie on it.
_EDGE = 1e-9


class Region(ABC):
    """A bounded part of the plane."""

    @property
    @abstractmethod
    def bounds(self) -> tuple[float, float, float, float]:
        """(x_min, y_min, x_max, y_max), m."""

    @abstractmethod
    def contains(self, x: Array, y: Array) -> NDArray[np.bool_]:
        """Whether each point is inside."""

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

    def __sub__(self, hole: Region) -> Region:
        """This region without `hole`."""
        return Difference(self, hole)


@dataclass(frozen=True)
class Disc(Region):
    """Disc of `radius` about `centre`, m."""

    radius: float
    centre: Point = (0.0, 0.0)

    def __post_init__(self) -> None:
        if not (np.isfinite(self.radius) and self.radius > 0):
            raise ValueError(f"a disc needs a positive radius, not {self.radius}")

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        (x, y), r = self.centre, self.radius
        return x - r, y - r, x + r, y + r

    def contains(self, x: Array, y: Array) -> NDArray[np.bool_]:
        return (x - self.centre[0]) ** 2 + (y - self.centre[1]) ** 2 <= self.radius**2

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
    """Simple polygon through `vertices` (without holes; subtract those)."""

    vertices: tuple[Point, ...]

    def __post_init__(self) -> None:
        if not np.all(np.isfinite(np.asarray(self.vertices, dtype=np.float64))):
            raise ValueError(f"a polygon with a vertex that is not finite: {self.vertices}")
        shape = shapely.Polygon(self.vertices) if len(self.vertices) > 2 else None
        if shape is None or not shape.is_valid or shape.area == 0:
            raise ValueError(f"not a simple polygon with an area: {self.vertices}")
        shapely.prepare(shape)
        object.__setattr__(self, "_shape", shape)

    @property
    def shape(self) -> shapely.Polygon:
        """The shapely polygon."""
        return self._shape  # type: ignore[attr-defined]

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        x0, y0, x1, y1 = self.shape.bounds
        return float(x0), float(y0), float(x1), float(y1)

    def contains(self, x: Array, y: Array) -> NDArray[np.bool_]:
        # Half open, as pixels are: a point exactly on an edge counts if the body lies to its
        # right (or above it, on a level edge). A body of whole cells whose edges run through
        # particle centres then has as many particles as cells, whatever the rounding.
        x0, y0, x1, y1 = self.bounds
        nudge = _EDGE * max(x1 - x0, y1 - y0)
        return shapely.contains_xy(self.shape, x + nudge, y + nudge)

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

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        return self.body.bounds

    def contains(self, x: Array, y: Array) -> NDArray[np.bool_]:
        return self.body.contains(x, y) & ~self.hole.contains(x, y)

    def outline(self, step: float) -> shapely.Geometry:
        return shapely.difference(self.body.outline(step), self.hole.outline(step))

    def edge_distance(self, x: Array, y: Array) -> Array:
        return np.minimum(self.body.edge_distance(x, y), self.hole.edge_distance(x, y))


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
    return polygon([(centre[0] + c * x - s * y, centre[1] + s * x + c * y) for x, y in corners])


@dataclass(frozen=True)
class Crack:
    """Cut along the polyline through `points`; bonds that cross it are cut.

    An end that lies in the body is a tip and belongs to the uncut material: a bond through the
    very tip stays. The mouth of an edge crack is best drawn a little outside the body.

    Raises
    ------
    ValueError
        If there are fewer than two points, two successive ones coincide, or one is not finite.

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
        if np.any(np.linalg.norm(np.diff(array, axis=0), axis=1) == 0):
            raise ValueError(f"a crack with a piece of no length: {points}")
        object.__setattr__(self, "points", tuple((float(x), float(y)) for x, y in array))

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
