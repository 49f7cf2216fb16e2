"""Open a mesh along crack edges: two faces with nodes of their own, shared tips."""

from collections import defaultdict

import numpy as np
from numpy.typing import NDArray


def boundary_edges(triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    """Edges (k, 2) that belong to one triangle only."""
    edges = np.sort(
        np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1
    )
    unique, count = np.unique(edges, axis=0, return_counts=True)
    return unique[count == 1]


def split_along(
    points: NDArray[np.float64], triangles: NDArray[np.int64], edges: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
    """Double the nodes of crack edges.

    Around a node of the crack its triangles fall into groups that hang together across edges that
    are not crack edges. Every group but the first gets a copy of the node: one group at a tip
    (nothing happens), two along a face and at a kink or mouth, more at a junction.

    Parameters
    ----------
    points : (N, 2) float array
    triangles : (M, 3) int array
    edges : (k, 2) int array
        Crack edges, each shared by two triangles.

    Returns
    -------
    points, triangles : arrays
        Of the opened mesh.
    tips : int array
        Nodes of the crack that stayed single.

    Raises
    ------
    ValueError
        If an end of the crack edges is all there is: a crack of one edge has no inner node to open.
    """
    triangles = triangles.copy()
    crack = {(min(a, b), max(a, b)) for a, b in edges.tolist()}
    on_crack = np.unique(edges)
    touching = np.flatnonzero(np.isin(triangles, on_crack).any(axis=1))
    around: dict[int, list[int]] = defaultdict(list)
    for t in touching.tolist():
        for node in triangles[t].tolist():
            around[node].append(t)
    original = {t: tuple(triangles[t].tolist()) for t in touching.tolist()}
    added: list[NDArray[np.float64]] = []
    tips: list[int] = []
    for node in on_crack.tolist():
        groups = _groups(node, around[node], original, crack)
        if len(groups) == 1:
            tips.append(node)
        for group in groups[1:]:
            copy = len(points) + len(added)
            added.append(points[node])
            for t in group:
                triangles[t, original[t].index(node)] = copy
    if not added:
        raise ValueError("the crack is shorter than two elements: use smaller elements at its tips")
    return np.vstack([points, *added]), triangles, np.array(tips, dtype=np.int64)


def _groups(
    node: int,
    around: list[int],
    triangles: dict[int, tuple[int, ...]],
    crack: set[tuple[int, int]],
) -> list[list[int]]:
    """Triangles around a node, grouped by what hangs together without crossing the crack."""
    by_spoke: dict[int, list[int]] = defaultdict(list)
    for t in around:
        for other in triangles[t]:
            if other != node and (min(node, other), max(node, other)) not in crack:
                by_spoke[other].append(t)
    neighbours: dict[int, list[int]] = defaultdict(list)
    for pair in by_spoke.values():
        for t in pair:
            neighbours[t] += pair
    groups: list[list[int]] = []
    seen: set[int] = set()
    for start in around:
        if start in seen:
            continue
        group, queue = [], [start]
        seen.add(start)
        while queue:
            t = queue.pop()
            group.append(t)
            for other in neighbours[t]:
                if other not in seen:
                    seen.add(other)
                    queue.append(other)
        groups.append(group)
    return groups
