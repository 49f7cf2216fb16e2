"""Plane anisotropic elasticity by scikit-fem on triangles."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
import skfem
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_matrix

from references.analytic.voigt import checked_voigt
from references.fem.evaluation import (
    ELEMENTS,
    Field,
    check_mesh,
    check_order,
    dirichlet_points,
    to_skfem,
)
from references.fem.listening import listened
from references.fem.mesh import Mesh
from references.fem.restraint import require_held, rigid_motions
from references.linear import solve_with_prescribed

Vector = Callable[[NDArray[np.float64], NDArray[np.float64]], ArrayLike] | ArrayLike


def strain(u):  # type: ignore[no-untyped-def]
    """Voigt strain (11, 22, 2·12) of a scikit-fem vector field."""
    g = u.grad
    return np.stack([g[0, 0], g[1, 1], g[0, 1] + g[1, 0]])


def evaluate_vector(
    function: Vector, x: NDArray[np.float64], y: NDArray[np.float64]
) -> NDArray[np.float64]:
    """A pair of numbers or a function of (x, y), as (..., 2)."""
    value = np.asarray(function(x, y) if callable(function) else function, dtype=float)
    if value.shape[-1:] != (2,):
        raise ValueError("a displacement, traction or force needs two components: shape (..., 2)")
    return np.broadcast_to(value, (*x.shape, 2))


@dataclass
class ElasticSolution(Field):
    """Displacements; ``at(points)`` (n, 2) and ``stress_at(points)`` (n, 3).

    Attributes
    ----------
    voigt : (3, 3) float array
    unknowns : int
        Free degrees of freedom.
    seconds : dict
        ``assembly`` and ``solve``.
    strain_energy : float
        ½ uᵀ K u, J per unit depth.
    """

    voigt: NDArray[np.float64] = field(default_factory=lambda: np.eye(3))
    unknowns: int = 0
    seconds: dict[str, float] = field(default_factory=dict)
    strain_energy: float = 0.0

    def strain_at(self, points: ArrayLike) -> NDArray[np.float64]:
        """Strain (n, 3) as 11, 22, 2·12, element by element."""
        g = self.gradient_at(points)
        return np.stack([g[:, 0, 0], g[:, 1, 1], g[:, 0, 1] + g[:, 1, 0]], axis=1)

    def stress_at(self, points: ArrayLike) -> NDArray[np.float64]:
        """Stress (n, 3) as 11, 22, 12, element by element."""
        stress: NDArray[np.float64] = self.strain_at(points) @ self.voigt.T
        return stress


def elastic_forms(
    mesh: Mesh, voigt: NDArray[np.float64], order: int
) -> tuple[skfem.Basis, dict[str, NDArray[np.int64]], csr_matrix]:
    """Basis, facets by boundary, and stiffness matrix ∫ ε(u) : C : ε(v)."""
    triangulation, facets = to_skfem(mesh)
    basis = skfem.Basis(triangulation, skfem.ElementVector(ELEMENTS[order]()))

    @skfem.BilinearForm
    def elastic(u, v, w):  # type: ignore[no-untyped-def]
        return np.einsum("ij,j...,i...->...", voigt, strain(u), strain(v))

    return basis, facets, elastic.assemble(basis)


def component_dofs(basis: skfem.Basis) -> NDArray[np.int64]:
    """Unknowns (nodes, 2) of a vector basis: vertices first, then mid-sides."""
    rows = [basis.nodal_dofs.T]
    if basis.facet_dofs.size:
        rows.append(basis.facet_dofs.T)
    return np.vstack(rows)


@listened
def solve_elasticity(
    mesh: Mesh,
    voigt: ArrayLike,
    displacement: Vector | Mapping[str, Vector] | None = None,
    tractions: Mapping[str, Vector] | None = None,
    body_force: Vector | None = None,
    order: int = 2,
) -> ElasticSolution:
    """Solve div σ + f = 0, σ = C ε(u).

    Parameters
    ----------
    mesh : Mesh
    voigt : (3, 3) array_like
        C in the order 11, 22, 12 with engineering shear; Pa (plane stress or strain is in it).
    displacement : callable, pair or mapping of names to such
        ``f(x, y)`` -> (..., 2) in m; a component that is NaN stays free. One that names no
        boundary holds on the whole outer edge.
    tractions : mapping of boundary names
        ``f(x, y)`` -> (..., 2) or a pair, Pa. Boundaries without data are free of traction.
    body_force : callable or pair, optional
        N/m³.
    order : {1, 2}

    Returns
    -------
    ElasticSolution

    Raises
    ------
    ValueError
        For a stiffness that is not positive definite, an unknown boundary, supports that leave a
        part of the body a rigid motion (the message names it), or loads out of balance on a body
        without supports. (Where they balance to 0.1 %, what is left is spread over all nodes, and
        three components are pinned to take the rigid motion out.)
    FloatingPointError
        If the equations cannot be solved to nine digits.
    """
    check_order(order)
    check_mesh(mesh)
    stiffness_tensor = checked_voigt(voigt)
    if displacement is None:
        prescribed: dict[str, Vector] = {}
    elif isinstance(displacement, Mapping):
        prescribed = dict(displacement)
    else:
        prescribed = dict.fromkeys(mesh.outer, displacement)
    for name in (*prescribed, *(tractions or {})):
        mesh.nodes(name)

    start = time.perf_counter()
    basis, facets, stiffness = elastic_forms(mesh, stiffness_tensor, order)
    dofs = component_dofs(basis)
    nodes = basis.doflocs[:, dofs[:, 0]].T
    load = np.zeros(basis.N)
    for name, traction in (tractions or {}).items():
        load += _traction_load(basis, facets[name], traction)
    if body_force is not None:
        load += _body_load(basis, body_force)
    owner = np.empty(basis.N, dtype=np.int64)
    owner[dofs] = np.arange(len(dofs))[:, None]
    element_nodes = owner[basis.element_dofs[::2]]
    where = dirichlet_points(mesh, nodes, element_nodes)
    values = np.full(basis.N, np.nan)
    for name, given in prescribed.items():
        held = np.unique(owner[basis.get_dofs(facets[name]).flatten()])
        wanted = evaluate_vector(given, *where[held].T)
        values[dofs[held]] = np.where(np.isnan(wanted), values[dofs[held]], wanted)
    if not prescribed:
        rigid_motions(nodes, element_nodes, ~np.isnan(values[dofs]))
        _pin(values, dofs, nodes, load)
    require_held(nodes, element_nodes, ~np.isnan(values[dofs]))
    assembled = time.perf_counter()
    solution, unknowns = solve_with_prescribed(stiffness, load, values)
    end = time.perf_counter()
    return ElasticSolution(
        mesh=mesh,
        order=order,
        nodes=nodes,
        values=solution[dofs],
        element_dofs=element_nodes,
        triangles=basis.mesh.t.T,
        voigt=stiffness_tensor,
        unknowns=unknowns,
        seconds={"assembly": assembled - start, "solve": end - assembled},
        strain_energy=float(0.5 * solution @ (stiffness @ solution)),
    )


def _traction_load(
    basis: skfem.Basis, facets: NDArray[np.int64], traction: Vector
) -> NDArray[np.float64]:
    edge = skfem.FacetBasis(basis.mesh, basis.elem, facets=facets)

    @skfem.LinearForm
    def work(v, w):  # type: ignore[no-untyped-def]
        t = evaluate_vector(traction, w.x[0], w.x[1])
        return t[..., 0] * v[0] + t[..., 1] * v[1]

    found: NDArray[np.float64] = work.assemble(edge)
    return found


def _body_load(basis: skfem.Basis, force: Vector) -> NDArray[np.float64]:
    @skfem.LinearForm
    def work(v, w):  # type: ignore[no-untyped-def]
        f = evaluate_vector(force, w.x[0], w.x[1])
        return f[..., 0] * v[0] + f[..., 1] * v[1]

    found: NDArray[np.float64] = work.assemble(basis)
    return found


def _pin(
    values: NDArray[np.float64],
    dofs: NDArray[np.int64],
    nodes: NDArray[np.float64],
    load: NDArray[np.float64],
) -> None:
    """Hold three components of a free body whose loads balance."""
    arm = nodes - nodes.mean(axis=0)
    extent = np.abs(arm).max()
    rigid = np.zeros((len(nodes), 2, 3))
    rigid[:, 0, 0] = rigid[:, 1, 1] = 1
    rigid[:, 0, 2], rigid[:, 1, 2] = -arm[:, 1] / extent, arm[:, 0] / extent
    flat = rigid.reshape(-1, 3)
    resultant = flat.T @ load[dofs].ravel()
    if np.abs(resultant).max() > 1e-3 * np.abs(load).sum():
        raise ValueError("nothing holds the body and its loads are not in equilibrium")
    # what is left comes from chords in place of curves: spread it over all nodes
    load[dofs] -= (flat @ np.linalg.solve(flat.T @ flat, resultant)).reshape(-1, 2)
    left, far, across = pins(nodes)
    values[dofs[left]] = 0.0
    values[dofs[far, across]] = 0.0


def pins(nodes: NDArray[np.float64]) -> tuple[int, int, int]:
    """A node to hold, another one, and its component to hold: a free body's rigid motion."""
    left = int(np.argmin(nodes[:, 0]))
    far = int(np.argmax(np.hypot(*(nodes - nodes[left]).T)))
    across = 0 if abs(nodes[far, 1] - nodes[left, 1]) > abs(nodes[far, 0] - nodes[left, 0]) else 1
    return left, far, across
