"""Conduction of a strained body by scikit-fem: −div(D(ε) ∇φ) = 0 on the mesh of its mechanics."""

from collections.abc import Callable, Mapping

import numpy as np
import skfem
from numpy.typing import NDArray
from skfem.helpers import dot, grad

from references.fem.conduction import ConductionSolution
from references.fem.elasticity import ElasticSolution, component_dofs, strain
from references.fem.evaluation import ELEMENTS, to_skfem
from references.fem.listening import listened
from references.fem.restraint import require_temperature
from references.linear import solve_with_prescribed

# Exact for products of quadratic gradients with a linear strain, and more for what is not linear.
_QUADRATURE = 6


@listened
def strained_conduction(
    elastic: ElasticSolution,
    conductivity: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    inflow: Mapping[str, float],
) -> ConductionSolution:
    """Potential of a conductor that an elastic solution strains.

    Parameters
    ----------
    elastic : ElasticSolution
        Its mesh and order are taken.
    conductivity : callable
        Strain (3, ...) as ε11, ε22, 2 ε12 → D (2, 2, ...), S/m.
    inflow : mapping from boundary names to A/m²
        What enters through them; it must cancel. The others are insulated.

    Returns
    -------
    ConductionSolution
        Zero at the node nearest to the lower left corner. Its `conductivity` is that without
        strain.

    Raises
    ------
    ValueError
        If a boundary is unknown, currents do not cancel, or D is not positive somewhere.
    """
    mesh, order = elastic.mesh, elastic.order
    for name in inflow:
        mesh.nodes(name)
    triangulation, facets = to_skfem(mesh)
    basis = skfem.Basis(triangulation, ELEMENTS[order](), intorder=_QUADRATURE)
    motion = skfem.Basis(
        triangulation, skfem.ElementVector(ELEMENTS[order]()), intorder=_QUADRATURE
    )
    displacement = np.zeros(motion.N)
    displacement[component_dofs(motion)] = elastic.values
    tensor = conductivity(strain(motion.interpolate(displacement)))
    minor = tensor[0, 0] * tensor[1, 1] - tensor[0, 1] * tensor[1, 0]
    if not ((tensor[0, 0] > 0).all() and (minor > 0).all()):
        raise ValueError("the strained conductivity is not positive definite everywhere")

    @skfem.BilinearForm
    def conduction(u, v, w):  # type: ignore[no-untyped-def]
        return dot(np.einsum("ij...,j...->i...", tensor, grad(u)), grad(v))

    @skfem.LinearForm
    def feed(v, w):  # type: ignore[no-untyped-def]
        return 1.0 * v

    load = np.zeros(basis.N)
    for name, density in inflow.items():
        edge = skfem.FacetBasis(triangulation, ELEMENTS[order](), facets=facets[name])
        load += density * feed.assemble(edge)
    if abs(load.sum()) > 1e-9 * np.abs(load).sum():
        raise ValueError("the currents that enter do not cancel")
    nodes = basis.doflocs.T
    values = np.full(basis.N, np.nan)
    values[np.argmin(nodes.sum(axis=1))] = 0.0
    require_temperature(nodes, basis.element_dofs, ~np.isnan(values))
    solution, unknowns = solve_with_prescribed(conduction.assemble(basis), load, values)
    return ConductionSolution(
        mesh=mesh,
        order=order,
        nodes=nodes,
        values=solution,
        element_dofs=basis.element_dofs,
        triangles=triangulation.t.T,
        conductivity=conductivity(np.zeros(3)),
        unknowns=unknowns,
    )
