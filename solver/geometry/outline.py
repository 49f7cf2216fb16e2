"""The body's surface as polylines: outer edges, holes, and both faces of every crack.

Nodes lie one to two and a half spacings apart and keep the corners. The body is to the left of
every edge. The faces of a crack have nodes of their own each and meet at its tips, and the edge
that a crack runs into is split there: nothing on the outline joins what a crack separates.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from ..arrays import Array, Indices, Mask
from ..errors import SceneError
from .regions import Crack, Region
from .rings import CLOSE, EDGE_STEP, SHARP, rings

# Distance of nodes in spacings, `EDGE_STEP` elsewhere: on edges that run obliquely through the
# lattice some cells average out where bonds happen to end (of 1, 1.5, 2, 2.5, 3, 4 cells 2.5 had
# the smallest errors on turned rectangles, discs and holes). Between two rows of cells all nodes
# see the same bonds if they are a spacing apart: a free square then conducts exactly and converges
# at second order (with 2.5 at order 1.5). On a crack's face the last edge before the tip, where the
# faces part linearly, sets how far the lattice sees the crack reach: of 1, 2, 3 cells one has the
# smallest error in mode I and less than separate tips in mode II.
_LEVEL_STEP, _FACE_STEP = 1.0, 1.0
# Share of the step within which a line counts as touching.
_TIE = 1e-6
# Shares of a bond that are the same.
_SAME = 1e-7
# Share of an edge within which a point on it counts as at its node.
_AT_NODE = 1e-6
# Bonds whose candidates are compared at once.
_CHUNK = 100_000


@dataclass(frozen=True, eq=False)
class Outline:
    """Nodes and straight edges of a body's surface.

    Attributes
    ----------
    nodes : ndarray, shape (n, 2), m
    edges : ndarray of int, shape (e, 2)
        First and last node; the body lies to the left.
    face : ndarray of int, shape (e,)
        0 for an edge of the region, 1 and 2 for the left and the right face of a crack.
    owned : ndarray of bool, shape (e,), optional
        Whether particles on an edge are the body's (`regions`): not on the rim of a hole. All are
        by default.
    """

    nodes: Array
    edges: Indices
    face: Indices
    owned: Mask | None = None

    @classmethod
    def of(
        cls, region: Region, cracks: Sequence[Crack], spacing: float, sharp_tips: bool = True
    ) -> Outline:
        """Outline of a region with cracks.

        Parameters
        ----------
        region : Region
        cracks : sequence of Crack
        spacing : float
            Of the lattice, m.
        sharp_tips : bool
            Whether the two faces of a crack share the node of each tip. They must not once the
            crack grows.
        """
        nodes: list[Array] = []
        edges: list[Indices] = []
        face: list[int] = []
        count = 0

        def chain(points: Array, links: Indices, kind: int) -> None:
            """Append a chain; `links` numbers its new points from 0, earlier ones below that."""
            nonlocal count
            nodes.append(points)
            edges.append(links + count)
            face.extend([kind] * len(links))
            count += len(points)

        step = EDGE_STEP * spacing
        for ring in (ring for body in rings(region, spacing) for ring in body):
            line = _walk(np.append(ring, ring[:1], axis=0), step, level=_LEVEL_STEP * spacing)
            chain(*_split(line, cracks, step), 0)
        for crack in cracks:
            line = _walk(np.array(crack.points), _FACE_STEP * spacing, last=True)
            size = len(line)
            order = np.arange(size)
            if crack.closed:
                size -= 1
                order[-1] = 0
            chain(line[:size], np.column_stack([order[:-1], order[1:]]), 1)
            if sharp_tips and not crack.closed:
                # The right face shares the nodes of tips; a mouth, on the edge or beyond, is none.
                x, y = line[[0, -1]].T
                first, last = region.contains(x, y) & (region.edge_distance(x, y) > _TIE * spacing)
                order = order - int(first)
                if first:
                    order[0] = -size
                if last:
                    order[-1] = -1
                line = line[int(first) : size - int(last)]
            chain(line[:size], np.column_stack([order[1:], order[:-1]]), 2)
        points, links = np.concatenate(nodes), np.concatenate(edges)
        middle = 0.5 * (points[links[:, 0]] + points[links[:, 1]])
        return cls(points, links, np.array(face), region.contains(*middle.T))

    @property
    def length(self) -> Array:
        """Length of each edge, m."""
        return np.hypot(*(self.nodes[self.edges[:, 1]] - self.nodes[self.edges[:, 0]]).T)

    @property
    def outward(self) -> Array:
        """Unit normal of each edge that points away from the body, shape (e, 2)."""
        along = self.nodes[self.edges[:, 1]] - self.nodes[self.edges[:, 0]]
        return np.column_stack([along[:, 1], -along[:, 0]]) / self.length[:, None]

    def along(self, position: Array) -> Array:
        """Points at a position between 0 and 1 along every edge, shape (e, 2)."""
        start, end = self.nodes[self.edges[:, 0]], self.nodes[self.edges[:, 1]]
        return start + position * (end - start)

    def first_hit(self, start: Array, bond: Array) -> tuple[Indices, Array, Array]:
        """Where bonds that leave the body meet its surface first.

        Parameters
        ----------
        start, bond : ndarray, shape (k, 2), m
            The particle and the vector to its missing neighbour.

        Returns
        -------
        edge : ndarray of int, shape (k,)
            −1 for the rare bond that grazes a curved edge and meets no chord.
        position : ndarray, shape (k,)
            Along that edge, 0 to 1.
        share : ndarray, shape (k,)
            Part of the bond that lies in the body, 0 to 1; a little beyond where chords of a
            curved edge miss a particle or its neighbour.
        """
        edge, position, share = self._hit(start, bond, 0.0, 1.0)
        # The neighbour, or the particle itself, lies in the sliver between a curved edge and its
        # chord: the bond's line meets the chord a little beyond its end or its start.
        beyond = self._beyond(start, bond)
        back = np.nonzero(beyond)[0]
        edge[back], position[back], share[back] = self._hit(start[back], bond[back], -1.0, 0.0)
        lost = edge < 0
        if lost.any():
            edge[lost], position[lost], share[lost] = self._hit(start[lost], bond[lost], -1.0, 2.0)
        return edge, np.clip(position, 0.0, 1.0), share

    @property
    def _lines(self) -> NDArray[np.object_]:
        ends = self.nodes[self.edges]
        return np.asarray(shapely.linestrings(ends))

    def _hit(
        self, start: Array, bond: Array, low: float, high: float
    ) -> tuple[Indices, Array, Array]:
        """As `first_hit`, among shares between `low` and `high`; edge −1 where nothing is met."""
        count = len(start)
        edge, position, share = np.full(count, -1), np.zeros(count), np.zeros(count)
        first, last = self.nodes[self.edges[:, 0]], self.nodes[self.edges[:, 1]]
        tree = shapely.STRtree(self._lines)
        for begin in range(0, count, _CHUNK):
            part = slice(begin, min(begin + _CHUNK, count))
            ends = [start[part] + where * bond[part] for where in (low, high)]
            path, met = tree.query(shapely.linestrings(np.stack(ends, axis=1)))
            path += begin
            where, depth, valid = _meet(start[path], bond[path], first[met], last[met], low, high)
            # Bonds leave through an edge and do not enter: particles may lie in a sliver. A
            # particle sees the face of a crack that is turned to it; one on the crack's line
            # belongs to the left, as for bonds that the crack cuts.
            leaves = self._leaves(bond[path], met, where)
            valid &= np.where(self.face[met] == 0, leaves, self._turned(start[path], met))
            # At a mouth both ends of the split edge are met: only the one on the particle's own
            # side of the crack counts.
            end = valid & (self.face[met] == 0) & (np.abs(where - 0.5) > 0.5 - 1e-6)
            valid[end] &= ~self._behind(start[path[end]], 0.5 * (first[met[end]] + last[met[end]]))
            path, met, where, depth = path[valid], met[valid], where[valid], depth[valid]
            # Nearest to the bond itself, then to its start.
            beyond = np.abs(depth - np.clip(depth, 0.0, 1.0))
            # Where several are met at once, which one counts must not depend on rounding.
            order = np.lexsort((met, np.rint(depth / _SAME), np.rint(beyond / _SAME), path))
            path, nearest = np.unique(path[order], return_index=True)
            chosen = order[nearest]
            edge[path], position[path], share[path] = met[chosen], where[chosen], depth[chosen]
        return edge, position, share

    def _leaves(self, bond: Array, edge: Indices, position: Array) -> NDArray[np.bool_]:
        """Whether bonds lead out of the body where they meet edges of the region."""
        outward = self.outward
        leaves = np.einsum("ki,ki->k", bond, outward[edge]) > 0
        before, after = self.beside
        # Through a re-entrant corner they leave if they do so through both of its edges.
        first, last = (self.edges[edge, end] for end in (0, 1))
        other = np.where(position < _AT_NODE, before[first], -1)
        other = np.where(position > 1 - _AT_NODE, after[last], other)
        both = np.nonzero((other >= 0) & (self.face[edge] == 0))[0]
        one, two = outward[edge[both]], outward[other[both]]
        turn = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
        turn[position[both] < _AT_NODE] *= -1
        inner = both[turn < -_TIE]
        leaves[inner] &= np.einsum("ki,ki->k", bond[inner], outward[other[inner]]) > 0
        return leaves

    def _beyond(self, start: Array, bond: Array) -> NDArray[np.bool_]:
        """Whether bonds lead out from a particle that lies beyond an edge, on to another one."""
        beyond = np.zeros(len(start), dtype=bool)
        own = np.nonzero(self.face == 0)[0]
        places, which = np.unique(start, axis=0, return_inverse=True)
        points, tree = shapely.points(places), shapely.STRtree(self._lines[own])
        at, nearest = tree.query_nearest(points, all_matches=False)
        edge = np.full(len(places), -1)
        edge[at] = own[nearest]
        away = places - self.nodes[self.edges[edge, 0]]
        out = np.einsum("ki,ki->k", away, self.outward[edge])
        off = (out > _TIE * self.length[edge])[which.ravel()]
        edge = edge[which.ravel()]
        beyond[off] = np.einsum("ki,ki->k", bond[off], self.outward[edge[off]]) > 0
        return beyond

    def _behind(self, points: Array, targets: Array) -> NDArray[np.bool_]:
        """Whether a crack lies between each point and its target."""
        behind = np.zeros(len(points), dtype=bool)
        for k in np.nonzero(self.face == 1)[0]:
            a, b = self.nodes[self.edges[k]]
            along = b - a
            height = [
                along[0] * (p[:, 1] - a[1]) - along[1] * (p[:, 0] - a[0]) for p in (points, targets)
            ]
            tie = _TIE * (along @ along)
            opposite = (height[0] >= -tie) != (height[1] >= -tie)
            gap = np.where(opposite, height[0] - height[1], 1.0)
            at = points + (height[0] / gap)[:, None] * (targets - points)
            share = (at - a) @ along / (along @ along)
            behind |= opposite & (share >= -_TIE) & (share <= 1 + _TIE)
        return behind

    @property
    def beside(self) -> tuple[Indices, Indices]:
        """The region's edge before and after every node, −1 where there is none, (nodes,) each."""
        before, after = np.full((2, len(self.nodes)), -1)
        here = np.nonzero(self.face == 0)[0]
        before[self.edges[here, 1]], after[self.edges[here, 0]] = here, here
        return before, after

    def corners(self, turn: float) -> Array:
        """Nodes at which the region's edge turns inwards by more than `turn` rad, shape (n, 2)."""
        before, after = self.beside
        node = np.nonzero((before >= 0) & (after >= 0))[0]
        along = self.nodes[self.edges[:, 1]] - self.nodes[self.edges[:, 0]]
        a, b = along[before[node]], along[after[node]]
        angle = np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], np.einsum("ki,ki->k", a, b))
        return self.nodes[node[angle > turn]]

    def passages(self, start: Array, bond: Array) -> tuple[Indices, Indices, Array, Array]:
        """Lines between points outside the region that pass through it once.

        Returns
        -------
        line : ndarray of int, shape (n,)
            Which of the k lines.
        edge : ndarray of int, shape (n, 2)
            Where each enters and leaves.
        position, share : ndarray, shape (n, 2)
            On the edges and along the line, 0 to 1.
        """
        first, last = self.nodes[self.edges[:, 0]], self.nodes[self.edges[:, 1]]
        tree = shapely.STRtree(self._lines)
        line, met = tree.query(shapely.linestrings(np.stack([start, start + bond], axis=1)))
        where, depth, valid = _meet(start[line], bond[line], first[met], last[met])
        line, met, where, depth = line[valid], met[valid], where[valid], depth[valid]
        order = np.lexsort((depth, line))
        line, met, where, depth = line[order], met[order], where[order], depth[order]
        # A line through a node meets both its edges there: one of them counts.
        fresh = np.ones(len(line), dtype=bool)
        fresh[1:] = (line[1:] != line[:-1]) | (depth[1:] > depth[:-1] + _TIE)
        line, met, where, depth = line[fresh], met[fresh], where[fresh], depth[fresh]
        lines, begin, count = np.unique(line, return_index=True, return_counts=True)
        begin = begin[count == 2]
        pair = begin[:, None] + np.array([0, 1])
        whole = (self.face[met[pair]] == 0).all(axis=1)
        # From a rim to a rim the line may pass through the hole, or along an edge.
        way, outward = bond[lines[count == 2]], self.outward[met[pair]]
        whole &= (np.einsum("ki,ki->k", way, outward[:, 0]) < 0) & (
            np.einsum("ki,ki->k", way, outward[:, 1]) > 0
        )
        middle = start[lines[count == 2]] + depth[pair].mean(axis=1)[:, None] * way
        near = _SAME * float(np.abs(bond).max(initial=0.0))
        whole[tree.query(shapely.points(middle), predicate="dwithin", distance=near)[0]] = False
        return (
            lines[count == 2][whole],
            met[pair][whole],
            np.clip(where[pair][whole], 0.0, 1.0),
            depth[pair][whole],
        )

    def _turned(self, points: Array, edge: Indices) -> NDArray[np.bool_]:
        """Whether each point lies on the body's side of its crack face."""
        first, last = self.nodes[self.edges[edge, 0]], self.nodes[self.edges[edge, 1]]
        along, away = last - first, points - first
        height = along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0]
        tie = _TIE * np.einsum("ki,ki->k", along, along)
        return np.asarray(np.where(self.face[edge] == 2, height > tie, height >= -tie))


