"""Motion of an elastic body of several solids in time."""

from collections.abc import Callable, Sequence

import numpy as np
from scipy.sparse import csr_matrix

from references.fem.body import Array, Body
from references.fem.evaluation import Field
from references.linear import factorise

#: Share of a step over which the velocity of what is prescribed is taken.
_NEAR = 1e-3


def moved(
    body: Body,
    stiffness: csr_matrix,
    mass: csr_matrix,
    damping: tuple[float, float],
    start: tuple[Array, Array],
    held: Callable[[float], Array],
    load: Callable[[float], Array],
    times: Sequence[float],
    step: float,
    begin: float = 0.0,
) -> list[tuple[Field, Field]]:
    """March M ü + (α M + β K) u̇ + K u = f by the average acceleration (Newmark's β = 1/4).

    With u̇ and ü of a step Δt constant at their means, the unknown is u in its middle:

        (K + 2/Δt C + 4/Δt² M) u½ = f½ + M (4/Δt² u₀ + 2/Δt u̇₀) + 2/Δt C u₀,

    then u₁ = 2 u½ − u₀ and u̇₁ = 4/Δt (u½ − u₀) − u̇₀: of second order, stable for any step, and
    without damping of its own. Phases err by (ω Δt)²/12. What is prescribed acts by its value, its
    velocity and its acceleration.

    Parameters
    ----------
    body : Body
        Of two components.
    stiffness, mass : sparse
        K and M.
    damping : pair of float
        α (1/s) and β (s).
    start : pair of (N,) arrays
        u and u̇; what is held has its support's from the start on.
    held, load : callable
        Time → (N,) values, NaN where free: the same nodes at all times; and right-hand side.
    times : sequence of float
        Ascending, the first one not before `begin`; by cubic interpolation within steps.
    step : float
        The longest one; the last ends at the last of the times.
    begin : float

    Returns
    -------
    list of (Field, Field)
        Displacement and velocity at the times.
    """
    alpha, beta = damping
    span = float(times[-1]) - begin
    count = max(1, int(np.ceil(span / step * (1 - 1e-9))))
    h = span / count
    given = held(begin)
    free = np.isnan(given)

    def rate(time: float) -> Array:
        near = _NEAR * h
        if time - near > begin:
            return np.asarray((held(time + near) - held(time - near)) / (2 * near))
        # Nothing is known of before the start.
        now, soon, later = (held(time + k * near) for k in range(3))
        return np.asarray((4 * soon - 3 * now - later) / (2 * near))

    damped = alpha * mass + beta * stiffness
    factors = factorise((stiffness + 2 / h * damped + 4 / h**2 * mass)[free][:, free])
    speed = rate(begin)
    u, v = np.where(free, start[0], given), np.where(free, start[1], speed)
    found: list[tuple[Field, Field]] = []

    def keep(until: float, last: tuple[Array, Array]) -> None:
        while len(found) < len(times) and times[len(found)] <= until + 1e-9 * h:
            s = min(1.0, 1.0 - (until - times[len(found)]) / h)
            found.append(tuple(map(body.field, _between(*last, u, v, s, h))))  # type: ignore[arg-type]

    keep(begin, (u, v))
    for number in range(1, count + 1):
        time = begin + number * h
        ahead, faster = held(time), rate(time)
        # Of what is held: displacement, velocity and acceleration in the middle of the step.
        middle = np.where(free, 0.0, 0.5 * (given + ahead))
        inert = np.where(free, 4 / h**2 * u + 2 / h * v, (speed - faster) / h)
        viscous = np.where(free, 2 / h * u, (given - ahead) / h)
        right = load(time - 0.5 * h) + mass @ inert + damped @ viscous - stiffness @ middle
        middle[free] = factors.solve(right[free])
        last = u, v
        v = np.where(free, 4 / h * (middle - u) - v, faster)
        u = np.where(free, 2 * middle - u, ahead)
        given, speed = ahead, faster
        keep(time, last)
    if not (np.isfinite(u).all() and np.isfinite(v).all()):
        raise FloatingPointError("the motion is not finite")
    return found


def _between(u0: Array, v0: Array, u1: Array, v1: Array, s: float, h: float) -> tuple[Array, Array]:
    """Displacement and velocity at a share s of a step, by Hermite's cubic."""
    if s >= 1.0 - 1e-9:
        return u1, v1
    rise = u1 - u0
    u = u0 + s * h * v0 + s**2 * (3 * rise - h * (2 * v0 + v1)) + s**3 * (h * (v0 + v1) - 2 * rise)
    v = v0 + 2 * s * (3 * rise / h - 2 * v0 - v1) + 3 * s**2 * (v0 + v1 - 2 * rise / h)
    return u, v
