"""Which rigid motions nothing prevents: found before a singular system is solved.

A body falls into parts whose triangles hang together by whole edges; each part has three rigid
motions (u₁, u₂, θ). Every held component, and every vertex that two parts share (a hinge), is a
linear condition on them. What satisfies all conditions is free.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from references.eigen import RIGID_MOTIONS

# of the conditions' singular values: two held points may be this far apart over the part's size
_RANK = 1e-9


@dataclass(frozen=True)
class FreeMotions:
    """Rigid motions that nothing prevents.

    Attributes
    ----------
    centres : (parts, 2) float array
        Mean vertex of each part.
    motions : (k, parts, 3) float array
        Orthonormal; velocity of each part's centre and its rate of rotation times its size.
    sizes : (parts,) float array
    """

    centres: NDArray[np.float64]
    motions: NDArray[np.float64]
    sizes: NDArray[np.float64]

    @property
    def number(self) -> int:
        """How many there are; 0 for a body that is held."""
        return len(self.motions)

    def describe(self) -> str:
        """The free motions in words, part by part."""
        words = []
        for part, (centre, size) in enumerate(zip(self.centres, self.sizes, strict=True)):
            _, strength, basis = np.linalg.svd(self.motions[:, part])
            own = basis[: int((strength > 1e-6).sum())]
            if not len(own):
                continue
            where = "" if len(self.centres) == 1 else f"the part about {_pair(centre)}: "
            words.append(where + " and ".join(_named(own, centre, size)))
        return "; ".join(words)


def _pair(point: NDArray[np.float64]) -> str:
    return f"({point[0]:.3g}, {point[1]:.3g})"


def _named(motions: NDArray[np.float64], centre: NDArray[np.float64], size: float) -> list[str]:
    """Names of the rigid motions that span (k, 3)."""
    if len(motions) == 3:
        return ["translation along axis 1", "translation along axis 2", "rotation"]
    # translations first: combinations without rotation
    turn = np.linalg.svd(motions[:, 2:].T)[2]
    ordered = turn[::-1] @ motions
    names = []
    for u1, u2, spin in ordered:
        if abs(spin) > 1e-6:
            rate = spin / size
            pole = centre + np.array([-u2, u1]) / rate
            names.append(f"rotation about {_pair(pole)}")
        elif abs(u2) < 1e-6:
            names.append("translation along axis 1")
        elif abs(u1) < 1e-6:
            names.append("translation along axis 2")
        else:
            names.append(f"translation along ({u1:.3g}, {u2:.3g})")
    return names


def parts_of(triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    """Part (M,) of each triangle; parts hang together by whole edges."""
    number = len(triangles)
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [0, 2]]].reshape(-1, 2), axis=1)
    _, edge = np.unique(edges, axis=0, return_inverse=True)
    edge = edge.ravel()
    owner = np.repeat(np.arange(number), 3)
    incidence = coo_matrix((np.ones(len(edge)), (owner, edge))).tocsr()
    labels: NDArray[np.int64] = connected_components(incidence @ incidence.T, directed=False)[1]
    return labels


def free_motions(
    nodes: NDArray[np.float64], element_nodes: NDArray[np.int64], held: NDArray[np.bool_]
) -> FreeMotions:
    """Rigid motions that the held components leave free.

    Parameters
    ----------
    nodes : (n, 2) float array
    element_nodes : (3 or 6, M) int array
        The first three are the corners.
    held : (n, 2) bool array
        Components of nodes that are prescribed.

    Returns
    -------
    FreeMotions
    """
    part = parts_of(element_nodes[:3].T)
    number = int(part.max()) + 1
    member = np.unique(np.column_stack([np.tile(part, len(element_nodes)), element_nodes.ravel()]),
                       axis=0)  # fmt: skip
    centres = np.array([nodes[member[member[:, 0] == p, 1]].mean(axis=0) for p in range(number)])
    arms = nodes[member[:, 1]] - centres[member[:, 0]]
    sizes = np.zeros(number)
    np.maximum.at(sizes, member[:, 0], np.abs(arms).max(axis=1))
    arms /= sizes[member[:, 0]][:, None]
    rows = []
    for component, lever in ((0, -arms[:, 1]), (1, arms[:, 0])):
        # a part's motion at each of its nodes, along one axis
        at_node = np.zeros((len(member), number, 3))
        at_node[np.arange(len(member)), member[:, 0], component] = 1
        at_node[np.arange(len(member)), member[:, 0], 2] = lever
        rows.append(at_node[held[member[:, 1], component]])
        order = np.argsort(member[:, 1], kind="stable")
        shared = np.flatnonzero(np.diff(member[order, 1]) == 0)
        rows.append(at_node[order[shared + 1]] - at_node[order[shared]])
    conditions = np.concatenate(rows).reshape(-1, 3 * number)
    # the triangular factor has the same null space and only 3 · parts rows
    compact = np.linalg.qr(conditions, mode="r") if len(conditions) > 3 * number else conditions
    _, values, vectors = np.linalg.svd(compact, full_matrices=True)
    rank = int((values > _RANK * values.max(initial=0.0)).sum())
    return FreeMotions(centres, vectors[rank:].reshape(-1, number, 3), sizes)


def require_held(
    nodes: NDArray[np.float64], element_nodes: NDArray[np.int64], held: NDArray[np.bool_]
) -> None:
    """Raise ValueError, with the free motion's name, unless all parts of an elastic body are held.

    Parameters as in :func:`free_motions`.
    """
    found = free_motions(nodes, element_nodes, held)
    if found.number:
        raise ValueError(f"the supports leave rigid motions free: {found.describe()}")


def require_temperature(
    nodes: NDArray[np.float64], element_nodes: NDArray[np.int64], held: NDArray[np.bool_]
) -> None:
    """Raise ValueError unless every part of a conductor has a prescribed temperature.

    Parameters
    ----------
    nodes : (n, 2) float array
    element_nodes : (3 or 6, M) int array
    held : (n,) bool array
    """
    corners, cells = element_nodes[:3], element_nodes.shape[1]
    index = (np.tile(np.arange(cells), 3), corners.ravel())
    touch = coo_matrix((np.ones(3 * cells), index), shape=(cells, len(nodes))).tocsr()
    number, part = connected_components(touch @ touch.T, directed=False)
    for p in range(number):
        own = np.unique(element_nodes[:, part == p])
        if not held[own].any():
            where = _pair(nodes[own].mean(axis=0))
            raise ValueError(
                f"no boundary of the part about {where} has a temperature: its field is known up"
                " to a constant only"
            )


def rigid_motions(
    nodes: NDArray[np.float64], element_nodes: NDArray[np.int64], held: NDArray[np.bool_]
) -> int:
    """Number of rigid motions among the modes: 3 for a free body, 0 for a held one.

    Raises
    ------
    ValueError
        If a part of the body can move without strain beyond that.
    """
    found = free_motions(nodes, element_nodes, held)
    if held.any() and found.number:
        raise ValueError(f"the supports leave rigid motions free: {found.describe()}")
    if not held.any() and found.number != RIGID_MOTIONS:
        raise ValueError(
            f"a free body has three rigid motions, this one has {found.number}: it is in"
            f" {len(found.centres)} parts ({found.describe()})"
        )
    return found.number
