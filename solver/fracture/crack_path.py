"""Where a crack has gone: tips, paths and damage read from broken bonds.

A crack is taken to have opened where bonds between nearest neighbours (|ξ| ≤ √2 Δx) are broken;
longer bonds break ahead of it. The midpoints of these bonds mark the path to half a cell. Those
that hang together with a tip of the scene's cracks (or, without one, with what broke first) make
its path, links being no longer than 1.5 cells; its tip is the point furthest along the links.
Single bonds that broke elsewhere do not belong to it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from ..arrays import Array
from ..geometry import Crack, Region

#: Longest bond that marks the path, in cells.
SHORT = np.sqrt(2.0) * (1 + 1e-9)
# Longest link between marks, and from a crack's old tip to the first, in cells.
_LINK, _FIRST = 1.5, 2.0


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
    """Ends of the cracks that lie in the body, shape (n, 2)."""
    ends = [end for c in cracks if not c.closed for end in (c.points[0], c.points[-1])]
    if not ends:
        return np.zeros((0, 2))
    points = np.array(ends)
    return points[region.contains(points[:, 0], points[:, 1])]


def trace(starts: Array, marks: Array, spacing: float) -> list[CrackPath]:
    """Paths from each start along marks, the longest first.

    Parameters
    ----------
    starts : ndarray, shape (k, 2)
    marks : ndarray, shape (n, 2)
        Midpoints of broken short bonds, m.
    spacing : float
        Δx, m.

    Returns
    -------
    list of CrackPath, one for each start
    """
    count = len(starts)
    if not count:
        return []
    if not len(marks):
        return [CrackPath(start[None]) for start in starts]
    nodes = np.vstack([starts, marks])
    tree = cKDTree(marks)
    pairs = tree.query_pairs(_LINK * spacing * (1 + 1e-9), output_type="ndarray") + count
    near = tree.query_ball_point(starts, _FIRST * spacing * (1 + 1e-9))
    first = [(k, j + count) for k, found in enumerate(near) for j in found]
    i, j = np.vstack([pairs, np.array(first, dtype=np.int64).reshape(-1, 2)]).T
    lengths = np.linalg.norm(nodes[i] - nodes[j], axis=1)
    # A mark on the very start: csgraph takes a zero for no link.
    lengths = np.maximum(lengths, 1e-12 * spacing)
    graph = sparse.coo_array((lengths, (i, j)), shape=(len(nodes), len(nodes))).tocsr()
    # SciPy before 1.15 takes indices of 32 bits only.
    graph.indices, graph.indptr = graph.indices.astype("i4"), graph.indptr.astype("i4")
    distance, before, source = dijkstra(
        graph, directed=False, indices=np.arange(count), min_only=True, return_predecessors=True
    )
    paths = []
    for k in range(count):
        mine = np.nonzero(source == k)[0]
        furthest = float(distance[mine].max(initial=0.0))
        # Marks that are as far (the two of a symmetric front) make one tip.
        last = mine[distance[mine] >= furthest - 1e-6 * spacing]
        chain = [int(last[0])]
        while chain[-1] >= count:
            chain.append(int(before[chain[-1]]))
        chain = chain[::-1]
        points = nodes[chain]
        if len(chain) > 2:
            reached = mine[mine >= count]
            around = cKDTree(nodes[reached]).query_ball_point(points, spacing * (1 + 1e-9))
            points[1:-1] = [nodes[reached[found]].mean(axis=0) for found in around[1:-1]]
        points[-1] = nodes[last].mean(axis=0)
        paths.append(CrackPath(points))
    return sorted(paths, key=lambda path: -path.advance)
