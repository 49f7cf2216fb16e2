"""Anisotropic heat conduction by scikit-fem: −div(D ∇T) = source."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
import skfem
from numpy.typing import ArrayLike, NDArray
from skfem.helpers import dot, grad

from references.analytic.conduction import checked_conductivity
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
from references.fem.restraint import require_temperature
from references.linear import solve_with_prescribed

Scalar = Callable[[NDArray[np.float64], NDArray[np.float64]], ArrayLike] | float


def evaluate(function: Scalar, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray:
    """A number or a function of (x, y), as an array of x's shape."""
    value = function(x, y) if callable(function) else function
    return np.broadcast_to(np.asarray(value, dtype=float), x.shape)


@dataclass
class ConductionSolution(Field):
    """Temperatures; ``values`` are nodal, ``at(points)`` and ``flux_at(points)`` anywhere.

    Attributes
    ----------
    unknowns : int
        Free degrees of freedom.
    seconds : dict
        ``assembly`` and ``solve``.
    """

    conductivity: NDArray[np.float64] = field(default_factory=lambda: np.eye(2))
    unknowns: int = 0
    seconds: dict[str, float] = field(default_factory=dict)

    def flux_at(self, points: ArrayLike) -> NDArray[np.float64]:
        """Heat flux −D ∇T (n, 2), element by element."""
        flux: NDArray[np.float64] = -self.gradient_at(points) @ self.conductivity.T
        return flux


@listened
def steady_conduction(
    mesh: Mesh,
    conductivity: ArrayLike,
    boundary_temperature: Scalar | Mapping[str, Scalar],
    source: Scalar = 0.0,
    order: int = 2,
) -> ConductionSolution:
    """Solve −div(D ∇T) = source with prescribed temperatures.

    Parameters
    ----------
    mesh : Mesh
    conductivity : (2, 2) array_like
        D, W/(m K); symmetric positive definite.
    boundary_temperature : number, callable or mapping
        Kelvin; ``f(x, y)`` on vectors. A single one holds on the whole outer edge, a mapping
        names boundaries; all others are insulated.
    source : number or callable
        W/m³.
    order : {1, 2}

    Returns
    -------
    ConductionSolution

    Raises
    ------
    ValueError
        For a conductivity that is not positive definite, an unknown boundary, or no prescribed
        temperature on a part of the body (it would be determined up to a constant only).

    Examples
    --------
    >>> from references.fem.mesh import disc
    >>> s = steady_conduction(disc(0.3), [[5, 2], [2, 1]], lambda x, y: x - 2 * y)
    >>> bool(abs(s.at([[0.1, 0.2]])[0] + 0.3) < 1e-12)
    True
    """
    check_order(order)
    tensor = checked_conductivity(conductivity)
    check_mesh(mesh)
    if isinstance(boundary_temperature, Mapping):
        prescribed: dict[str, Scalar] = dict(boundary_temperature)
    else:
        prescribed = dict.fromkeys(mesh.outer, boundary_temperature)
    if not prescribed:
        raise ValueError("no boundary has a temperature: the field is known up to a constant only")
    for name in prescribed:
        mesh.nodes(name)

    start = time.perf_counter()
    triangulation, facets = to_skfem(mesh)
    basis = skfem.Basis(triangulation, ELEMENTS[order]())

    @skfem.BilinearForm
    def conduction(u, v, w):  # type: ignore[no-untyped-def]
        return dot(np.einsum("ij,j...->i...", tensor, grad(u)), grad(v))

    @skfem.LinearForm
    def heating(v, w):  # type: ignore[no-untyped-def]
        return evaluate(source, w.x[0], w.x[1]) * v

    stiffness = conduction.assemble(basis)
    load = np.zeros(basis.N)
    if callable(source) or source != 0:
        load = heating.assemble(basis)
    nodes = basis.doflocs.T
    where = dirichlet_points(mesh, nodes, basis.element_dofs)
    values = np.full(basis.N, np.nan)
    for name, temperature in prescribed.items():
        dofs = basis.get_dofs(facets[name]).flatten()
        values[dofs] = evaluate(temperature, *where[dofs].T)
    require_temperature(nodes, basis.element_dofs, ~np.isnan(values))
    assembled = time.perf_counter()
    solution, unknowns = solve_with_prescribed(stiffness, load, values)
    return ConductionSolution(
        mesh=mesh,
        order=order,
        nodes=nodes,
        values=solution,
        element_dofs=basis.element_dofs,
        triangles=triangulation.t.T,
        conductivity=tensor,
        unknowns=unknowns,
        seconds={"assembly": assembled - start, "solve": time.perf_counter() - assembled},
    )
