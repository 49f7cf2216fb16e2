"""A body of several solids as finite elements: the matrices and loads that all analyses share."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import skfem
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_matrix

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

Array = NDArray[np.float64]
Solid = NDArray[np.int64]
#: (x, y) → (components, *x.shape).
Density = Callable[[Array, Array], ArrayLike]
#: (x, y, solid) → values of x's shape behind those of their own.
InSolid = Callable[[Array, Array, Solid], ArrayLike]
#: (x, y, n1, n2) → (components, *x.shape).
OnEdge = Callable[[Array, Array, Array, Array], ArrayLike]
#: Nodes (n, 2), which of them are on the edge (n,) → values (n, components), NaN where free.
Held = Callable[[Array, NDArray[np.bool_]], Array]


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
    strain : InSolid, optional
        (ε11, ε22, 2 ε12) that would be without stress.
    """

    volume: Sequence[Density] = ()
    spread: Sequence[tuple[Callable[[Array, Array], NDArray[np.bool_]], float]] = ()
    edge: Sequence[OnEdge] = ()
    points: Sequence[tuple[Array, Array]] = ()
    strain: InSolid | None = None


class Body:
    """Triangles of one order, for an unknown of one component or two.

    Parameters
    ----------
    mesh : Mesh
        Its outer boundary is called ``edge``.
    components : {1, 2}
    solid : (M,) int array
        Of each triangle.
    thickness : InSolid, optional
        m.
    order : {1, 2}

    Attributes
    ----------
    nodes : (n, 2) float array
    dofs : (n, components) int array
        Unknowns of each node.
    element_nodes : (3 or 6, M) int array
    """

    def __init__(
        self,
        mesh: Mesh,
        components: int,
        solid: Solid,
        thickness: InSolid | None = None,
        order: int = 2,
    ) -> None:
        check_order(order)
        check_mesh(mesh)
        self.mesh, self.solid, self.order, self.components = mesh, solid, order, components
        self._thickness = thickness
        self.triangulation, self._facets = to_skfem(mesh)
        element = ELEMENTS[order]()
        self.basis = skfem.Basis(
            self.triangulation, skfem.ElementVector(element) if components == 2 else element
        )
        self.x, self.y = np.asarray(self.basis.global_coordinates())
        self.which = np.broadcast_to(solid[:, None], self.x.shape)
        self.thick = self._thick(self.x, self.y, self.which)
        size = self.basis.N
        self.dofs = component_dofs(self.basis) if components == 2 else np.arange(size)[:, None]
        self.nodes = self.basis.doflocs[:, self.dofs[:, 0]].T
        owner = np.empty(size, dtype=np.int64)
        owner[self.dofs] = np.arange(len(self.dofs))[:, None]
        self.element_nodes = owner[self.basis.element_dofs[::components]]
        self.on_edge = np.zeros(len(self.nodes), dtype=bool)
        self.on_edge[owner[self.basis.get_dofs(self._facets["edge"]).flatten()]] = True

    def _thick(self, x: Array, y: Array, which: Solid) -> Array:
        found = 1.0 if self._thickness is None else self._thickness(x, y, which)
        return np.broadcast_to(np.asarray(found, dtype=float), x.shape)

    def tensor(self, moduli: InSolid) -> Array:
        """Moduli where they are integrated, (k, k, *x.shape), without thickness."""
        return np.asarray(moduli(self.x, self.y, self.which), dtype=float)

    def stiffness(self, moduli: InSolid) -> csr_matrix:
        """∫ g(u)·C·g(v), g the strain (11, 22, 2·12), or the gradient."""
        tensor = self.tensor(moduli) * self.thick
        return skfem.BilinearForm(
            lambda u, v, w: np.einsum("ij...,j...,i...->...", tensor, _gradient(u), _gradient(v))
        ).assemble(self.basis)

    def mass(self, densities: ArrayLike) -> csr_matrix:
        """∫ ρ u·v, ρ of each solid: a density, or a heat capacity."""
        density = np.asarray(densities, dtype=float)[self.which] * self.thick
        return skfem.BilinearForm(lambda u, v, w: density * _product(u, v)).assemble(self.basis)

    def coupling(self, heat: "Body", stress: InSolid) -> csr_matrix:
        """∫ ε(v)·β ϑ, (unknowns, unknowns of `heat`), β the stress (3, ...) that a kelvin holds."""
        held = np.asarray(stress(self.x, self.y, self.which), dtype=float) * self.thick
        basis = heat.basis.with_element(ELEMENTS[heat.order]())
        return skfem.BilinearForm(
            lambda u, v, w: np.einsum("i...,i...->...", held, _gradient(v)) * u
        ).assemble(basis, self.basis)

    def load(self, acting: Acting, moduli: InSolid | None = None) -> Array:
        """Right-hand side, of everything that acts.

        Raises
        ------
        ValueError
            If the mesh has no point where something is spread.
        """
        load = np.zeros(self.basis.N)
        densities = [density(self.x, self.y) for density in acting.volume]
        for where, amount in acting.spread:
            inside = where(self.x, self.y)
            area = float((inside * self.basis.dx).sum())
            if not area > 0:
                raise ValueError("no point of the mesh lies where something is spread")
            densities.append(amount / area * inside[None])
        if densities:
            force = sum(self._shaped(density, self.x) for density in densities) * self.thick
            load += skfem.LinearForm(lambda v, w: _dot(force, v)).assemble(self.basis)
        if acting.strain is not None:
            assert moduli is not None
            free = np.asarray(acting.strain(self.x, self.y, self.which), dtype=float)
            stress = np.einsum("ij...,j...->i...", self.tensor(moduli), free) * self.thick
            load += skfem.LinearForm(
                lambda v, w: np.einsum("i...,i...->...", stress, _gradient(v))
            ).assemble(self.basis)
        if acting.edge:
            load += self._edge_load(acting.edge)
        if acting.points:
            self._concentrate(acting.points, load)
        return load

    def _edge_load(self, functions: Sequence[OnEdge]) -> Array:
        edge = skfem.FacetBasis(self.triangulation, self.basis.elem, facets=self._facets["edge"])
        x, y = np.asarray(edge.global_coordinates())
        thick = self._thick(x, y, np.broadcast_to(self.solid[edge.tind][:, None], x.shape))
        traction = sum(self._shaped(function(x, y, *edge.normals), x) for function in functions)
        force = traction * thick
        found: Array = skfem.LinearForm(lambda v, w: _dot(force, v)).assemble(edge)
        return found

    def _concentrate(self, points: Sequence[tuple[Array, Array]], load: Array) -> None:
        """Add what acts at points, by the shape functions there."""
        field = self.field(np.zeros(self.basis.N))
        element = ELEMENTS[self.order]()
        for places, force in points:
            field.at(places[:1])  # makes the locator
            assert field._locator is not None
            cells, local = field._locator(places)
            for i, nodes in enumerate(self.element_nodes):
                share = np.reshape(element.lbasis(local.T, i)[0], (-1, 1)) * force
                np.add.at(load, self.dofs[nodes[cells]], share)

    def _shaped(self, values: ArrayLike, x: Array) -> Array:
        found = np.asarray(values, dtype=float)
        return np.broadcast_to(
            found.reshape(self.components, *found.shape[found.ndim - x.ndim :]),
            (self.components, *x.shape),
        )

    def held(self, held: Held) -> Array:
        """What is prescribed of every unknown, (N,); NaN where it is free."""
        places = dirichlet_points(self.mesh, self.nodes, self.element_nodes)
        values = np.full(self.basis.N, np.nan)
        values[self.dofs] = held(places, self.on_edge)
        return values

    def nodal(self, values: Density) -> Array:
        """A field's values at the nodes as unknowns, (N,)."""
        found = np.zeros(self.basis.N)
        given = np.asarray(values(*self.nodes.T), dtype=float)
        found[self.dofs] = np.broadcast_to(given, (self.components, len(self.nodes))).T
        return found

    def field(self, unknowns: Array) -> Field:
        """Unknowns (N,), or (N, several), as a function of the place: (…, several · components)."""
        values = np.moveaxis(unknowns[self.dofs], 1, -1)
        if self.components == 1 and unknowns.ndim == 1:
            values = values[:, 0]
        return Field(
            self.mesh,
            self.order,
            self.nodes,
            values.reshape(len(self.nodes), -1) if values.ndim > 2 else values,
            self.element_nodes,
            self.triangulation.t.T,
        )


def of_solids(tensors: ArrayLike) -> InSolid:
    """Moduli (solids, k, k) as a function that gives (k, k, *x.shape)."""
    table = np.asarray(tensors, dtype=float)
    return lambda x, y, which: np.moveaxis(table[which], (-2, -1), (0, 1))


def _gradient(u):  # type: ignore[no-untyped-def]
    """Strain (11, 22, 2·12) of a vector field, or the gradient of a scalar one."""
    g = u.grad
    return np.stack([g[0, 0], g[1, 1], g[0, 1] + g[1, 0]]) if g.ndim == 4 else g


def _product(u, v):  # type: ignore[no-untyped-def]
    return u * v if u.ndim == 2 else u[0] * v[0] + u[1] * v[1]


def _dot(force: Array, v):  # type: ignore[no-untyped-def]
    return force[0] * v if v.ndim == 2 else force[0] * v[0] + force[1] * v[1]
