"""Transient anisotropic heat conduction: c ∂T/∂t = div(D ∇T) + source."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import skfem
from numpy.typing import ArrayLike, NDArray
from skfem.helpers import dot, grad

from references.analytic.conduction import checked_conductivity
from references.fem.evaluation import (
    ELEMENTS,
    Field,
    as_points,
    check_order,
    dirichlet_points,
    to_skfem,
)
from references.fem.listening import listened
from references.fem.mesh import Mesh
from references.linear import factorise

InTime = Callable[[NDArray[np.float64], NDArray[np.float64], float], ArrayLike]


@dataclass
class TransientSolution:
    """Temperatures at chosen times.

    Attributes
    ----------
    times : (k,) float array
    fields : list of Field
        One for each time.
    unknowns, steps : int
    seconds : dict
        ``assembly`` and ``solve``.
    """

    times: NDArray[np.float64]
    fields: list[Field]
    unknowns: int
    steps: int
    seconds: dict[str, float] = field(default_factory=dict)

    def at(self, points: ArrayLike) -> NDArray[np.float64]:
        """Temperatures (k, n) at points (n, 2)."""
        where = as_points(points)
        return np.stack([f.at(where) for f in self.fields])


@listened
def transient_conduction(
    mesh: Mesh,
    conductivity: ArrayLike,
    capacity: float,
    initial: Callable[[NDArray[np.float64], NDArray[np.float64]], ArrayLike] | float,
    duration: float,
    steps: int,
    boundary_temperature: InTime | float | None = None,
    source: InTime | None = None,
    outputs: int = 1,
    order: int = 2,
) -> TransientSolution:
    """March c ∂T/∂t = div(D ∇T) + s from t = 0.

    Crank and Nicolson's rule, of second order; the first step is made of two implicit Euler steps
    of half the length (Rannacher's start), which damp what an initial field that does not fit its
    boundary would otherwise set ringing. Both need the same matrix, so one factorisation serves.

    Parameters
    ----------
    mesh : Mesh
    conductivity : (2, 2) array_like
        W/(m K).
    capacity : float
        c = density times specific heat, J/(m³ K).
    initial : callable ``f(x, y)`` or number
        K.
    duration : float
        s.
    steps : int
        Equal ones.
    boundary_temperature : callable ``f(x, y, t)`` or number, optional
        K, on the whole outer edge; insulated if None.
    source : callable ``f(x, y, t)``, optional
        W/m³.
    outputs : int
        Number of equally spaced times at which the field is kept; divides ``steps``.
    order : {1, 2}

    Returns
    -------
    TransientSolution

    Raises
    ------
    ValueError
        For bad material data, or times and steps that make no sense.
    """
    check_order(order)
    tensor = checked_conductivity(conductivity)
    if not np.isfinite(capacity) or capacity <= 0:
        raise ValueError(f"the heat capacity must be positive, not {capacity}")
    if not duration > 0 or steps < 1 or outputs < 1 or steps % outputs:
        raise ValueError("duration and steps must be positive and outputs divide the steps")
    start = time.perf_counter()
    triangulation, facets = to_skfem(mesh)
    basis = skfem.Basis(triangulation, ELEMENTS[order]())

    @skfem.BilinearForm
    def conduction(u, v, w):  # type: ignore[no-untyped-def]
        return dot(np.einsum("ij,j...->i...", tensor, grad(u)), grad(v))

    @skfem.BilinearForm
    def storage(u, v, w):  # type: ignore[no-untyped-def]
        return capacity * u * v

    def heat(t: float) -> NDArray[np.float64]:
        if source is None:
            return np.zeros(basis.N)

        @skfem.LinearForm
        def heating(v, w):  # type: ignore[no-untyped-def]
            return source(w.x[0], w.x[1], t) * v

        found: NDArray[np.float64] = heating.assemble(basis)
        return found

    k, m = conduction.assemble(basis).tocsr(), storage.assemble(basis).tocsr()
    held = np.zeros(basis.N, dtype=bool)
    if boundary_temperature is not None:
        for name in mesh.outer:
            held[basis.get_dofs(facets[name]).flatten()] = True
    free = ~held
    x, y = dirichlet_points(mesh, basis.doflocs.T, basis.element_dofs).T

    def edge(t: float) -> NDArray[np.float64] | float:
        if callable(boundary_temperature):
            return np.asarray(boundary_temperature(x[held], y[held], t), dtype=float)
        return 0.0 if boundary_temperature is None else float(boundary_temperature)

    given = initial(x, y) if callable(initial) else initial
    temperature = np.array(np.broadcast_to(np.asarray(given, dtype=float), x.shape))
    step = duration / steps
    system = (m / step + k / 2).tocsr()
    assembled = time.perf_counter()
    factors = factorise(system[free][:, free])

    def advance(right: NDArray[np.float64], t: float) -> NDArray[np.float64]:
        """Solve (M/Δt + K/2) T = right with the edge's values at time t."""
        new = np.zeros(basis.N)
        new[held] = edge(t)
        new[free] = factors.solve((right - system @ new)[free])
        return new

    fields, times = [], []
    heat_now = heat(0.0)
    for i in range(steps):
        t = (i + 1) * step
        heat_next = heat(t)
        if i == 0:
            for half in (step / 2, step):
                # implicit Euler over Δt/2 has twice the same matrix
                right = m @ temperature / step + heat(half) / 2
                temperature = advance(right, half)
        else:
            right = m @ temperature / step - k @ temperature / 2 + (heat_now + heat_next) / 2
            temperature = advance(right, t)
        heat_now = heat_next
        if (i + 1) % (steps // outputs) == 0:
            times.append(t)
            fields.append(
                Field(
                    mesh,
                    order,
                    basis.doflocs.T,
                    temperature.copy(),
                    basis.element_dofs,
                    triangulation.t.T,
                )
            )
    end = time.perf_counter()
    if not all(np.isfinite(f.values).all() for f in fields):
        raise FloatingPointError("the temperatures are not finite")
    seconds = {"assembly": assembled - start, "solve": end - assembled}
    return TransientSolution(np.array(times), fields, int(free.sum()), steps, seconds)
