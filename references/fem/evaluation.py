"""Finite-element functions on straight-edged triangles, evaluated at arbitrary points."""

from dataclasses import dataclass, field

import numpy as np
import skfem
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from references.fem.mesh import Mesh

ELEMENTS = {1: skfem.ElementTriP1, 2: skfem.ElementTriP2}


def check_order(order: int) -> None:
    """Raise ValueError unless the polynomial order is 1 or 2."""
    if order not in ELEMENTS:
        raise ValueError(f"linear and quadratic elements (order 1, 2) only, not order {order}")


def check_mesh(mesh: Mesh) -> None:
    """Raise ValueError if there is no mesh or one of its triangles has no area."""
    if not isinstance(mesh, Mesh) or not len(mesh.triangles):
        raise ValueError("a mesh of triangles is needed (see references.fem.mesh)")
    a, b, c = (mesh.points[mesh.triangles[:, i]] for i in range(3))
    twice = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    if not (np.abs(twice) > 0).all():
        raise ValueError("the mesh has triangles without area: some of their points coincide")


def as_points(points: ArrayLike) -> NDArray[np.float64]:
    """Points as an (n, 2) array of finite numbers."""
    found = np.atleast_2d(np.asarray(points, dtype=float))
    if found.ndim != 2 or found.shape[1] != 2 or not np.isfinite(found).all():
        raise ValueError("points must be an (n, 2) array of finite coordinates")
    return found


