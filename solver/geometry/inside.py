"""Which straight lines between particles stay inside the body.

The body is the polygon that its outline has too (`rings`), its edges included: a line along an
edge, or one that touches a re-entrant corner, stays inside. A line that leaves it, however little,
does not: any length granted would be a slot bridged. Nothing depends on the order of drawing, and
mirror images are alike, because the rule names no side.

Two kinds of particle lie off the polygon: those between a curve and its chord, and those on an edge
up to rounding. Both are asked at the nearest point of it. So a convex body loses no bond,
whatever its edge.

A line that leaves the body and comes back crosses two edges, each with some of the other on its
outer side. Only edges with such a partner within reach are looked at: none of a convex body, all of
a hole, the corners of a notch and what is near.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely

from ..arrays import Array, Indices, Mask
from ..compiled import kernel
from . import exact
from .exact import CELL, Frame, side, sign_of_cross
from .lattice import Lattice
from .regions import Region
from .rings import rings

_OPTIONS: Any = {"uses": (exact.__file__,), "nogil": True}
# How far within an edge particles are asked that lie beyond it, in units.
_WITHIN = 4.0


@dataclass(frozen=True, eq=False)
class Body:
    """A region's polygon in cells of a lattice.

    Attributes
    ----------
    frame : Frame
    vertices : ndarray, shape (v, 2)
        In whole units; the edge from each to the one after has the body to its left.
    before, after : ndarray of int, shape (v,)
        Neighbours along the ring.
    shape : shapely.Geometry
        The same as polygons.
    """

    frame: Frame
    vertices: Array
    before: Indices
    after: Indices
    shape: shapely.Geometry

    @classmethod
    def of(cls, lattice: Lattice) -> Body:
        """The body of a lattice's particles; see `within`."""
        return cls.within(lattice.region, Frame.of(lattice))

    @classmethod
    def within(cls, region: Region, frame: Frame) -> Body:
        """The body of a region.

        Raises
        ------
        NoOutlineError
            If the region has no outline.
        """
        points, before, after, polygons, count = [], [], [], [], 0
        for polygon in rings(region, frame.spacing):
            whole = [ring for ring in map(frame.units, polygon) if len(ring)]
            whole = [ring[(ring != np.roll(ring, 1, axis=0)).any(axis=1)] for ring in whole]
            whole = [ring for ring in whole if len(ring) > 2]
            if not whole:
                continue
            polygons.append(shapely.Polygon(whole[0], whole[1:]))
            for ring in whole:
                order = np.arange(len(ring)) + count
                points.append(ring)
                before.append(np.roll(order, 1))
                after.append(np.roll(order, -1))
                count += len(ring)
        shape = shapely.multipolygons(polygons)
        shapely.prepare(shape)
        return cls(
            frame, np.concatenate(points), np.concatenate(before), np.concatenate(after), shape
        )

    @cached_property
    def convex(self) -> bool:
        """Whether it is one ring that turns one way only."""
        if len(self.shape.geoms) > 1 or len(self.shape.geoms[0].interiors):
            return False
        # Python's whole numbers hold products of any size.
        whole = self.vertices.astype(np.int64).astype(object)
        (bx, by), (cx, cy) = (whole - whole[self.before]).T, (whole[self.after] - whole).T
        return bool((bx * cy - by * cx >= 0).all())

    def holds(self, points: Array) -> Mask:
        """Whether points (units), shape (n, 2), are inside or on an edge."""
        return np.asarray(shapely.intersects_xy(self.shape, points[:, 0], points[:, 1]))

    def critical(self, reach: float) -> Indices:
        """Edges that a line of length `reach` (cells) can cross and come back, by their start."""
        if self.convex:
            return np.zeros(0, dtype=np.int64)
        ends = np.stack([self.vertices, self.vertices[self.after]], axis=1)
        lines = shapely.linestrings(ends)
        tree = shapely.STRtree(lines)
        one, other = tree.query(lines, predicate="dwithin", distance=(reach + 1.0) * CELL)
        beyond = _some_beyond(ends, one, other)
        return np.asarray(np.unique(one[beyond]), dtype=np.int64)

    def drawn_in(self, points: Array) -> Array:
        """Points (units) that are not held, moved to the nearest one that is; shape (n, 2)."""
        moved = points.copy()
        off = np.nonzero(~self.holds(points))[0]
        if not len(off):
            return moved
        edges = np.stack([self.vertices, self.vertices[self.after]], axis=1)
        lines = shapely.linestrings(edges)
        tree = shapely.STRtree(lines)
        for place in off:
            point = points[place]
            nearest = int(tree.nearest(shapely.Point(point)))
            a, b = edges[nearest]
            along = (b - a) / np.hypot(*(b - a))
            foot = a + np.clip((point - a) @ along, 0.0, np.hypot(*(b - a))) * along
            target = np.rint(foot + _WITHIN * np.array([-along[1], along[0]]))
            corners = self.vertices[[nearest, self.after[nearest]]]
            closest = corners[np.argmin(np.hypot(*(corners - point).T))]
            moved[place] = target if self.holds(target[None])[0] else closest
        return moved

    def left_between(self, start: Array, ends: Array, edges: Indices) -> Mask:
        """Whether straight lines leave the body on their way.

        Parameters
        ----------
        start : ndarray, shape (2,)
        ends : ndarray, shape (n, 2)
            All in the body (units), or drawn in.
        edges : ndarray of int
            Those that lines of such a length can cross and come back (`critical`).
        """
        found = np.zeros(len(ends), dtype=bool)
        _mark_left(found, start, ends, edges, self.vertices, self.before, self.after)
        return found

    def leaving(self, lattice: Lattice, offsets: Indices) -> tuple[Indices, Mask]:
        """Pairs of particles between which a straight line leaves the body.

        Parameters
        ----------
        lattice : Lattice
        offsets : ndarray of int, shape (o, 2)
            Columns and rows from one particle to the other; the second half are the opposites of
            the first.

        Returns
        -------
        particles : ndarray of int, shape (n,)
            Those with such a pair.
        mask : ndarray of bool, shape (o, n)
        """
        reach = float(np.hypot(*offsets.T).max())
        edges = self.critical(reach)
        if not len(edges):
            return np.zeros(0, dtype=np.int64), np.zeros((len(offsets), 0), dtype=bool)
        rows, columns = lattice.rows_columns
        ends = np.stack([self.vertices[edges], self.vertices[self.after[edges]]], axis=1)
        near = near_segments(lattice, ends / CELL, reach + 1.0)
        number = np.full(lattice.shape, -1, dtype=np.int64)
        number[rows[near], columns[near]] = np.arange(len(near))
        points = np.multiply(CELL, np.column_stack([columns[near], rows[near]]), dtype=np.float64)
        half = offsets[: len(offsets) // 2].astype(np.int64)
        found = np.zeros((len(offsets), len(near)), dtype=bool)
        _mark_leaving(
            found,
            self.drawn_in(points),
            number,
            half,
            edges,
            self.vertices,
            self.before,
            self.after,
        )
        some = found.any(axis=0)
        return near[some], found[:, some]


def near_segments(lattice: Lattice, ends: Array, reach: float) -> Indices:
    """Particles near some segments, those within `reach` cells and a few more.

    Parameters
    ----------
    lattice : Lattice
    ends : ndarray, shape (e, 2, 2)
        Both ends of each, as (column, row).
    reach : float
    """
    grid = np.zeros(lattice.shape, dtype=bool)
    _mark_near(grid, ends, reach)
    return np.asarray(np.nonzero(grid[lattice.rows_columns])[0], dtype=np.int64)


@kernel(**_OPTIONS)
def _span(
    ax: float, ay: float, bx: float, by: float, low: float, high: float
) -> tuple[float, float]:
    """Least and greatest x of the segment from a to b within low ≤ y ≤ high (which it meets)."""
    if ay == by:
        return min(ax, bx), max(ax, bx)
    s = (low - ay) / (by - ay)
    t = (high - ay) / (by - ay)
    s = min(max(s, 0.0), 1.0)
    t = min(max(t, 0.0), 1.0)
    x, z = ax + s * (bx - ax), ax + t * (bx - ax)
    return min(x, z), max(x, z)


@kernel(**_OPTIONS)
def _mark_near(grid: Mask, ends: Array, reach: float) -> None:
    rows, columns = grid.shape
    for e in range(len(ends)):
        ax, ay, bx, by = ends[e, 0, 0], ends[e, 0, 1], ends[e, 1, 0], ends[e, 1, 1]
        first = max(0.0, np.ceil(min(ay, by) - reach))
        last = min(rows - 1.0, np.floor(max(ay, by) + reach))
        for j in range(int(first), int(last) + 1):
            low, high = _span(ax, ay, bx, by, j - reach, j + reach)
            begin = max(0.0, np.ceil(low - reach))
            end = min(columns - 1.0, np.floor(high + reach))
            for i in range(int(begin), int(end) + 1):
                grid[j, i] = True


@kernel(**_OPTIONS)
def _some_beyond(ends: Array, one: Indices, other: Indices) -> Mask:
    """Whether each of two edges has an end strictly on the other's outer side."""
    found = np.zeros(len(one), dtype=np.bool_)
    for k in range(len(one)):
        both = True
        for e, f in ((one[k], other[k]), (other[k], one[k])):
            some = False
            for end in range(2):
                x, y = ends[f, end, 0], ends[f, end, 1]
                at = side(ends[e, 0, 0], ends[e, 0, 1], ends[e, 1, 0], ends[e, 1, 1], x, y)
                some = some or at < 0
            both = both and some
        found[k] = both
    return found


@kernel(**_OPTIONS)
def _outwards(
    ux: float, uy: float, vx: float, vy: float, wx: float, wy: float, dx: float, dy: float
) -> bool:
    """Whether a direction points out of the body at the vertex v between u and w."""
    left_in = sign_of_cross(vx - ux, vy - uy, dx, dy) >= 0
    left_out = sign_of_cross(wx - vx, wy - vy, dx, dy) >= 0
    if side(ux, uy, vx, vy, wx, wy) >= 0:
        return not (left_in and left_out)
    return not (left_in or left_out)


@kernel(**_OPTIONS)
def _passes_out(
    px: float,
    py: float,
    qx: float,
    qy: float,
    a: int,
    vertices: Array,
    before: Indices,
    after: Indices,
) -> bool:
    """Whether the line from p to q, both in the body, leaves it at the edge that starts at a."""
    b = after[a]
    ax, ay, bx, by = vertices[a, 0], vertices[a, 1], vertices[b, 0], vertices[b, 1]
    p, q = side(ax, ay, bx, by, px, py), side(ax, ay, bx, by, qx, qy)
    if p * q > 0:
        return False
    s, t = side(px, py, qx, qy, ax, ay), side(px, py, qx, qy, bx, by)
    if s * t > 0:
        return False
    if s * t < 0:
        # Through the edge, or from it (to it) on its outer side.
        return p < 0 or q < 0
    dx, dy = qx - px, qy - py
    for v, on in ((a, s), (b, t)):
        if on != 0:
            continue
        vx, vy = vertices[v, 0], vertices[v, 1]
        # Along the line, from p and from q.
        from_p = sign_of_cross(dx, dy, -(vy - py), vx - px)
        from_q = sign_of_cross(dx, dy, -(vy - qy), vx - qx)
        if from_p < 0 or from_q > 0:
            continue
        u, w = before[v], after[v]
        ux, uy, wx, wy = vertices[u, 0], vertices[u, 1], vertices[w, 0], vertices[w, 1]
        if from_q < 0 and _outwards(ux, uy, vx, vy, wx, wy, dx, dy):
            return True
        if from_p > 0 and _outwards(ux, uy, vx, vy, wx, wy, -dx, -dy):
            return True
    return False


@kernel(**_OPTIONS)
def _mark_left(
    found: Mask,
    start: Array,
    ends: Array,
    edges: Indices,
    vertices: Array,
    before: Indices,
    after: Indices,
) -> None:
    for k in range(len(ends)):
        for e in range(len(edges)):
            found[k] = found[k] or _passes_out(
                start[0], start[1], ends[k, 0], ends[k, 1], edges[e], vertices, before, after
            )


@kernel(**_OPTIONS)
def _mark_leaving(
    found: Mask,
    points: Array,
    number: Indices,
    half: Indices,
    edges: Indices,
    vertices: Array,
    before: Indices,
    after: Indices,
) -> None:
    """Mark, for each particle, the offsets to others whose line leaves the body."""
    rows, columns = number.shape
    count = len(half)
    for e in range(len(edges)):
        a = edges[e]
        b = after[a]
        ax, ay = vertices[a, 0] / CELL, vertices[a, 1] / CELL
        bx, by = vertices[b, 0] / CELL, vertices[b, 1] / CELL
        for o in range(count):
            dx, dy = half[o, 0], half[o, 1]
            # A cell more on every side: particles beyond an edge have been drawn in.
            down, up = min(dy, 0) - 1.0, max(dy, 0) + 1.0
            left, right = min(dx, 0) - 1.0, max(dx, 0) + 1.0
            first = max(0.0, np.ceil(min(ay, by) - up))
            last = min(rows - 1.0, np.floor(max(ay, by) - down))
            for j in range(int(first), int(last) + 1):
                if j + dy < 0 or j + dy >= rows:
                    continue
                low, high = _span(ax, ay, bx, by, j + down, j + up)
                begin = max(max(0.0, -dx), np.ceil(low - right))
                end = min(min(columns - 1.0, columns - 1.0 - dx), np.floor(high - left))
                for i in range(int(begin), int(end) + 1):
                    p, q = number[j, i], number[j + dy, i + dx]
                    if p < 0 or q < 0 or found[o, p]:
                        continue
                    if _passes_out(
                        points[p, 0],
                        points[p, 1],
                        points[q, 0],
                        points[q, 1],
                        a,
                        vertices,
                        before,
                        after,
                    ):
                        found[o, p] = True
                        found[o + count, q] = True
