"""The body's surface as polylines: outer edges, holes, and both faces of every crack.

Nodes lie one to two and a half spacings apart and keep the corners. The body is to the left of
every edge. The faces of a crack have nodes of their own each and meet at its tips, and the edge
that a crack runs into is split there (`faces`): nothing on the outline joins what a crack
separates.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from ..arrays import Array, Indices, Mask
from .crack import Crack
from .crack_set import CrackSet
from .exact import Frame
from .faces import closed, meet, trace
from .inside import Body
from .meeting import TIE, Edges
from .regions import Region
from .rings import EDGE_STEP, rings

# Distance of nodes in spacings, `EDGE_STEP` elsewhere: on edges that run obliquely through the
# lattice some cells average out where bonds happen to end (of 1, 1.5, 2, 2.5, 3, 4 cells 2.5 had
# the smallest errors on turned rectangles, discs and holes). Between two rows of cells all nodes
# see the same bonds if they are a spacing apart: a free square then conducts exactly and converges
# at second order (with 2.5 at order 1.5). On a crack's face the last edge before the tip, where the
# faces part linearly, sets how far the lattice sees the crack reach: of 1, 2, 3 cells one has the
# smallest error in mode I and less than separate tips in mode II.
_LEVEL_STEP, _FACE_STEP = 1.0, 1.0
#: Kind of an edge between two phases of a body (`solver.geometry.phases`).
INNER = 3
# Distance of nodes, in cells, on edges of phases that run along rows but not between two.
_BESIDE = 4.0
# Least length of an edge between a corner and a border of cells, in cells.
_SLICE = 0.3
# Shares of a bond that are the same.
_SAME = 1e-7
# Share of an edge within which a point on it counts as at its node.
_AT_NODE = 4e-5
# Lines whose passages through the body are looked for at once.
_LINES = 100_000
# Angle (rad) within which two directions are one, and in which who sits in a joint counts as lying.
_NARROW, _UPWARDS = 1e-4, 0.5 * np.pi - 1e-3


@dataclass(frozen=True, eq=False)
class Outline:
    """Nodes and straight edges of a body's surface.

    Attributes
    ----------
    nodes : ndarray, shape (n, 2), m
    edges : ndarray of int, shape (e, 2)
        First and last node; the body lies to the left.
    face : ndarray of int, shape (e,)
        0 for an edge of the region, 1 and 2 for the upper and the lower face of a crack (left and
        right, where it is upright), `INNER` for an interface.
    owned : ndarray of bool, shape (e,), optional
        Whether particles on an edge are the body's (`regions`): not on the rim of a hole. All are
        by default.
    joints : ndarray of bool, shape (n,)
        Nodes at which a crack ends, bends, branches or meets an edge.
    phase : ndarray of int, shape (e,), optional
        Phase of the body to the left of each edge, in a body of several.
    shared : ndarray of int, shape (n,), optional
        For each node the one that stands for all at its place, on interfaces; itself elsewhere.
    pieces : tuple of Outline
        The outlines of the phases.
    starts : tuple of int
        The number that the first edge of each has here.
    """

    nodes: Array
    edges: Indices
    face: Indices
    owned: Mask | None = None
    joints: Mask = field(default_factory=lambda: np.zeros(0, dtype=bool))
    phase: Indices | None = None
    shared: Indices | None = None
    pieces: tuple[Outline, ...] = ()
    starts: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        if not len(self.joints):
            object.__setattr__(self, "joints", np.zeros(len(self.nodes), dtype=bool))

    @classmethod
    def of(
        cls,
        region: Region,
        cracks: Sequence[Crack] | CrackSet,
        spacing: float,
        sharp_tips: bool = True,
    ) -> Outline:
        """Outline of a region with cracks.

        Parameters
        ----------
        region : Region
        cracks : sequence of Crack, or CrackSet
        spacing : float
            Of the lattice, m.
        sharp_tips : bool
            Whether the two faces of a crack share the node of each tip. They must not once the
            crack grows.
        """
        step = EDGE_STEP * spacing
        chains = [
            _walk(
                np.append(ring, ring[:1], axis=0),
                step,
                level=_LEVEL_STEP * spacing,
                everywhere=region.settled,
            )
            for part in rings(region, spacing)
            for ring in part
        ]
        if not isinstance(cracks, CrackSet):
            frame = Frame(np.array(region.bounds[:2]), spacing)
            cracks = CrackSet.joined(frame, cracks, Body.within(region, frame))
        if len(cracks.pieces):
            body = Body.within(region, cracks.frame)
            found = trace(chains, cracks, body, (EDGE_STEP, _FACE_STEP), sharp_tips)
        else:
            found = closed(chains)
        ends = found.nodes[found.edges]
        owned = region.contains(*ends.mean(axis=1).T)
        return cls(found.nodes, found.edges, found.face, owned, found.joints)

    @property
    def edged(self) -> Mask:
        """Whether each edge bounds a phase of the body, on its surface or within: no crack."""
        return np.asarray((self.face == 0) | (self.face == INNER))

    def standing_for(self, nodes: Indices) -> Indices:
        """The nodes that stand for these."""
        return nodes if self.shared is None else self.shared[nodes]

    def touched(self, edges: Indices) -> Mask:
        """Which nodes are ends of some edges, shape (n,)."""
        at = np.zeros(len(self.nodes), dtype=bool)
        at[self.edges[edges]] = True
        return at

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
        lost = edge < 0
        if lost.any():
            # One from a particle on a crack, past a tip. What is left runs along an edge towards a
            # site on it that is no particle: there the membrane along the edge stands for it.
            found = self._hit(start[lost], bond[lost], 0.0, 1.0, tips=True)
            edge[lost], position[lost], share[lost] = found
        lost = edge < 0
        if lost.any():
            # A missing neighbour on a re-entrant corner itself, or beyond it along its edge: the
            # bond grazes the corner without leading out of the body, and ends there all the same.
            found = self._hit(start[lost], bond[lost], TIE, 1.0, grazing=True)
            edge[lost], position[lost], share[lost] = found
        # Rounding may put it beyond an end; a field linear along the edge stays exact there.
        return edge, np.clip(position, -TIE, 1.0 + TIE), share

    @property
    def _lines(self) -> NDArray[np.object_]:
        ends = self.nodes[self.edges]
        return np.asarray(shapely.linestrings(ends))

    @cached_property
    def _edges(self) -> Edges:
        """The edges, for who asks what many bonds meet."""
        return Edges(self.nodes[self.edges[:, 0]], self.nodes[self.edges[:, 1]])

    def _hit(
        self,
        start: Array,
        bond: Array,
        low: float,
        high: float,
        tips: bool = False,
        grazing: bool = False,
    ) -> tuple[Indices, Array, Array]:
        """As `first_hit`, among shares between `low` and `high`; edge −1 where nothing is met.

        With `tips` bonds end at tips too, with `grazing` at edges that they do not leave through.
        """
        count = len(start)
        edge, position, share = np.full(count, -1), np.zeros(count), np.zeros(count)
        path, met, where, depth = self._edges.met_by(start, bond, low, high)
        # Bonds leave through an edge and do not enter: particles may lie in a sliver. A
        # particle sees the face of a crack that is turned to it; one on the crack itself
        # belongs to the upper side, as for bonds that the crack cuts.
        leaves = self._leaves(bond[path], met, where) | grazing
        inwards = np.einsum("ki,ki->k", bond[path], self.outward[met]) > 0
        turned = inwards & self._turned(start[path], met)
        valid = np.where(self.face[met] == 0, leaves, turned)
        # Where a crack branches, bends or meets an edge several nodes are met: only that on the
        # particle's own side counts.
        valid &= ~self._hidden(start[path], bond[path], met, where, tips)
        path, met, where, depth = path[valid], met[valid], where[valid], depth[valid]
        # Nearest to the bond itself, then to its start.
        beyond = np.maximum(np.abs(depth - np.clip(depth, 0.0, 1.0)) - TIE, 0.0)
        # Where several are met at once, which one counts must not depend on rounding.
        order = np.lexsort((met, np.rint(depth / _SAME), np.rint(beyond / _SAME), path))
        path, nearest = np.unique(path[order], return_index=True)
        chosen = order[nearest]
        edge[path], position[path], share[path] = met[chosen], where[chosen], depth[chosen]
        return edge, position, share

    def _leaves(self, bond: Array, edge: Indices, position: Array) -> Mask:
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
        inner = both[turn < -TIE]
        leaves[inner] &= np.einsum("ki,ki->k", bond[inner], outward[other[inner]]) > 0
        return leaves

    def _beyond(self, start: Array, bond: Array) -> NDArray[np.bool_]:
        """Whether bonds lead out from a particle that lies beyond an edge, on to another one."""
        beyond = np.zeros(len(start), dtype=bool)
        own = np.nonzero(self.face == 0)[0]
        # Bonds of a particle follow each other.
        other = np.ones(len(start), dtype=bool)
        other[1:] = (start[1:] != start[:-1]).any(axis=1)
        places, which = start[other], np.cumsum(other) - 1
        points, tree = shapely.points(places), shapely.STRtree(self._lines[own])
        at, nearest = tree.query_nearest(points, all_matches=False)
        edge = np.full(len(places), -1)
        edge[at] = own[nearest]
        away = places - self.nodes[self.edges[edge, 0]]
        out = np.einsum("ki,ki->k", away, self.outward[edge])
        off = (out > TIE * self.length[edge])[which]
        edge = edge[which]
        beyond[off] = np.einsum("ki,ki->k", bond[off], self.outward[edge[off]]) > 0
        return beyond

    def _hidden(
        self, points: Array, bond: Array, edge: Indices, position: Array, tips: bool
    ) -> Mask:
        """Whether bonds meet a joint at a node that lies in another sector than they come from.

        A tip ends none at all, unless `tips`.
        """
        hidden = np.zeros(len(points), dtype=bool)
        node = np.where(position < 0.5, self.edges[edge, 0], self.edges[edge, 1])
        at = np.nonzero((np.abs(position - 0.5) > 0.5 - _AT_NODE) & self.joints[node])[0]
        if not len(at):
            return hidden
        node, bond = node[at], bond[at]
        leaving, arriving = np.full((2, len(self.nodes)), -1)
        leaving[self.edges[:, 0]] = arriving[self.edges[:, 1]] = np.arange(len(self.edges))
        one, two = leaving[node], arriving[node]
        angle = np.arctan2(*(self.nodes[self.edges[:, 1]] - self.nodes[self.edges[:, 0]]).T[::-1])
        # The body lies between the edge that leaves and, anticlockwise, the way back.
        width = (angle[two] + np.pi - angle[one]) % (2 * np.pi)
        tip = (one < 0) | (two < 0) | (np.minimum(width, 2 * np.pi - width) < _NARROW)
        away = points[at] - self.nodes[node]
        here = np.hypot(*away.T) < TIE * self.length.max()
        from_angle = np.where(here, _UPWARDS, np.arctan2(away[:, 1], away[:, 0]))

        def within(angles: Array) -> Mask:
            """Whether directions lie in the sector, edges of the region included."""
            turned = (angles - angle[one]) % (2 * np.pi)
            inside = turned < width
            for bound, arm in ((0.0, one), (width, two)):
                off = np.abs(turned - bound)
                tie = np.minimum(off, 2 * np.pi - off) < _NARROW
                # On a crack: moved upwards, an upright one to its right.
                along = np.stack([np.cos(angles), np.sin(angles)])
                left = self._upper(np.zeros(len(angles)), along.T)
                beside = np.where(arm == one, left, ~left)
                inside = np.where(tie, np.where(self.face[arm] == 0, True, beside), inside)
            return np.asarray(inside)

        seen = within(from_angle)
        # Who sits in the joint itself meets it only where the bond leaves his sector.
        towards = np.arctan2(bond[:, 1], bond[:, 0])
        way = (towards - angle[one]) % (2 * np.pi) - (from_angle - angle[one]) % (2 * np.pi)
        seen &= ~(here & within(towards) & (np.abs(way) <= np.pi))
        hidden[at] = np.where(tip, not tips, ~seen)
        return hidden

    @staticmethod
    def _upper(height: Array, along: Array) -> Mask:
        """Whether points at a height (times length) over a piece belong to its left side.

        Those on it belong to the upper one, of an upright piece to the right one.
        """
        upright = np.abs(along[..., 0]) <= TIE * np.abs(along[..., 1])
        rule = np.where(upright, along[..., 1] < 0.0, along[..., 0] > 0.0)
        tie = np.abs(height) <= TIE * (along * along).sum(axis=-1)
        return np.asarray(np.where(tie, rule, height > 0.0))

    @property
    def beside(self) -> tuple[Indices, Indices]:
        """The region's edge before and after every node, −1 where there is none, (nodes,) each."""
        return self.neighbours(self.edged)

    def neighbours(self, among: Mask) -> tuple[Indices, Indices]:
        """The same of some edges."""
        before, after = np.full((2, len(self.nodes)), -1)
        here = np.nonzero(among)[0]
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
        tree = shapely.STRtree(self._lines)
        near = _SAME * float(np.abs(bond).max(initial=0.0))
        found = [
            self._passing(tree, start[begin : begin + _LINES], bond[begin : begin + _LINES], near)
            for begin in range(0, max(len(start), 1), _LINES)
        ]
        for number, part in enumerate(found):
            part[0][:] += number * _LINES
        line, edge, position, share = (np.concatenate(each) for each in zip(*found, strict=True))
        return line, edge, position, share

    def _passing(
        self, tree: shapely.STRtree, start: Array, bond: Array, near: float
    ) -> tuple[Indices, Indices, Array, Array]:
        """As `passages`, of a few lines; within `near` (m) of an edge they run along it."""
        first, last = self.nodes[self.edges[:, 0]], self.nodes[self.edges[:, 1]]
        line, met = tree.query(shapely.linestrings(np.stack([start, start + bond], axis=1)))
        where, depth, valid = meet(start[line], bond[line], first[met], last[met])
        line, met, where, depth = line[valid], met[valid], where[valid], depth[valid]
        order = np.lexsort((depth, line))
        line, met, where, depth = line[order], met[order], where[order], depth[order]
        # A line through a node meets both its edges there: one of them counts.
        fresh = np.ones(len(line), dtype=bool)
        fresh[1:] = (line[1:] != line[:-1]) | (depth[1:] > depth[:-1] + TIE)
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
        whole[tree.query(shapely.points(middle), predicate="dwithin", distance=near)[0]] = False
        return (
            lines[count == 2][whole],
            met[pair][whole],
            where[pair][whole],
            depth[pair][whole],
        )

    def _turned(self, points: Array, edge: Indices) -> NDArray[np.bool_]:
        """Whether each point lies on the body's side of its crack face."""
        first, last = self.nodes[self.edges[edge, 0]], self.nodes[self.edges[edge, 1]]
        along, away = last - first, points - first
        height = along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0]
        return self._upper(height, along)


