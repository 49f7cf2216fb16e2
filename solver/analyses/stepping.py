"""Steps in time of an elastic body: velocity Verlet with or without inertia of rotations, Newmark.

A motion keeps u of the active particles at t and the velocity of half a step before, which is
what Verlet's method really carries: u(t) = u(t − Δt) + Δt v(t − Δt/2). Forces are per volume of
a particle, like the operator's rows. Damping is Rayleigh's, α M + β K: the part with M is exact
for any step, the part with K takes the velocity of half a step before, so that it costs no
product. That half step is all it errs by: K (u + β v(t − Δt/2)) is the force of a β-damped body at
t but for β K a Δt/2, of first order, and the longest stable step falls (`stable_step`).
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigsh

from ..arrays import Array, Mask
from ..errors import SceneError
from ..linear.shifted import Shifted
from ..magnitude import TIMES, outside
from ..operators import BondOperator

#: Rotational inertia of a particle, in ρ Δx²: that of its square cell.
ROTATIONAL_INERTIA = 1.0 / 6.0
# Accuracy of the largest eigenvalue, and what is added to it for being a lower bound.
_LANCZOS = 5e-3
_ABOVE = 5e-3
# Steps that no run comes to the end of.
_MOST = 1e9


class Internal(Protocol):
    """Internal forces of a body, its moving unknowns in rows of (m, active)."""

    products: int
    inner: int

    def __call__(self, u: Array) -> tuple[Array, Array | None]:
        """Forces that u exerts, and the rotations if they are not among the unknowns."""

    def remember(self, theta: Array | None) -> None:
        """Keep the rotations of a step that was taken."""


class InertRotations:
    """Rotations that move like displacements: K as it is."""

    def __init__(self, operator: BondOperator) -> None:
        self.operator = operator
        self.products = self.inner = 0

    def __call__(self, u: Array) -> tuple[Array, Array | None]:
        self.products += 1
        return self.operator.product(u, masked=True), None

    def remember(self, theta: Array | None) -> None:
        """Nothing to keep."""


def largest_frequency(internal: Internal, inverse_mass: Array) -> float:
    """√λ_max of M⁻¹ S of the body itself, rad/s, a little above rather than below.

    The bulk symbol's is no bound: near surfaces eigenvalues are several times larger.

    Parameters
    ----------
    internal : Internal
    inverse_mass : ndarray, shape (m, active)
        Zero where prescribed.
    """
    root, shape = np.sqrt(inverse_mass), inverse_mass.shape
    size = root.size

    def apply(x: Array) -> Array:
        force, _ = internal(root * x.reshape(shape))
        return np.asarray((root * force).ravel())

    start = np.cos(1.7 * np.arange(size)) * root.ravel()
    scaled = LinearOperator((size, size), matvec=apply, dtype=np.float64)
    if size <= 40:
        value = np.linalg.eigvalsh(np.stack([apply(e) for e in np.eye(size)]))[-1]
        return float(np.sqrt(value))
    (value,) = eigsh(
        scaled, k=1, which="LA", v0=start, tol=_LANCZOS, ncv=20, return_eigenvectors=False
    )
    return float(np.sqrt(value * (1.0 + _ABOVE)))


def require_end(span: float, step: float) -> None:
    """Refuse a run that would never end.

    Raises
    ------
    SceneError
    """
    if wrong := outside(step, TIMES):
        raise SceneError(f"the step is {wrong}")
    if span > _MOST * step:
        raise SceneError(
            f"a run of {span:.3g} s in steps of {step:.3g} s has {span / step:.1e} of them and "
            f"would not end: are moduli, masses, lengths and times in units that belong together?"
        )


def stable_step(frequency: float, alpha: float = 0.0, beta: float = 0.0) -> float:
    """The longest stable step of Verlet's method, s.

    From the amplification polynomial of a mode, ω² Δt² + 2 β ω² Δt ≤ 4 (what the part with M
    adds only helps).
    """
    half = 0.5 * beta * frequency
    return 2.0 / frequency * (np.sqrt(1.0 + half * half) - half)


class Verlet:
    """One step after another, explicitly.

    Parameters
    ----------
    internal : Internal
    mass : ndarray, shape (m, active)
        Zero where prescribed.
    step : float, s
    alpha, beta : float
        Rayleigh damping, 1/s and s.
    """

    def __init__(
        self, internal: Internal, mass: Array, step: float, alpha: float, beta: float
    ) -> None:
        self.internal, self.mass, self.step = internal, mass, step
        self.free: Mask = mass > 0
        self.inverse = np.divide(1.0, mass, out=np.zeros_like(mass), where=self.free)
        self.alpha, self.beta = alpha, beta
        self.decay = float(np.exp(-alpha * step))

    def force(self, u: Array, v: Array, load: Array) -> tuple[Array, Array]:
        """Internal force (of u + β v with such damping) and acceleration."""
        lagged = u + self.beta * v if self.beta else u
        internal, theta = self.internal(np.where(self.free, lagged, 0.0))
        self.internal.remember(theta)
        return internal, self.inverse * (load - internal)

    def first(self, v: Array, a: Array) -> Array:
        """Velocity half a step after the start, from the one at the start."""
        half = np.sqrt(self.decay)
        return np.asarray(half * v + 0.5 * self.step * np.sqrt(half) * a)

    def next(self, v: Array, a: Array) -> Array:
        """Velocity half a step later from that of half a step before."""
        return np.asarray(self.decay * v + np.sqrt(self.decay) * self.step * a)


class Newmark:
    """Implicit steps by the average acceleration, stable for any length.

    Where few modes matter that are much slower than the fastest: slender or stiff bodies.
    Rotations carry no inertia. With q = u' + β v' one system (K + σ M) q = … serves.

    Parameters
    ----------
    operator : BondOperator
    kind : str
    mass : ndarray, shape (components, active)
    step : float, s
    alpha, beta : float
    tolerance : float
        Relative residual of a step.
    """

    def __init__(
        self,
        operator: BondOperator,
        kind: str,
        mass: Array,
        step: float,
        alpha: float,
        beta: float,
        tolerance: float,
    ) -> None:
        self.step, self.alpha, self.beta, self.tolerance = step, alpha, beta, tolerance
        self.mass, self.solver = mass, Shifted(operator, kind, mass)
        self.gain = 1.0 + 2.0 * beta / step
        self.shift = (4.0 / step**2 + 2.0 * alpha / step) / self.gain
        # The preconditioner is made at once: a resumed run must have the same.
        self.solver.restore(self.shift)

    def advance(
        self, u: Array, v: Array, a: Array, guess: Array, rhs: Array, given: Array
    ) -> tuple[Array, Array, Array, Array]:
        """u, v, a and the solved field q at the end of a step.

        Parameters
        ----------
        u, v, a : ndarray, shape (components, active)
            At its begin; in rotations only u means something.
        guess : ndarray, shape (components, active)
            Of q.
        rhs : ndarray, shape (components, active)
            Load at the end less what prescribed unknowns exert.
        given : ndarray, shape (components, active)
            Values of the prescribed components at the end.
        """
        h, m = self.step, self.mass
        before = u - self.beta * v
        right = rhs + m * (self.shift * before + (4.0 / h + self.alpha) * v + a)
        matrix = self.solver.matrix(self.shift)
        fixed = matrix.identity_rows
        if fixed is not None:
            right[fixed] = matrix.identity_scale * given[fixed]
        q = self.solver.solve(self.shift, right.ravel(), guess.ravel(), self.tolerance)
        q = q.reshape(u.shape)
        change = (q - before) / self.gain
        after = u + change
        moving = m > 0
        velocity = np.where(moving, 2.0 / h * change - v, 0.0)
        acceleration = np.where(moving, 4.0 / h**2 * change - 4.0 / h * v - a, 0.0)
        if fixed is not None:
            after[fixed] = given[fixed]
        after[~moving] = q[~moving] if fixed is None else np.where(fixed, after, q)[~moving]
        return after, velocity, acceleration, q