@dataclass
class Locator:
    """Finds the triangle that holds a point.

    A point between a chord and the curved boundary lies in no triangle; it gets the one whose
    barycentric coordinates it violates least, and the field is extrapolated from there. Beside a
    slit this rule keeps a point on its own side, because on the wrong side the slit's edge is
    violated too. A point exactly *on* a slit may come out on either face: move it off.
    """

    mesh: Mesh
    _tree: cKDTree = field(init=False, repr=False)
    _inverse: NDArray[np.float64] = field(init=False, repr=False)
    _origin: NDArray[np.float64] = field(init=False, repr=False)
    _reach: float = field(init=False, repr=False)

    def __post_init__(self) -> None:
        a, b, c = (self.mesh.points[self.mesh.triangles[:, i]] for i in range(3))
        centroids = (a + b + c) / 3
        self._origin = a
        self._inverse = np.linalg.inv(np.stack([b - a, c - a], axis=-1))
        self._tree = cKDTree(centroids)
        corners = np.stack([a, b, c], axis=1) - centroids[:, None]
        self._reach = float(np.linalg.norm(corners, axis=-1).max())

    def __call__(
        self, points: NDArray[np.float64]
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Triangles (n,) and local coordinates (n, 2) of points (n, 2)."""
        cells = np.zeros(len(points), dtype=np.int64)
        local = np.zeros((len(points), 2))
        todo = np.arange(len(points))
        number = len(self.mesh.triangles)
        for neighbours in (12, 96, number):
            distance, candidates = self._tree.query(points[todo], min(neighbours, number))
            candidates = candidates.reshape(len(todo), -1)
            violation, coordinates = self._score(points[todo], candidates)
            best = violation.argmin(axis=1)
            row = np.arange(len(todo))
            cells[todo], local[todo] = candidates[row, best], coordinates[row, best]
            # a triangle's corners reach no farther from its centroid than the largest reach
            seen_all = distance.reshape(len(todo), -1)[:, -1] > self._reach
            todo = todo[(violation[row, best] > 1e-10) & ~seen_all]
            if not len(todo) or neighbours >= number:
                break
        return cells, local

    def _score(
        self, points: NDArray[np.float64], candidates: NDArray[np.int64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        relative = points[:, None] - self._origin[candidates]
        local = np.einsum("nkij,nkj->nki", self._inverse[candidates], relative)
        third = 1 - local.sum(axis=-1)
        violation = np.maximum(-third, 0) + np.maximum(-local, 0).sum(axis=-1)
        return violation, local

    def gradients(
        self, cells: NDArray[np.int64], reference: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Reference gradients (n, 2) -> gradients in space (n, 2)."""
        found: NDArray[np.float64] = np.einsum("nij,ni->nj", self._inverse[cells], reference)
        return found


@dataclass
class Field:
    """A P1 or P2 function with one or more components.

    Attributes
    ----------
    mesh : Mesh
    order : int
        1 or 2.
    nodes : (n, 2) float array
        Where the nodal values sit (vertices, then for P2 the mid-sides).
    values : (n,) or (n, c) float array
    element_dofs : (3 or 6, M) int array
        Nodes of each triangle, in scikit-fem's order.
    """

    mesh: Mesh
    order: int
    nodes: NDArray[np.float64]
    values: NDArray[np.float64]
    element_dofs: NDArray[np.int64]
    triangles: NDArray[np.int64]
    _locator: Locator | None = field(default=None, repr=False)

    def at(self, points: ArrayLike) -> NDArray[np.float64]:
        """Values (n,) or (n, c) at points (n, 2)."""
        return self._evaluate(as_points(points))[0]

    def gradient_at(self, points: ArrayLike) -> NDArray[np.float64]:
        """Gradient (n, 2) or (n, c, 2) at points, element by element (discontinuous)."""
        return self._evaluate(as_points(points))[1]

    def _evaluate(
        self, points: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        if self._locator is None:
            # scikit-fem sorts each triangle's nodes: locate in its own numbering
            self._locator = Locator(Mesh(self.mesh.points, self.triangles, {}, (), self.mesh.size))
        cells, local = self._locator(points)
        nodal = self.values.reshape(len(self.nodes), -1)
        value = np.zeros((len(points), nodal.shape[1]))
        gradient = np.zeros((len(points), nodal.shape[1], 2))
        element = ELEMENTS[self.order]()
        for i, dofs in enumerate(self.element_dofs):
            shape, slope = element.lbasis(local.T, i)
            slope = np.broadcast_to(np.asarray(slope, float).reshape(2, -1), local.T.shape)
            weights = nodal[dofs[cells]]
            value += np.reshape(shape, (-1, 1)) * weights
            space = self._locator.gradients(cells, np.ascontiguousarray(slope.T))
            gradient += weights[:, :, None] * space[:, None, :]
        if self.values.ndim == 1:
            return value[:, 0], gradient[:, 0]
        return value, gradient


def to_skfem(mesh: Mesh) -> tuple[skfem.MeshTri, dict[str, NDArray[np.int64]]]:
    """scikit-fem's mesh and the facet numbers of each named boundary.

    Raises
    ------
    ValueError
        If the mesh is no good (:func:`check_mesh`) or a boundary edge is not one of the mesh.
    """
    check_mesh(mesh)
    found = skfem.MeshTri(
        np.ascontiguousarray(mesh.points.T), np.ascontiguousarray(mesh.triangles.T)
    )
    number = len(mesh.points)
    keys = found.facets[0].astype(np.int64) * number + found.facets[1]
    order = np.argsort(keys)
    facets = {}
    for name, edges in mesh.boundaries.items():
        wanted = edges.min(axis=1) * number + edges.max(axis=1)
        position = np.searchsorted(keys[order], wanted)
        if len(wanted) and not np.array_equal(keys[order][position % len(keys)], wanted):
            raise ValueError(f"boundary {name!r} has edges that are not edges of the mesh")
        facets[name] = order[position]
    return found, facets


def dirichlet_points(
    mesh: Mesh, nodes: NDArray[np.float64], element_nodes: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Node positions for prescribed values, on the right side of a slit.

    A node on a crack face has the position of its twin on the other face, where a field that
    jumps has two values. Such nodes, vertices and mid-sides, are moved into the elements that own
    them by 1e-12 of those elements, or by some rounding errors of the coordinates if that is more
    (else an inclined face would not feel it).

    Parameters
    ----------
    mesh : Mesh
    nodes : (n, 2) float array
        Vertices, numbered as in the mesh, then mid-sides.
    element_nodes : (3 or 6, M) int array
        In scikit-fem's order: corners, then the middles of edges 01, 12, 02.
    """
    moved = nodes.copy()
    if "crack" not in mesh.boundaries:
        return moved
    faces = np.zeros(len(nodes), dtype=bool)
    faces[mesh.nodes("crack")] = True
    if len(element_nodes) == 6:
        number = len(mesh.points)
        crack = np.sort(mesh.boundaries["crack"], axis=1) @ [number, 1]
        for middle, ends in enumerate(((0, 1), (1, 2), (0, 2)), start=3):
            edge = np.sort(element_nodes[list(ends)], axis=0).T @ [number, 1]
            faces[element_nodes[middle][np.isin(edge, crack)]] = True
    centroids = nodes[element_nodes[:3]].mean(axis=0)
    inward = np.zeros((len(nodes), 2))
    for row in element_nodes:
        np.add.at(inward, row, centroids - nodes[row])
    length = np.hypot(*inward[faces].T)[:, None]
    rounding = 64 * np.finfo(float).eps * np.abs(nodes).max()
    moved[faces] += np.maximum(1e-12, rounding / length) * inward[faces]
    return moved
