"""Where a crack has gone: tips, paths and damage read from broken bonds.

A crack is taken to have opened where bonds between nearest neighbours (|ξ| ≤ √2 Δx) are broken;
longer bonds break ahead of it. The midpoints of these bonds mark the path to half a cell. Those
that hang together with a tip of the scene's cracks make its path, links being no longer than 1.5
cells; its tip is the point furthest along the links. Marks that hang together with no tip are a
crack of their own, which began where its first bonds broke, if it is two cells long; what is
further than a horizon from all paths along the links is another tip of its crack: the second one
of a crack that grows both ways, or a branch.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components, dijkstra
from scipy.spatial import cKDTree

from ..arrays import Array, Indices
from ..geometry import Crack, CrackSet, Frame, Region

#: Longest bond that marks the path, in cells.
SHORT = np.sqrt(2.0) * (1 + 1e-9)
# Longest link between marks, and from a crack's old tip to the first, in cells.
_LINK, _FIRST = 1.5, 2.0
# Shortest crack that begins by itself, in cells.
_CRACK = 2.0
# Share of the body's size within which ends of cracks are one.
_MET = 1e-7


@dataclass(frozen=True)
class CrackPath:
    """The way a crack has grown.

    Attributes
    ----------
    points : ndarray, shape (n, 2)
        From the old tip to the new one, m. Between them each point is the mean of all marks
        within a cell.
    """

    points: Array

    @property
    def start(self) -> Array:
        """Where the crack began to grow, shape (2,), m."""
        return self.points[0]

    @property
    def tip(self) -> Array:
        """Where it ends now, shape (2,), m."""
        return self.points[-1]

    @property
    def advance(self) -> float:
        """Distance of the tip from the start, m."""
        return float(np.linalg.norm(self.tip - self.start))

    @property
    def length(self) -> float:
        """Length of the path, m."""
        return float(np.linalg.norm(np.diff(self.points, axis=0), axis=1).sum())


def initial_tips(cracks: Sequence[Crack], region: Region) -> Array:
    """Tips of the cracks, taken as one set, that lie in the body, shape (n, 2)."""
    ends = [end for c in cracks if not c.closed for end in (c.points[0], c.points[-1])]
    if not ends:
        return np.zeros((0, 2))
    x0, y0, x1, y1 = region.bounds
    size = max(x1 - x0, y1 - y0)
    # Fine enough for whatever is drawn in the body.
    free = CrackSet.joined(Frame(np.array([x0, y0]), size / 1024), cracks).free_ends()
    points = np.array(list(dict.fromkeys(ends)))
    away = np.hypot(*(points[:, None] - free[None]).transpose(2, 0, 1))
    tip = away.min(axis=1, initial=np.inf) < _MET * size
    return points[tip & region.contains(points[:, 0], points[:, 1])]


def trace(
    starts: Array,
    marks: Array,
    spacing: float,
    steps: Indices | None = None,
    branch: float = 5.0,
) -> list[CrackPath]:
    """Paths along marks, the furthest first.

    Parameters
    ----------
    starts : ndarray, shape (k, 2)
        Tips that were there before.
    marks : ndarray, shape (n, 2)
        Midpoints of broken short bonds, m.
    spacing : float
        Δx, m.
    steps : ndarray of int, shape (n,), optional
        When each mark was made. With them cracks that began elsewhere, second tips and branches
        have paths too.
    branch : float
        Least length of a branch, in cells: a crack is a band of marks, not a line.

    Returns
    -------
    list of CrackPath
        One for each start, however short, and one for every other tip.
    """
    if not len(marks):
        return [CrackPath(start[None]) for start in starts]
    marked = _Marks(starts, marks, spacing, steps)
    paths = [marked.path(k) for k in range(len(starts))]
    if steps is None:
        return sorted(paths, key=lambda path: -path.advance)
    grown = []
    for k in range(len(starts), marked.count):
        path = marked.path(k)
        if path.advance >= _CRACK * spacing:
            grown.append(path)
    if not paths and not grown:
        grown = [marked.path(0)]
    grown += marked.branches(branch)
    return sorted([*paths, *grown], key=lambda path: -path.advance)


class _Marks:
    """Marks and starts, linked where they are near each other.

    Attributes
    ----------
    count : int
        Number of starts, those where cracks have begun of themselves included (the earliest
        first).
    """

    def __init__(self, starts: Array, marks: Array, spacing: float, steps: Indices | None) -> None:
        self.spacing = spacing
        tree = cKDTree(marks)
        pairs = tree.query_pairs(_LINK * spacing * (1 + 1e-9), output_type="ndarray")
        near = tree.query_ball_point(starts, _FIRST * spacing * (1 + 1e-9)) if len(starts) else []
        links = [np.array(found, dtype=np.int64) for found in near]
        if steps is not None:
            begun, more = _begun(marks, steps, pairs, links, spacing)
            starts, links = np.vstack([starts, begun]), links + more
        self.count = len(starts)
        self.nodes = np.vstack([starts, marks])
        first = [(k, int(j) + self.count) for k, found in enumerate(links) for j in found]
        i, j = np.vstack([pairs + self.count, np.array(first, dtype=np.int64).reshape(-1, 2)]).T
        lengths = np.linalg.norm(self.nodes[i] - self.nodes[j], axis=1)
        # A mark on the very start: csgraph takes a zero for no link.
        lengths = np.maximum(lengths, 1e-12 * spacing)
        graph = sparse.coo_array((lengths, (i, j)), shape=(len(self.nodes),) * 2).tocsr()
        # SciPy before 1.15 takes indices of 32 bits only.
        graph.indices, graph.indptr = graph.indices.astype("i4"), graph.indptr.astype("i4")
        self.graph = graph
        self.used: list[int] = list(range(self.count))
        self._distance, self._before, self._source = self._walk(self.used)

    def _walk(self, sources: list[int]) -> tuple[Array, Indices, Indices]:
        if not sources:
            size = len(self.nodes)
            return np.full(size, np.inf), np.full(size, -9999), np.full(size, -9999)
        found: tuple[Array, Indices, Indices] = dijkstra(
            self.graph,
            directed=False,
            indices=np.array(sources),
            min_only=True,
            return_predecessors=True,
        )
        return found

    def path(self, k: int) -> CrackPath:
        """From start `k` to the mark furthest from it of those that are nearest to it."""
        return self._follow(np.nonzero(self._source == k)[0], self._distance, self._before)

    def branches(self, least: float) -> list[CrackPath]:
        """Paths to what is further than `least` cells from all paths, the furthest first."""
        found: list[CrackPath] = []
        while True:
            distance, before, _ = self._walk(self.used)
            reached = np.nonzero(np.isfinite(distance))[0]
            if not len(reached) or distance[reached].max() < least * self.spacing:
                return found
            found.append(self._follow(reached, distance, before))

    def _follow(self, mine: Indices, distance: Array, before: Indices) -> CrackPath:
        furthest = float(distance[mine].max(initial=0.0))
        last = mine[distance[mine] >= furthest - 1e-6 * self.spacing]
        # Marks that are as far and beside each other (the two of a symmetric front) make one tip;
        # a mirror image of the tip is another one.
        last = last[_together(self.nodes[last], _FIRST * self.spacing) == 0]
        chain = [int(last[0])]
        while before[chain[-1]] >= 0:
            chain.append(int(before[chain[-1]]))
        chain = chain[::-1]
        points = self.nodes[chain]
        if len(chain) > 2:
            reached = mine[mine >= self.count]
            around = cKDTree(self.nodes[reached]).query_ball_point(
                points, self.spacing * (1 + 1e-9)
            )
            points[1:-1] = [self.nodes[reached[found]].mean(axis=0) for found in around[1:-1]]
        points[-1] = self.nodes[last].mean(axis=0)
        self.used += chain
        return CrackPath(points)


def _together(points: Array, reach: float) -> Indices:
    """Number of the group of every point, the first point's being 0; groups are `reach` apart."""
    pairs = cKDTree(points).query_pairs(reach * (1 + 1e-9), output_type="ndarray")
    return _groups(pairs, len(points))


