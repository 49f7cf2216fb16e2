"""All cracks of a scene as the one set of points that they are.

How a crack was drawn does not matter: which way, in one piece or several, twice, or in another
order. A bond is cut where its segment meets the set. Exact ties follow four rules:

* A *tip*, an end from which the set runs on in one direction only, does not cut: a bond through
  the very tip stays, so that both diagonals of a tip between four particles are treated alike.
  Measured, cutting them raises the crack-tip errors by half.
* Anywhere else (where pieces join, cross, branch or bend) a bond that meets the set is cut.
* A particle *on* the set belongs to its upper side, on an upright piece to its right: it counts as
  moved by (ε², ε) with ε → 0. No rule can do without naming a side here, so the result says that
  particles lie on cracks.
* A crack does not cut along itself: a bond that runs along a piece meets it nowhere.

An end of a crack on the body's edge or beyond is a *mouth* and no tip. So is an end within half a
cell of the edge, measured straight ahead: the ligament would be thinner than anything that the
lattice can hold; the crack is taken to go on to the edge.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import shapely

from ..arrays import Array, Indices, Mask
from ..compiled import kernel
from . import exact
from .crack import Crack
from .exact import CELL, Frame, side, sign_of_cross
from .inside import Body, _span, near_segments
from .lattice import Lattice

_OPTIONS: Any = {"nogil": True}
# Units within which ends are one point: twice the rounding of each.
_SAME = 2.0
# Units by which an end that is meant to meet something goes beyond it.
_BEYOND = 8.0
#: Cells straight ahead within which an edge is met by an end.
MOUTH = 0.5


@dataclass(frozen=True, eq=False)
class CrackSet:
    """Straight pieces of cracks in cells, each drawn once.

    Attributes
    ----------
    frame : Frame
    pieces : ndarray, shape (k, 2, 2)
        Both ends in whole units; the first is the one further left (lower, on an upright piece).
    tips : ndarray of bool, shape (k, 2)
        Which ends are tips.
    of : ndarray of int, shape (cracks, pieces of the longest)
        Pieces of each crack as drawn, −1 for none.
    """

    frame: Frame
    pieces: Array
    tips: Mask
    of: Indices

    @classmethod
    def joined(cls, frame: Frame, cracks: Sequence[Crack], body: Body | None = None) -> CrackSet:
        """The set of some cracks.

        Parameters
        ----------
        frame : Frame
        cracks : sequence of Crack
        body : Body, optional
            Its edges open the ends that come near; without one no end is a mouth.
        """
        chains = _merged([frame.units(np.array(crack.points)) for crack in cracks])
        known: dict[tuple[float, ...], int] = {}
        of = np.full((len(chains), max([len(c) for c in chains], default=1)), -1)
        for row, chain in enumerate(chains):
            for place, (a, b) in enumerate(pairwise(chain)):
                if (a == b).all():
                    continue
                key = tuple(sorted([tuple(a), tuple(b)]))
                of[row, place] = known.setdefault(tuple(x for p in key for x in p), len(known))
        pieces = np.array(list(known)).reshape(-1, 2, 2)
        tips = _tips(pieces)
        if len(pieces):
            tips &= ~_reach_others(pieces, tips)
            if body is not None:
                tips &= ~_reach_edges(pieces, tips, body)
        return cls(frame, pieces, tips, of)

    def free_ends(self) -> Array:
        """Points that are tips, shape (n, 2), m."""
        return self.frame.metres(np.unique(self.pieces[self.tips], axis=0))

    def between(self, start: Array, ends: Array) -> Mask:
        """Behind which points, (n, 2), the set lies as seen from one (units); ties as for bonds.

        From a point on the set, tips aside, nothing is seen.
        """
        lying = np.zeros(1 + len(ends), dtype=bool)
        found = np.zeros(len(ends), dtype=bool)
        if len(self.pieces):
            _mark_between(found, lying, start, ends, self.pieces, self.tips)
        return found | lying[0]

    def cut(self, lattice: Lattice, offsets: Indices) -> tuple[Indices, Mask, Mask, int]:
        """Pairs of particles between which the set lies.

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
        met : ndarray of bool, shape (cracks,)
            Which cracks lie between any.
        lying : int
            Number of particles that lie on the set.
        """
        reach = float(np.hypot(*offsets.T).max())
        rows, columns = lattice.rows_columns
        near = near_segments(lattice, self.pieces / CELL, reach)
        number = np.full(lattice.shape, -1, dtype=np.int64)
        number[rows[near], columns[near]] = np.arange(len(near))
        points = np.multiply(CELL, np.column_stack([columns[near], rows[near]]), dtype=np.float64)
        on = np.zeros(len(near), dtype=bool)
        found = np.zeros((len(offsets), len(near)), dtype=bool)
        some = np.zeros(len(self.pieces), dtype=bool)
        if len(self.pieces):
            _mark_lying(on, number, points, self.pieces, self.tips)
            half = offsets[: len(offsets) // 2].astype(np.int64)
            _mark_cut(found, some, number, half, points, on, self.pieces, self.tips)
        met: Mask = np.any(np.append(some, False)[self.of], axis=1)
        cut = found.any(axis=0)
        return near[cut], found[:, cut], met, int(on.sum())


def _merged(chains: list[Array]) -> list[Array]:
    """The same with points one unit or two from each other made one, whatever the order."""
    every = np.unique(np.concatenate([np.zeros((0, 2)), *chains]), axis=0)
    if len(every) < 2:
        return chains
    tree = shapely.STRtree(shapely.points(every))
    one, other = tree.query(shapely.points(every), predicate="dwithin", distance=_SAME)
    first = np.arange(len(every))
    np.minimum.at(first, one, other)
    merged = []
    for chain in chains:
        place = [int(np.nonzero((every == p).all(axis=1))[0][0]) for p in chain]
        merged.append(every[first[place]])
    return merged


def _tips(pieces: Array) -> Mask:
    """Ends from which the set runs on in one direction only, shape (k, 2)."""
    tips = np.zeros((len(pieces), 2), dtype=bool)
    if len(pieces):
        _mark_tips(tips, pieces)
    return tips


def _reach_others(pieces: Array, tips: Mask) -> Mask:
    """Tips that lie on other pieces up to rounding; `pieces` is changed so that they cross."""
    lines = shapely.linestrings(pieces)
    tree = shapely.STRtree(lines)
    found = np.zeros_like(tips)
    ends = pieces.copy()
    for k, end in zip(*np.nonzero(tips), strict=True):
        point = ends[k, end]
        near = tree.query(shapely.Point(point), predicate="dwithin", distance=_SAME)
        if (ends[near] != point).any(axis=2).all(axis=1).any():
            along = point - ends[k, 1 - end]
            pieces[k, end] = np.rint(point + _BEYOND * along / np.hypot(*along))
            found[k, end] = True
    return found


def _reach_edges(pieces: Array, tips: Mask, body: Body) -> Mask:
    """Tips that are mouths; `pieces` is changed so that they reach the edge."""
    found = np.zeros_like(tips)
    edge = body.shape.boundary
    for k, end in zip(*np.nonzero(tips), strict=True):
        point = pieces[k, end]
        if not shapely.contains_xy(body.shape, *point):
            found[k, end] = True
            continue
        along = point - pieces[k, 1 - end]
        along /= np.hypot(*along)
        ahead = shapely.LineString([point, point + MOUTH * CELL * along])
        way = shapely.distance(shapely.Point(point), ahead.intersection(edge))
        if np.isfinite(way):
            pieces[k, end] = np.rint(point + (way + _BEYOND) * along)
            found[k, end] = True
    return found


@kernel(uses=(exact.__file__,), **_OPTIONS)
def _touches(ax: float, ay: float, bx: float, by: float, px: float, py: float) -> bool:
    """Whether p lies on the closed segment from a to b."""
    if side(ax, ay, bx, by, px, py) != 0:
        return False
    return min(ax, bx) <= px <= max(ax, bx) and min(ay, by) <= py <= max(ay, by)


@kernel(uses=(exact.__file__,), **_OPTIONS)
def _mark_tips(tips: Mask, pieces: Array) -> None:
    for k in range(len(pieces)):
        for end in range(2):
            x, y = pieces[k, end, 0], pieces[k, end, 1]
            dx, dy = pieces[k, 1 - end, 0] - x, pieces[k, 1 - end, 1] - y
            alone = True
            for j in range(len(pieces)):
                ax, ay, bx, by = pieces[j, 0, 0], pieces[j, 0, 1], pieces[j, 1, 0], pieces[j, 1, 1]
                if not _touches(ax, ay, bx, by, x, y):
                    continue
                for other in range(2):
                    ex, ey = pieces[j, other, 0] - x, pieces[j, other, 1] - y
                    if ex == 0.0 and ey == 0.0:
                        continue
                    # Another direction than the one to this piece's other end.
                    if sign_of_cross(dx, dy, ex, ey) != 0 or sign_of_cross(dx, dy, -ey, ex) < 0:
                        alone = False
            tips[k, end] = alone


@kernel(uses=(exact.__file__,), **_OPTIONS)
def _mark_lying(on: Mask, number: Indices, points: Array, pieces: Array, tips: Mask) -> None:
    """Mark particles that lie on the set, tips aside."""
    rows, columns = number.shape
    for k in range(len(pieces)):
        ax, ay, bx, by = pieces[k, 0, 0], pieces[k, 0, 1], pieces[k, 1, 0], pieces[k, 1, 1]
        first = max(0.0, np.ceil(min(ay, by) / CELL))
        last = min(rows - 1.0, np.floor(max(ay, by) / CELL))
        for j in range(int(first), int(last) + 1):
            low, high = _span(ax / CELL, ay / CELL, bx / CELL, by / CELL, j - 0.5, j + 0.5)
            begin, end = max(0.0, np.floor(low)), min(columns - 1.0, np.ceil(high))
            for i in range(int(begin), int(end) + 1):
                p = number[j, i]
                if p < 0 or on[p]:
                    continue
                x, y = points[p, 0], points[p, 1]
                if not _touches(ax, ay, bx, by, x, y):
                    continue
                tip = (tips[k, 0] and x == ax and y == ay) or (tips[k, 1] and x == bx and y == by)
                on[p] = not tip


@kernel(uses=(exact.__file__,), **_OPTIONS)
def _moved(vx: float, vy: float) -> int:
    """Sign of δ × v for the displacement δ = (ε², ε) of a particle on the set."""
    if vx != 0.0:
        return -1 if vx > 0.0 else 1
    return 1 if vy > 0.0 else (-1 if vy < 0.0 else 0)


@kernel(uses=(exact.__file__,), **_OPTIONS)
def _beside(
    px: float, py: float, qx: float, qy: float, on_p: bool, on_q: bool, x: float, y: float
) -> int:
    """Side of the line from p to q on which (x, y) lies, with both where they count as being."""
    found = side(px, py, qx, qy, x, y)
    if found != 0 or not (on_p or on_q):
        return found
    # The derivative of (q − p) × (a − p) as p, or q, or both move by δ.
    if on_p and on_q:
        return _moved(qx - px, qy - py)
    if on_p:
        return _moved(qx - x, qy - y)
    return _moved(x - px, y - py)


@kernel(uses=(exact.__file__,), **_OPTIONS)
def cuts(
    px: float,
    py: float,
    qx: float,
    qy: float,
    on_p: bool,
    on_q: bool,
    ax: float,
    ay: float,
    bx: float,
    by: float,
    tip_a: bool,
    tip_b: bool,
) -> bool:
    """Whether a piece from a to b lies between p and q; see the module for ties.

    Parameters
    ----------
    px, py, qx, qy : float
        Particles, units.
    on_p, on_q : bool
        Whether they lie on the set, tips aside.
    ax, ay, bx, by : float
        The piece.
    tip_a, tip_b : bool
    """
    p, q = side(ax, ay, bx, by, px, py), side(ax, ay, bx, by, qx, qy)
    # A particle on the line of the piece: (b − a) × δ.
    if p == 0 and on_p:
        p = -_moved(bx - ax, by - ay)
    if q == 0 and on_q:
        q = -_moved(bx - ax, by - ay)
    if p * q > 0 or (p == 0 and q == 0):
        return False
    a = _beside(px, py, qx, qy, on_p, on_q, ax, ay)
    b = _beside(px, py, qx, qy, on_p, on_q, bx, by)
    if a * b > 0:
        return False
    return not ((a == 0 and tip_a) or (b == 0 and tip_b))


@kernel(uses=(exact.__file__,), **_OPTIONS)
def _lies(x: float, y: float, pieces: Array, tips: Mask) -> bool:
    """Whether a point lies on the set, tips aside."""
    for k in range(len(pieces)):
        ax, ay, bx, by = pieces[k, 0, 0], pieces[k, 0, 1], pieces[k, 1, 0], pieces[k, 1, 1]
        if not _touches(ax, ay, bx, by, x, y):
            continue
        tip = (tips[k, 0] and x == ax and y == ay) or (tips[k, 1] and x == bx and y == by)
        if not tip:
            return True
    return False


@kernel(uses=(exact.__file__,), **_OPTIONS)
def _mark_between(
    found: Mask, lying: Mask, start: Array, ends: Array, pieces: Array, tips: Mask
) -> None:
    lying[0] = _lies(start[0], start[1], pieces, tips)
    for n in range(len(ends)):
        x, y = ends[n, 0], ends[n, 1]
        lying[n + 1] = _lies(x, y, pieces, tips)
        for k in range(len(pieces)):
            found[n] = found[n] or cuts(
                start[0],
                start[1],
                x,
                y,
                lying[0],
                lying[n + 1],
                pieces[k, 0, 0],
                pieces[k, 0, 1],
                pieces[k, 1, 0],
                pieces[k, 1, 1],
                tips[k, 0],
                tips[k, 1],
            )


@kernel(uses=(exact.__file__,), **_OPTIONS)
def _mark_cut(
    found: Mask,
    some: Mask,
    number: Indices,
    half: Indices,
    points: Array,
    on: Mask,
    pieces: Array,
    tips: Mask,
) -> None:
    """Mark, for each particle, the offsets to others behind a piece; and pieces that part any."""
    rows, columns = number.shape
    count = len(half)
    for k in range(len(pieces)):
        ax, ay, bx, by = pieces[k, 0, 0], pieces[k, 0, 1], pieces[k, 1, 0], pieces[k, 1, 1]
        for o in range(count):
            dx, dy = half[o, 0], half[o, 1]
            down, up = min(dy, 0) - 0.5, max(dy, 0) + 0.5
            left, right = min(dx, 0) - 0.5, max(dx, 0) + 0.5
            first = max(0.0, np.ceil(min(ay, by) / CELL - up))
            last = min(rows - 1.0, np.floor(max(ay, by) / CELL - down))
            for j in range(int(first), int(last) + 1):
                if j + dy < 0 or j + dy >= rows:
                    continue
                low, high = _span(ax / CELL, ay / CELL, bx / CELL, by / CELL, j + down, j + up)
                begin = max(max(0.0, -dx), np.ceil(low - right))
                end = min(min(columns - 1.0, columns - 1.0 - dx), np.floor(high - left))
                for i in range(int(begin), int(end) + 1):
                    p, q = number[j, i], number[j + dy, i + dx]
                    if p < 0 or q < 0:
                        continue
                    if cuts(
                        points[p, 0],
                        points[p, 1],
                        points[q, 0],
                        points[q, 1],
                        on[p],
                        on[q],
                        ax,
                        ay,
                        bx,
                        by,
                        tips[k, 0],
                        tips[k, 1],
                    ):
                        some[k] = True
                        found[o, p] = True
                        found[o + count, q] = True
