"""Statics and steady conduction of a body of several solids, with everything that may act on it.

One assembly for both: the unknown has one component or two, the tensor relates what the body's
gradient makes of it (ε11, ε22, 2 ε12 or ∇T) to the stress or the (negative) flux.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
import skfem
from numpy.typing import ArrayLike, NDArray

from references.fem.elasticity import component_dofs
from references.fem.evaluation import (
    ELEMENTS,
    Field,
    check_mesh,
    check_order,
    dirichlet_points,
    to_skfem,
)
from references.fem.mesh import Mesh
from references.fem.restraint import require_held, require_temperature
from references.linear import solve_with_prescribed

Array = NDArray[np.float64]
#: (x, y) → (components, *x.shape).
Density = Callable[[Array, Array], ArrayLike]
#: (x, y, n1, n2) → (components, *x.shape).
OnEdge = Callable[[Array, Array, Array, Array], ArrayLike]


@dataclass(frozen=True)
class Acting:
    """What acts on a body; everything adds up.

    Attributes
    ----------
    volume : sequence of Density
        Per volume.
    spread : sequence of ((x, y) → bool, amount)
        What enters in all, per thickness, evenly where a condition is true: as much whatever the
        mesh makes of the condition's rim.
    edge : sequence of OnEdge
        Per area of the boundary ``edge``, of outward normal n.
    points : sequence of (places (k, 2), what acts at each (k, components))
        Per thickness, or in all where there is one.
    strain : Density, optional
        (x, y, solid) → (ε11, ε22, 2 ε12) that would be without stress.
    """

    volume: Sequence[Density] = ()
    spread: Sequence[tuple[Callable[[Array, Array], NDArray[np.bool_]], float]] = ()
    edge: Sequence[OnEdge] = ()
    points: Sequence[tuple[Array, Array]] = ()
    strain: Callable[[Array, Array, NDArray[np.int64]], ArrayLike] | None = None


@dataclass
class GeneralSolution(Field):
    """A field; ``at(points)``, and ``flux_at(points)`` is the stress or the flux.

    Attributes
    ----------
    tensors : (solids, k, k) float array
    solid : (M,) int array
        Of each triangle.
    strain : callable, optional
        As in `Acting`.
    """

    tensors: Array = field(default_factory=lambda: np.eye(3)[None])
    solid: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    strain: Callable[[Array, Array, NDArray[np.int64]], ArrayLike] | None = None

    def flux_at(self, points: ArrayLike) -> Array:
        """Stress (n, 3) as 11, 22, 12, or flux −D ∇T (n, 2), element by element."""
        where = np.asarray(points, dtype=float)
        gradient = self.gradient_at(where)
        assert self._locator is not None
        which = self.solid[self._locator(where)[0]]
        if self.values.ndim == 1:
            return np.asarray(-np.einsum("nij,nj->ni", self.tensors[which], gradient))
        strain = np.stack(
            [gradient[:, 0, 0], gradient[:, 1, 1], gradient[:, 0, 1] + gradient[:, 1, 0]], axis=1
        )
        if self.strain is not None:
            x, y = where.T
            strain -= np.moveaxis(np.asarray(self.strain(x, y, which)), 0, -1)
        return np.asarray(np.einsum("nij,nj->ni", self.tensors[which], strain))


def solve(
    mesh: Mesh,
    tensors: ArrayLike,
    solid: NDArray[np.int64],
    held: Callable[[Array, NDArray[np.bool_]], Array],
    acting: Acting,
    thickness: Callable[[Array, Array, NDArray[np.int64]], ArrayLike] | None = None,
    order: int = 2,
) -> GeneralSolution:
    """Solve div(C ε(u)) + f = 0, or div(D ∇T) + s = 0.

    Parameters
    ----------
    mesh : Mesh
        Its outer boundary is called ``edge``.
    tensors : (solids, 3, 3) or (solids, 2, 2) array_like
        Stiffness in Pa, or conductivity in W/(m K), of each solid.
    solid : (M,) int array
        Of each triangle.
    held : callable
        Nodes (n, 2), which of them are on the edge (n,) → values (n, components), NaN where they
        are free.
    acting : Acting
    thickness : callable, optional
        (x, y, solid) → m.
    order : {1, 2}

    Raises
    ------
    ValueError
        If supports leave a part of the body a rigid motion, or a temperature that nothing sets, or
        the mesh has no point where something is spread.
    FloatingPointError
        If the equations cannot be solved to nine digits.
    """
    check_order(order)
    check_mesh(mesh)
    tensors = np.asarray(tensors, dtype=float)
    elastic = tensors.shape[-1] == 3
    triangulation, facets = to_skfem(mesh)
    element = ELEMENTS[order]()
    basis = skfem.Basis(triangulation, skfem.ElementVector(element) if elastic else element)
    x, y = np.asarray(basis.global_coordinates())
    which = np.broadcast_to(solid[:, None], x.shape)

    def thick(x: Array, y: Array, which: NDArray[np.int64]) -> Array:
        found = 1.0 if thickness is None else thickness(x, y, which)
        return np.broadcast_to(np.asarray(found, dtype=float), x.shape)

    moduli = np.moveaxis(tensors[which], (-2, -1), (0, 1)) * thick(x, y, which)
    stiffness = skfem.BilinearForm(
        lambda u, v, w: np.einsum("ij...,j...,i...->...", moduli, _strain(u), _strain(v))
    ).assemble(basis)
    load = np.zeros(basis.N)
    densities = [density(x, y) for density in acting.volume]
    for where, amount in acting.spread:
        inside = where(x, y)
        area = float((inside * basis.dx).sum())
        if not area > 0:
            raise ValueError("no point of the mesh lies where something is spread")
        densities.append(amount / area * inside[None])
    for density in densities:
        force = _shaped(density, elastic, x) * thick(x, y, which)
        load += skfem.LinearForm(lambda v, w, f=force: _dot(f, v)).assemble(basis)
    if acting.strain is not None:
        free = _shaped(acting.strain(x, y, which), True, x, 3)
        stress = np.einsum("ij...,j...->i...", moduli, free)
        load += skfem.LinearForm(
            lambda v, w: np.einsum("i...,i...->...", stress, _strain(v))
        ).assemble(basis)
    if acting.edge:
        edge = skfem.FacetBasis(triangulation, basis.elem, facets=facets["edge"])
        places = np.asarray(edge.global_coordinates())
        beside = np.broadcast_to(solid[edge.tind][:, None], places[0].shape)
        for function in acting.edge:
            traction = _shaped(function(*places, *edge.normals), elastic, places[0])
            traction = traction * thick(places[0], places[1], beside)
            load += skfem.LinearForm(lambda v, w, f=traction: _dot(f, v)).assemble(edge)
    dofs = component_dofs(basis) if elastic else np.arange(basis.N)[:, None]
    nodes = basis.doflocs[:, dofs[:, 0]].T
    owner = np.empty(basis.N, dtype=np.int64)
    owner[dofs] = np.arange(len(dofs))[:, None]
    element_nodes = owner[basis.element_dofs[:: dofs.shape[1]]]
    on_edge = np.zeros(len(nodes), dtype=bool)
    on_edge[owner[basis.get_dofs(facets["edge"]).flatten()]] = True
    wanted = held(dirichlet_points(mesh, nodes, element_nodes), on_edge)
    values = np.full(basis.N, np.nan)
    values[dofs] = wanted
    if elastic:
        require_held(nodes, element_nodes, ~np.isnan(wanted))
    else:
        require_temperature(nodes, element_nodes, ~np.isnan(wanted[:, 0]))
    found = GeneralSolution(
        mesh=mesh,
        order=order,
        nodes=nodes,
        values=np.zeros((len(nodes), 2) if elastic else len(nodes)),
        element_dofs=element_nodes,
        triangles=triangulation.t.T,
        tensors=tensors,
        solid=solid,
        strain=acting.strain,
    )
    for places, force in acting.points:
        _concentrate(found, places, force, dofs, load)
    solution, _ = solve_with_prescribed(stiffness, load, values)
    found.values = solution[dofs] if elastic else solution
    return found


def _strain(u):  # type: ignore[no-untyped-def]
    """Strain (11, 22, 2·12) of a vector field, or the gradient of a scalar one."""
    g = u.grad
    return np.stack([g[0, 0], g[1, 1], g[0, 1] + g[1, 0]]) if g.ndim == 4 else g


def _dot(force: Array, v):  # type: ignore[no-untyped-def]

    return force[0] * v if v.ndim == 2 else force[0] * v[0] + force[1] * v[1]


def _shaped(values: ArrayLike, elastic: bool, x: Array, components: int = 2) -> Array:
    count = components if elastic else 1
    found = np.asarray(values, dtype=float)
    return np.broadcast_to(
        found.reshape(count, *found.shape[found.ndim - x.ndim :]), (count, *x.shape)
    )


def _concentrate(
    field: GeneralSolution, places: Array, force: Array, dofs: NDArray[np.int64], load: Array
) -> None:
    """Add what acts at points, by the shape functions there."""
    field.at(places[:1])  # makes the locator
    assert field._locator is not None
    cells, local = field._locator(places)
    element = ELEMENTS[field.order]()
    for i, nodes in enumerate(field.element_dofs):
        share = np.reshape(element.lbasis(local.T, i)[0], (-1, 1)) * force
        np.add.at(load, dofs[nodes[cells]], share)
