"""Which straight edges lines meet, and where: looked for in squares of the plane.

Lines and edges are short beside the body. Each edge is noted in the squares that its box lies in,
and a line asks those of its own box: what is found is what comparing all with all would find.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import Array, Indices
from ..compiled import kernel

#: Share of a length within which a line counts as touching: some units of a cell (`faces`).
TIE = 2e-5
# Sine of the angle below which a line is parallel to an edge.
_PARALLEL = 1e-12
# Squares an edge at most: where edges are few they are far apart.
_SQUARES = 4.0
_OPTIONS: Any = {"nogil": True}


class Edges:
    """Straight edges that many lines are held against.

    Parameters
    ----------
    first, last : ndarray, shape (e, 2)
        Ends.
    """

    def __init__(self, first: Array, last: Array) -> None:
        self.first, self.last = np.ascontiguousarray(first), np.ascontiguousarray(last)
        length = np.hypot(*(last - first).T)
        # Padded: rounding hides no edge from a line that starts on it.
        pad = TIE * float(length.max(initial=0.0))
        self._low, self._high = np.minimum(first, last) - pad, np.maximum(first, last) + pad
        self._origin = self._low.min(axis=0)
        extent = self._high.max(axis=0) - self._origin
        least = np.sqrt(extent[0] * extent[1] / (_SQUARES * len(first)))
        self._side = float(max(length.max(), least, 1e-3 * extent.max()))
        self._shape = np.ceil(extent / self._side).astype(np.int64) + 1
        self._pointer, self._members = _noted(
            self._low, self._high, self._origin, self._side, self._shape
        )

    def met_by(
        self, start: Array, way: Array, low: float = 0.0, high: float = 1.0
    ) -> tuple[Indices, Indices, Array, Array]:
        """Edges that lines meet between two shares of their way.

        Parameters
        ----------
        start, way : ndarray, shape (n, 2)
        low, high : float

        Returns
        -------
        line, edge : ndarray of int, shape (k,)
            Line by line.
        position, share : ndarray, shape (k,)
            On the edge and of the way.
        """
        return _met(
            np.ascontiguousarray(start, dtype=np.float64),
            np.ascontiguousarray(way, dtype=np.float64),
            low,
            high,
            self.first,
            self.last,
            self._low,
            self._high,
            self._origin,
            self._side,
            self._shape,
            self._pointer,
            self._members,
        )


@kernel(**_OPTIONS)
def _square(at: float, origin: float, side: float, count: int) -> int:
    """Number of the square along one axis; those beyond the last count as the last."""
    return int(min(max(np.floor((at - origin) / side), 0.0), count - 1.0))


@kernel(**_OPTIONS)
def _noted(
    low: Array, high: Array, origin: Array, side: float, shape: Indices
) -> tuple[Indices, Indices]:
    """Edges of each square, as the pointer and the members of compressed rows."""
    columns, rows = shape[0], shape[1]
    pointer = np.zeros(columns * rows + 1, np.int64)
    members = np.zeros(0, np.int64)
    for fill in range(2):
        for e in range(len(low)):
            i0 = _square(low[e, 0], origin[0], side, columns)
            i1 = _square(high[e, 0], origin[0], side, columns)
            j0 = _square(low[e, 1], origin[1], side, rows)
            j1 = _square(high[e, 1], origin[1], side, rows)
            for j in range(j0, j1 + 1):
                for i in range(i0, i1 + 1):
                    s = j * columns + i
                    if fill:
                        # From the end: what is left of a square is its first place.
                        pointer[s] -= 1
                        members[pointer[s]] = e
                    else:
                        pointer[s] += 1
        if not fill:
            for s in range(columns * rows):
                pointer[s + 1] += pointer[s]
            members = np.zeros(pointer[columns * rows], np.int64)
    return pointer, members


@kernel(**_OPTIONS)
def _met(
    start: Array,
    way: Array,
    low: float,
    high: float,
    first: Array,
    last: Array,
    box_low: Array,
    box_high: Array,
    origin: Array,
    side: float,
    shape: Indices,
    pointer: Indices,
    members: Indices,
) -> tuple[Indices, Indices, Array, Array]:
    columns, rows = shape[0], shape[1]
    capacity, size = max(2 * len(start), 16), 0
    lines, edges = np.empty(capacity, np.int64), np.empty(capacity, np.int64)
    positions, shares = np.empty(capacity), np.empty(capacity)
    for k in range(len(start)):
        wx, wy = way[k, 0], way[k, 1]
        ax, ay = start[k, 0] + low * wx, start[k, 1] + low * wy
        bx, by = start[k, 0] + high * wx, start[k, 1] + high * wy
        x0, x1, y0, y1 = min(ax, bx), max(ax, bx), min(ay, by), max(ay, by)
        i0, i1 = _square(x0, origin[0], side, columns), _square(x1, origin[0], side, columns)
        j0, j1 = _square(y0, origin[1], side, rows), _square(y1, origin[1], side, rows)
        reach = np.hypot(wx, wy)
        for j in range(j0, j1 + 1):
            for i in range(i0, i1 + 1):
                for place in range(pointer[j * columns + i], pointer[j * columns + i + 1]):
                    e = members[place]
                    if x1 < box_low[e, 0] or x0 > box_high[e, 0]:
                        continue
                    if y1 < box_low[e, 1] or y0 > box_high[e, 1]:
                        continue
                    # Boxes that meet in several squares do so in the lowest corner of what they
                    # have in common.
                    if _square(max(x0, box_low[e, 0]), origin[0], side, columns) != i:
                        continue
                    if _square(max(y0, box_low[e, 1]), origin[1], side, rows) != j:
                        continue
                    ex, ey = last[e, 0] - first[e, 0], last[e, 1] - first[e, 1]
                    cross = wx * ey - wy * ex
                    # An edge of no length is met by its neighbours.
                    if abs(cross) <= _PARALLEL * reach * np.hypot(ex, ey):
                        continue
                    dx, dy = first[e, 0] - start[k, 0], first[e, 1] - start[k, 1]
                    share = (dx * ey - dy * ex) / cross
                    position = (dx * wy - dy * wx) / cross
                    if share < low - TIE or share > high + TIE:
                        continue
                    if position < -TIE or position > 1.0 + TIE:
                        continue
                    if size == capacity:
                        capacity *= 2
                        lines = np.append(lines, np.empty_like(lines))
                        edges = np.append(edges, np.empty_like(edges))
                        positions = np.append(positions, np.empty_like(positions))
                        shares = np.append(shares, np.empty_like(shares))
                    lines[size], edges[size] = k, e
                    positions[size], shares[size] = position, share
                    size += 1
    return lines[:size], edges[:size], positions[:size], shares[:size]
