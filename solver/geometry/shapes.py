"""Discs and polygons, from which regions are made.

Membership and distance of discs are exact (a polygon would miscount particles); polygons go
through shapely. Who owns the edge: see `solver.geometry.regions`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import shapely
from numpy.typing import NDArray

from ..arrays import Array
from .regions import EDGE, ROUNDINGS, Point, Region, moved_points, snapped


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
        return max(self.slack, EDGE * self.radius, ROUNDINGS * float(np.abs(self.centre).max()))

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
        return max(self.slack, EDGE * size, ROUNDINGS * float(np.abs(self.bounds).max()))

    def moved(self, by: Point, grid: float = 0.0) -> Polygon:
        if self.about is None:
            return Polygon(moved_points(self.vertices, by, grid), self._tie)
        centre, corners = self.about
        (there,) = moved_points((centre,), by, grid)
        size = np.maximum(np.abs(self.vertices), np.abs(by))
        vertices = snapped(np.add(corners, there), size, grid)
        return Polygon(vertices, self._tie, (there, corners))

    def loosened(self) -> Polygon:
        return Polygon(self.vertices, 2 * self._tie, self.about)

    def outline(self, step: float) -> shapely.Geometry:
        return self.shape

    def edge_distance(self, x: Array, y: Array) -> Array:
        return shapely.distance(self.shape.exterior, shapely.points(x, y))


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
