"""Both faces of all cracks, joined to the body's edges: who shares a node with whom.

Edges of the body (which has it on their left) and pieces of cracks (which have it on both sides)
make a plane graph. Whoever walks along it with the body on the left turns at every vertex into the
next edge clockwise from where he came from. A vertex gets one node for each such turn: two along a
crack, one at a tip, three where a crack branches, two where it runs into the edge. So nothing on
the outline joins what a crack separates, and no case is special.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from ..arrays import Array, Indices, Mask
from .crack_set import CrackSet
from .exact import CELL
from .inside import Body
from .meeting import TIE
from .rings import CLOSE, SHARP

# Units to which crossings of cracks are rounded, and length of what is left over of ends that were
# drawn beyond what they meet.
_GRID, _REST = 4.0, 16.0
# Cells from a tip on in which nodes on a face are close, and slope below which it is along a row.
# (Errors of a stress along the crack are 0.5 to 0.9 times as large with far nodes at slopes from
# 0.02 on, and larger below: there the face sees the same bonds for fifty cells.)
_BESIDE_TIP, _ALONG = 3.0, 0.02
# Turn (rad) below which a crack is straight on.
_STRAIGHT = 1e-4


@dataclass(frozen=True, eq=False)
class Traced:
    """Nodes and edges of an outline, as `solver.geometry.outline.Outline` has them."""

    nodes: Array
    edges: Indices
    face: Indices
    joints: Mask


def closed(chains: list[Array]) -> Traced:
    """The outline of a body without cracks, from closed rings with all their nodes (m)."""
    count = np.cumsum([0, *map(len, chains)])
    edges = np.concatenate(
        [
            begin + np.column_stack([np.arange(len(chain)), np.roll(np.arange(len(chain)), -1)])
            for begin, chain in zip(count[:-1], chains, strict=True)
        ]
    )
    none = np.zeros(count[-1], dtype=bool)
    return Traced(np.concatenate(chains), edges, np.zeros(len(edges), dtype=np.int64), none)


def network(cracks: CrackSet) -> tuple[Array, Indices]:
    """Cracks as straight links between points that meet nowhere else.

    Returns
    -------
    points : ndarray, shape (n, 2), units
    links : ndarray of int, shape (k, 2)
        From the end further left (lower, on upright links).
    """
    lines = shapely.union_all(shapely.linestrings(cracks.pieces), grid_size=_GRID)
    found = set()
    for part in shapely.get_parts(lines):
        chain = [tuple(point) for point in shapely.get_coordinates(part)]
        found |= {tuple(sorted(pair)) for pair in pairwise(chain)}
    beside: dict[tuple[float, ...], set[tuple[float, ...]]] = {}
    for a, b in found:
        beside.setdefault(a, set()).add(b)
        beside.setdefault(b, set()).add(a)
    # Where a straight crack was drawn in pieces is forgotten.
    for point in sorted(beside):
        if len(beside[point]) == 2:
            a, b = beside[point]
            (ax, ay), (bx, by) = ((end[0] - point[0], end[1] - point[1]) for end in (a, b))
            size = np.hypot(bx - ax, by - ay)
            if (
                abs(ax * by - ay * bx) <= _GRID * size
                and ax * bx + ay * by < 0
                and b not in beside[a]
            ):
                del beside[point]
                beside[a] = (beside[a] - {point}) | {b}
                beside[b] = (beside[b] - {point}) | {a}
    whole = sorted({tuple(sorted([a, b])) for a, others in beside.items() for b in others})
    ends = np.array(whole).reshape(-1, 2)
    points, links = np.unique(ends, axis=0, return_inverse=True)
    return points, links.reshape(-1, 2).astype(np.int64)


def open_at(ring: Array, points: Array, links: Indices, step: float) -> tuple[Array, list[int]]:
    """A closed ring with a vertex wherever a link runs into it, and which these are.

    All in units, `step` too.
    """
    mouths: set[int] = set()
    for link in links:
        first, last = points[link]
        ahead = np.roll(ring, -1, axis=0)
        _, depth, valid = meet(ring, ahead - ring, first, last)
        # From the end, so that what is inserted does not move what is still to come.
        for k in np.nonzero(valid)[0][::-1]:
            point = ring[k] + depth[k] * (ahead[k] - ring[k])
            near = np.hypot(*(ring - point).T)
            place = int(near.argmin())
            # Another mouth stays where it is, and so does a corner.
            free = near[place] <= _REST or not (place in mouths or _is_corner(ring, place))
            if near[place] < CLOSE * step and free:
                if not (place in mouths or _is_corner(ring, place)):
                    ring[place] = point
            else:
                place = int(k) + 1
                ring = np.insert(ring, place, point, axis=0)
                mouths = {m + (m >= place) for m in mouths}
            mouths.add(place)
    return ring, sorted(mouths)


def _is_corner(ring: Array, place: int) -> bool:
    """Whether a closed ring turns sharply there: corners of a body stay where they are."""
    before, here, after = ring[place - 1], ring[place], ring[(place + 1) % len(ring)]
    a, b = here - before, after - here
    return bool(abs(np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b)) > SHARP)


def trace(
    chains: list[Array], cracks: CrackSet, body: Body, steps: tuple[float, float], sharp_tips: bool
) -> Traced:
    """The outline of a body with cracks.

    Parameters
    ----------
    chains : list of ndarray, shape (n, 2), m
        Closed rings with all their nodes.
    cracks : CrackSet
    body : Body
    steps : pair of float
        Distance of nodes on edges, and on faces beside a tip or along a row, cells.
    sharp_tips : bool
        Whether the two faces of a crack share the node of each tip.
    """
    frame = cracks.frame
    points, links = network(cracks)
    scale = CELL / frame.spacing
    vertices: list[Array] = []
    starts: list[Indices] = []
    ends: list[Indices] = []
    mouths: list[int] = []
    count = 0
    for ring in chains:
        local = (ring - frame.origin) * scale
        opened, at = open_at(local.copy(), points, links, steps[0] * CELL)
        # Rings that no crack meets keep every bit.
        vertices.append(frame.origin + opened / scale if at else ring)
        order = np.arange(len(opened)) + count
        starts.append(order)
        ends.append(np.roll(order, -1))
        mouths += [count + place for place in at]
        count += len(opened)
    rim = count
    inner, pairs = _subdivided(points, links, np.concatenate(vertices), mouths, steps, body)
    vertices.append(inner)
    starts += [pairs[:, 0], pairs[:, 1]]
    ends += [pairs[:, 1], pairs[:, 0]]
    face = np.repeat([0, 1, 2], [rim, len(pairs), len(pairs)])
    return _numbered(
        np.concatenate(vertices), np.concatenate(starts), np.concatenate(ends), face, sharp_tips
    )


def _subdivided(
    points: Array,
    links: Indices,
    ring: Array,
    mouths: list[int],
    steps: tuple[float, float],
    body: Body,
) -> tuple[Array, Indices]:
    """Nodes (m) on the links within the body and pairs of them, numbered on from the ring's.

    Links that end at a mouth end at the ring's vertex.
    """
    frame = body.frame
    at_mouth = (ring[mouths] - frame.origin) * (CELL / frame.spacing)
    number = {}
    for place, point in enumerate(points):
        near = np.hypot(*(at_mouth - point).T) <= _REST
        if near.any():
            number[place] = mouths[int(np.argmax(near))]
    degree = np.bincount(links.ravel(), minlength=len(points))
    extra: list[Array] = []
    pairs: list[tuple[int, int]] = []
    place_of = dict(zip(mouths, at_mouth, strict=True))

    def vertex(place: int) -> int:
        if place not in number:
            number[place] = len(ring) + len(extra)
            extra.append(points[place])
        return number[place]

    for link in links:
        a, b = points[link]
        along = b - a
        size = np.hypot(*along)
        if size <= _REST and (degree[link] == 1).any():
            continue
        # Mouths on the link, its ends aside.
        share = (at_mouth - a) @ along / size**2
        off = np.abs((at_mouth - a) @ np.array([-along[1], along[0]]) / size)
        inner = (off <= _REST) & (share * size > _REST) & ((1 - share) * size > _REST)
        order = np.nonzero(inner)[0][np.argsort(share[inner])]
        shares = [0.0, *share[order], 1.0]
        ids: list[int | None] = [None, *[mouths[k] for k in order], None]
        for (low, one), (high, two) in pairwise(zip(shares, ids, strict=True)):
            middle = a + 0.5 * (low + high) * along
            if not shapely.contains_xy(body.shape, *middle):
                continue
            first = vertex(int(link[0])) if one is None else one
            last = vertex(int(link[1])) if two is None else two
            if first == last:
                continue
            begin = place_of.get(first, a + low * along)
            end = place_of.get(last, a + high * along)
            way = end - begin
            ends_at_tip = one is None and degree[link[0]] == 1, two is None and degree[link[1]] == 1
            chain = [first]
            for share in _stops(np.abs(way) / CELL, steps, ends_at_tip):
                chain.append(len(ring) + len(extra))
                extra.append(begin + share * way)
            chain.append(last)
            pairs += pairwise(chain)
    inside = frame.metres(np.array(extra).reshape(-1, 2))
    return inside, np.array(pairs, dtype=np.int64).reshape(-1, 2)


def _stops(way: Array, steps: tuple[float, float], tips: tuple[bool, bool]) -> Array:
    """Shares of a straight piece (2,), in cells, at which it has nodes, its ends aside.

    Along a row nodes are everywhere as close as they are beside a tip.
    """
    length, (far, close) = float(np.hypot(*way)), steps
    begin, end = (_BESIDE_TIP * tip for tip in tips)
    if way.min() <= _ALONG * way.max() or length < begin + end + 2 * far:
        count = max(1, int(np.ceil(length / close - 1e-6)))
        return np.arange(1, count) / count
    count = int(np.ceil((length - begin - end) / far))
    return (
        np.concatenate(
            [
                np.arange(close, begin, close),
                np.linspace(begin, length - end, count + 1)[not begin : count + bool(end)],
                length - np.arange(close, end, close)[::-1],
            ]
        )
        / length
    )


def _numbered(
    vertices: Array, starts: Indices, ends: Indices, face: Indices, sharp_tips: bool
) -> Traced:
    """One node for each turn at each vertex."""
    touched: list[int] = np.unique(np.concatenate([starts[face > 0], ends[face > 0]])).tolist()
    angle = np.arctan2(*(vertices[ends] - vertices[starts]).T[::-1])
    edges = np.column_stack([starts, ends])
    nodes = [*vertices]
    joints = np.zeros(len(vertices), dtype=bool)
    extra: list[bool] = []
    leaving: dict[int, list[int]] = {v: [] for v in touched}
    arriving: dict[int, list[int]] = {v: [] for v in touched}
    for lists, where in ((leaving, starts), (arriving, ends)):
        for place in np.nonzero(np.isin(where, touched))[0]:
            lists[int(where[place])].append(int(place))
    for v in leaving:
        out, turns = leaving[v], []
        for edge in arriving[v]:
            # Clockwise from the way back; the way back itself comes last.
            back = angle[edge] + np.pi
            turn = np.array([(back - angle[o]) % (2 * np.pi) for o in out])
            twins = [ends[o] == starts[edge] and starts[o] == v for o in out]
            turn[np.array(twins) & (face[edge] > 0)] = 2 * np.pi
            best = int(np.argmin(turn))
            turns.append((edge, out[best], turn[best]))
        tip = len(out) == 1
        straight = len(turns) == 2 and all(abs(turn - np.pi) < _STRAIGHT for *_, turn in turns)
        joints[v] = not straight or bool((face[out] == 0).any())

        def fresh(v: int = v) -> int:
            nodes.append(vertices[v])
            extra.append(bool(joints[v]))
            return len(nodes) - 1

        for order, (edge, following, _) in enumerate(turns):
            node = fresh() if order else v
            edges[edge, 1] = node
            edges[following, 0] = fresh() if tip and not sharp_tips else node
    return Traced(np.array(nodes), edges, face, np.append(joints, np.array(extra, dtype=bool)))


def meet(
    start: Array, bond: Array, first: Array, last: Array, low: float = 0.0, high: float = 1.0
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Position on the edges, share of the bonds, and whether they meet there.

    They do where the share lies between `low` and `high`.
    """
    along, away = last - first, first - start
    cross = bond[..., 0] * along[..., 1] - bond[..., 1] * along[..., 0]
    # An edge of no length is met by its neighbours.
    parallel = np.abs(cross) <= 1e-12 * np.hypot(*bond.T) * np.hypot(*np.atleast_2d(along).T)
    cross = np.where(parallel, 1.0, cross)
    share = (away[..., 0] * along[..., 1] - away[..., 1] * along[..., 0]) / cross
    position = (away[..., 0] * bond[..., 1] - away[..., 1] * bond[..., 0]) / cross
    valid = ~parallel & (share >= low - TIE) & (share <= high + TIE)
    valid &= (position >= -TIE) & (position <= 1 + TIE)
    return position, share, valid