def _walk(
    points: Array,
    step: float,
    level: float | None = None,
    last: bool = False,
    everywhere: bool = False,
) -> Array:
    """The polyline with vertices at most `step` apart; its end too if `last`.

    Pieces that run between two rows (or columns) of cells of size `level` have vertices that far
    apart, if it is given; `everywhere` those that run along rows anywhere, at the borders of cells.
    """
    pieces = []
    for first, second in pairwise(points):
        along = np.abs(second - first)
        most = step
        if everywhere and level is not None and along.min() <= 1e-9 * along.max():
            pieces.append(_bordered(first, second, level))
            continue
        if level is not None and along.min() <= 1e-9 * along.max():
            row = first[int(np.argmin(along))] / level
            most = level if abs(row - np.rint(row)) < 1e-6 else step
        count = max(1, int(np.ceil(np.hypot(*along) / most - 1e-6)))
        pieces.append(first + np.linspace(0, 1, count, endpoint=False)[:, None] * (second - first))
    if last:
        pieces.append(points[-1:])
    return np.concatenate(pieces)


def _bordered(first: Array, second: Array, level: float) -> Array:
    """Vertices of a piece along a row where it crosses borders of cells, without its end."""
    axis = int(np.argmax(np.abs(second - first)))
    low, high = sorted((first[axis], second[axis]))
    row = first[1 - axis] / level
    # Beside a row that the edge cuts the membrane may be negative: longer edges bear that.
    level = level if abs(row - np.rint(row)) < 1e-6 else _BESIDE * level
    borders = level * np.arange(np.ceil(low / level), np.floor(high / level) + 1)
    away = np.minimum(borders - low, high - borders)
    borders = borders[away > _SLICE * level]
    share = (borders - first[axis]) / (second[axis] - first[axis])
    return np.asarray(first + np.sort(np.append(0.0, share))[:, None] * (second - first))