def apart(cracks: Sequence[Crack]) -> None:
    """Refuse cracks that meet each other or themselves: their faces would stay joined there.

    Raises
    ------
    SceneError
    """
    lines = [shapely.LineString(crack.points) for crack in cracks]
    for line, crack in zip(lines, cracks, strict=True):
        if not line.is_simple:
            raise SceneError(f"the crack through {crack.drawn} crosses itself")
    for one, other in combinations(range(len(lines)), 2):
        if lines[one].intersects(lines[other]):
            raise SceneError(
                f"the cracks through {cracks[one].drawn} and {cracks[other].drawn} meet: "
                f"surface='extrapolated' knows no branching faces, use surface='volume'"
            )


def _walk(points: Array, step: float, level: float | None = None, last: bool = False) -> Array:
    """The polyline with vertices at most `step` apart; its end too if `last`.

    Pieces that run between two rows (or columns) of cells of size `level` have vertices that far
    apart, if it is given.
    """
    pieces = []
    for first, second in pairwise(points):
        along = np.abs(second - first)
        most = step
        if level is not None and along.min() <= 1e-9 * along.max():
            row = first[int(np.argmin(along))] / level
            most = level if abs(row - np.rint(row)) < 1e-6 else step
        count = max(1, int(np.ceil(np.hypot(*along) / most - 1e-6)))
        pieces.append(first + np.linspace(0, 1, count, endpoint=False)[:, None] * (second - first))
    if last:
        pieces.append(points[-1:])
    return np.concatenate(pieces)


