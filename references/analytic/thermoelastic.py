"""Deformational heating: adiabatic changes, and the damping of a vibrating strip.

With beta = C A, the heat capacity c at constant strain and the temperature T0, a strain faster than
heat flows changes the temperature by -T0 beta.eps/c and meets the stiffness C + T0 beta beta^T/c.

**A strip in bending** (C. Zener 1937; R. Lifshitz, M. L. Roukes, Phys. Rev. B 61, 2000): on a
strained side it cools, on the other it warms, and heat flows across. With s22 = 0, plane stress,
e22 = -nu e + (1 + nu) alpha T adds to the capacity, so that

    c' i w T - k T'' = -i w Y alpha T0 kappa y,    T' = 0 at y = +-h/2,
    c' = c + T0 Y alpha^2 (1 + nu)/(1 - nu),

and the loss 1/Q = Im M/Re M of the moment M = int Y (kappa y - alpha T) y dy is, for a small
Delta = Y alpha^2 T0/c',

    1/Q = Delta (6/x^2 - 6/x^3 (sinh x + sin x)/(cosh x + cos x)),    x = h sqrt(w c'/2k).

Zener's own is Delta w tau/(1 + w^2 tau^2) with tau = h^2 c'/(pi^2 k), the first term of its series.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from references.analytic.voigt import Floats, checked_voigt


def adiabatic_change(
    voigt: ArrayLike, expansion: ArrayLike, strain: ArrayLike, T0: float, capacity: float
) -> float:
    """-T0 beta.eps/c, K; expansion as (A11, A22, 2 A12), strain as (e11, e22, 2 e12)."""
    beta = checked_voigt(voigt) @ np.asarray(expansion, dtype=float)
    return float(-T0 / capacity * beta @ np.asarray(strain, dtype=float))


def adiabatic_voigt(voigt: ArrayLike, expansion: ArrayLike, T0: float, capacity: float) -> Floats:
    """C + T0 beta beta^T/c, (3, 3), Pa."""
    c = checked_voigt(voigt)
    beta = c @ np.asarray(expansion, dtype=float)
    return np.asarray(c + T0 / capacity * np.outer(beta, beta))


def relaxation(
    E: float, nu: float, alpha: float, T0: float, capacity: float
) -> tuple[float, float]:
    """Delta and c' of a strip in plane stress; `capacity` is that at constant strain."""
    more = capacity + T0 * E * alpha**2 * (1 + nu) / (1 - nu)
    return E * alpha**2 * T0 / more, more


def bending_loss(
    E: float,
    nu: float,
    alpha: float,
    T0: float,
    capacity: float,
    conductivity: float,
    thickness: float,
    frequency: ArrayLike,
) -> Floats:
    """1/Q of Lifshitz and Roukes at angular frequencies, rad/s."""
    delta, more = relaxation(E, nu, alpha, T0, capacity)
    w = np.asarray(frequency, dtype=float)
    x = thickness * np.sqrt(w * more / (2 * conductivity))
    ratio = (np.sinh(x) + np.sin(x)) / (np.cosh(x) + np.cos(x))
    return np.asarray(delta * (6 / x**2 - 6 / x**3 * ratio))
