"""Heat, and motion with heat, of a body of several solids in time."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import bmat, csr_matrix

from references.fem.body import Array, Body, InSolid
from references.fem.evaluation import Field
from references.linear import factorise

# Alexander's two-stage method (SIAM J. Numer. Anal. 14, 1977): second order, L-stable.
_A = 1.0 - np.sqrt(0.5)


def warmed(
    body: Body,
    moduli: InSolid,
    capacities: ArrayLike,
    initial: Array,
    held: Callable[[float], Array],
    load: Callable[[float], Array],
    times: Sequence[float],
    start: float = 0.0,
    steps: int = 8,
) -> list[Field]:
    """March c ∂T/∂t = div(D ∇T) + s.

    The first steps are short, for what starts rough: the way to the first of the times is halved
    seven times, and each of the pieces has so many steps.

    Parameters
    ----------
    body : Body
        Of one component.
    moduli : callable
        W/(m K).
    capacities : (solids,) array_like
        J/(m³ K).
    initial : (N,) array
        K; what is held has its support's value from the start on.
    held : callable
        Time → (N,) values, NaN where free: the same nodes at all times.
    load : callable
        Time → (N,) right-hand side.
    times : sequence of float
        Ascending, the first one not before `start`.
    start : float
    steps : int
        In every piece of the first interval, and at least in every other interval.

    Returns
    -------
    list of Field
        Temperatures at the times.
    """
    stiffness, mass = body.stiffness(moduli).tocsr(), body.mass(capacities).tocsr()
    given = held(start)
    free = np.isnan(given)
    now, values, fields = start, np.where(free, initial, given), []
    known: dict[float, object] = {}

    def advance(h: float) -> None:
        nonlocal values, now
        # Steps that differ by rounding share their factors.
        key = float(f"{h:.9e}")
        if key not in known:
            known.clear()
            known[key] = factorise((mass + _A * key * stiffness)[free][:, free])
        factors, rows, begin = known[key], np.zeros_like(values), values
        for c, before in ((_A, 0.0), (1.0, 1.0 - _A)):
            time = now + c * h
            guess = np.where(free, begin, held(time))
            right = mass @ (begin - guess) + h * before * rows
            right += _A * h * (load(time) - stiffness @ guess)
            change = np.zeros_like(values)
            change[free] = factors.solve(right[free])  # type: ignore[attr-defined]
            values = guess + change
            # What flows in, by the stage's own equation and not from K T.
            rows = (mass @ (values - begin) - h * before * rows) / (_A * h)
        now += h

    for number, time in enumerate(times):
        length = time - now
        if length > 0:
            pieces = [2.0**-7] + [2.0**-k for k in range(7, 0, -1)] if number == 0 else [1.0]
            count = steps if number == 0 else max(steps, int(np.ceil(
                8 * steps * length / (times[-1] - start))))  # fmt: skip
            for share in pieces:
                for _ in range(count):
                    advance(share * length / count)
            now = time
        fields.append(body.field(values))
    if not all(np.isfinite(field.values).all() for field in fields):
        raise FloatingPointError("the temperatures are not finite")
    return fields


@dataclass(frozen=True)
class Start:
    """What a motion starts from, as unknowns of its bodies.

    Attributes
    ----------
    displacement, velocity : (N,) arrays
    temperature : (N_T,) array
        Change from the reference.
    """

    displacement: Array
    velocity: Array
    temperature: Array


def moved_and_warmed(
    body: Body,
    heat: Body,
    stiffness: csr_matrix,
    mass: csr_matrix,
    conduction: csr_matrix,
    capacity: csr_matrix,
    coupling: csr_matrix,
    held: tuple[Array, Array],
    load: tuple[Array, Array],
    reference: float,
    start: Start,
    step: float,
    steps: int,
) -> tuple[Field, Field]:
    """March M ü + K u = f + G ϑ, C ϑ̇ + K_T ϑ = q − T₀ Gᵀ u̇ by the midpoint rule.

    Parameters
    ----------
    body, heat : Body
        On one mesh, of two components and of one.
    stiffness, mass, conduction, capacity, coupling : sparse
        K, M, K_T, C and G.
    held : pair of arrays
        Displacements (N,) and temperatures (N_T,) that do not change; NaN where free.
    load : pair of arrays
        f and q.
    reference : float
        T₀, K.
    start : Start
    step : float
    steps : int

    Returns
    -------
    pair of Field
        Displacement and change of temperature at the end.
    """
    free, warm = (np.isnan(values) for values in held)
    u = np.where(free, start.displacement, held[0])
    t = np.where(warm, start.temperature, held[1])
    v = np.where(free, start.velocity, 0.0)
    upper = stiffness + 4.0 / step**2 * mass
    lower = (capacity + 0.5 * step * conduction) / reference
    # Positive above, negative below: every order of elimination has its pivots.
    factors = factorise(
        bmat(
            [
                [upper[free][:, free], -coupling[free][:, warm]],
                [-coupling[free][:, warm].T, -lower[warm][:, warm]],
            ],
            format="csr",
        )
    )
    count = int(free.sum())
    for _ in range(steps):
        right = load[0] + mass @ (4.0 / step**2 * u + 2.0 / step * v)
        middle, mean = np.where(free, 0.0, u), np.where(warm, 0.0, t)
        right += coupling @ mean - upper @ middle
        flow = -(capacity @ t + 0.5 * step * load[1]) / reference - coupling.T @ u
        flow += lower @ mean + coupling.T @ middle
        found = factors.solve(np.concatenate([right[free], flow[warm]]))
        middle[free], mean[warm] = found[:count], found[count:]
        v = np.where(free, 4.0 * (middle - u) / step - v, 0.0)
        u, t = 2.0 * middle - u, 2.0 * mean - t
    if not (np.isfinite(u).all() and np.isfinite(t).all()):
        raise FloatingPointError("the motion is not finite")
    return body.field(u), heat.field(t)