def _split(ring: Array, cracks: Sequence[Crack], step: float) -> tuple[Array, Indices]:
    """A ring opened wherever a crack runs into it: points and links between them."""
    mouths: set[int] = set()
    for crack in cracks:
        for piece in crack.segments:
            first, last = np.array(piece)
            ahead = np.roll(ring, -1, axis=0)
            _, depth, valid = _meet(ring, ahead - ring, first, last)
            # From the end, so that what is inserted does not move what is still to come.
            for k in np.nonzero(valid)[0][::-1]:
                point = ring[k] + depth[k] * (ahead[k] - ring[k])
                near = np.hypot(*(ring - point).T)
                place = int(near.argmin())
                free = near[place] < _TIE * step or not _is_corner(ring, place)
                if near[place] < CLOSE * step and free:
                    ring[place] = point
                else:
                    place = int(k) + 1
                    ring = np.insert(ring, place, point, axis=0)
                    mouths = {m + (m >= place) for m in mouths}
                mouths.add(place)
    count = len(ring)
    order = np.arange(count)
    links = np.column_stack([order, (order + 1) % count])
    doubles = sorted(mouths)
    for extra, place in enumerate(doubles):
        # The edge that arrives ends at a double.
        links[(place - 1) % count, 1] = count + extra
    return np.concatenate([ring, ring[doubles]]), links


def _is_corner(ring: Array, place: int) -> bool:
    """Whether a closed ring turns sharply there: corners of a body stay where they are."""
    before, here, after = ring[place - 1], ring[place], ring[(place + 1) % len(ring)]
    a, b = here - before, after - here
    return bool(abs(np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b)) > SHARP)


def _meet(
    start: Array, bond: Array, first: Array, last: Array, low: float = 0.0, high: float = 1.0
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Position on the edges, share of the bonds, and whether they meet there.

    They do where the share lies between `low` and `high`.
    """
    along, away = last - first, first - start
    cross = bond[..., 0] * along[..., 1] - bond[..., 1] * along[..., 0]
    parallel = np.abs(cross) < 1e-12 * np.hypot(*bond.T) * np.hypot(*np.atleast_2d(along).T)
    cross = np.where(parallel, 1.0, cross)
    share = (away[..., 0] * along[..., 1] - away[..., 1] * along[..., 0]) / cross
    position = (away[..., 0] * bond[..., 1] - away[..., 1] * bond[..., 0]) / cross
    valid = ~parallel & (share >= low - _TIE) & (share <= high + _TIE)
    valid &= (position >= -_TIE) & (position <= 1 + _TIE)
    return position, share, valid