def _groups(pairs: Indices, count: int) -> Indices:
    ones = np.ones(len(pairs), dtype=np.int8)
    graph = sparse.coo_array((ones, tuple(pairs.T)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def _begun(
    marks: Array, steps: Indices, pairs: Indices, links: list[Indices], spacing: float
) -> tuple[Array, list[Indices]]:
    """Where cracks that hang together with no start began, and the marks there.

    A crack begins amid those of its marks that were made first: at each group of them, if they
    lie apart.
    """
    group = _groups(pairs, len(marks))
    led = np.unique(group[np.concatenate(links)]) if links else np.zeros(0, dtype=np.int64)
    order = []
    for k in np.setdiff1d(np.unique(group), led):
        members = np.nonzero(group == k)[0]
        early = members[steps[members] == steps[members].min()]
        order.append((int(steps[early[0]]), -len(members), early))
    starts, found = [], []
    for _, _, early in sorted(order, key=lambda item: item[:2]):
        parts = _together(marks[early], _LINK * spacing)
        for part in range(parts.max() + 1):
            cluster = early[parts == part]
            away = np.linalg.norm(marks[cluster] - marks[cluster].mean(axis=0), axis=1)
            middle = cluster[away <= away.min() + 1e-6 * spacing]
            starts.append(marks[middle].mean(axis=0))
            found.append(middle)
    return np.array(starts).reshape(-1, 2), found
