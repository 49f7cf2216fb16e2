"""Thermal stress in a free disc that is hottest at its centre.

S. P. Timoshenko, J. N. Goodier, *Theory of Elasticity*, 3rd ed., sect. 150: for an axisymmetric
temperature T(r) in a free disc of radius a, plane stress,

    u_r = alpha [(1 + nu) I(r)/r + (1 - nu) r I(a)/a^2],      I(r) = int_0^r T r dr,
    s_r = alpha E [I(a)/a^2 - I(r)/r^2],   s_t = alpha E [I(a)/a^2 + I(r)/r^2 - T].

Plane strain is the same with E/(1 - nu^2), nu/(1 - nu) and (1 + nu) alpha.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from references.analytic.voigt import Floats, checked_points


@dataclass(frozen=True)
class HeatedDisc:
    """A free disc with the temperature T0 (1 - r^2/a^2).

    Attributes
    ----------
    E, nu, alpha : float
        Pa, 1 and 1/K, of the solid itself in plane strain too.
    T0, radius : float
        K, m.
    plane_strain : bool
    """

    E: float = 1.0
    nu: float = 0.25
    alpha: float = 1.0
    T0: float = 1.0
    radius: float = 1.0
    plane_strain: bool = False

    def __post_init__(self) -> None:
        if not (self.E > 0 and self.radius > 0 and -1 < self.nu < 0.5):
            raise ValueError("E and radius must be positive, nu between -1 and 1/2")

    @property
    def plane(self) -> tuple[float, float, float]:
        """E, nu and alpha of the plane-stress problem with the same plane field."""
        if not self.plane_strain:
            return self.E, self.nu, self.alpha
        nu = self.nu
        return self.E / (1 - nu**2), nu / (1 - nu), (1 + nu) * self.alpha

    def temperature(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """K."""
        xs, ys = checked_points(x, y)
        return np.asarray(self.T0 * (1 - (xs**2 + ys**2) / self.radius**2))

    def displacement(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """(..., 2), m; none at the centre, no rotation."""
        xs, ys = checked_points(x, y)
        _, nu, alpha = self.plane
        share = (xs**2 + ys**2) / self.radius**2
        # u_r/r, with I(r)/r^2 = T0 (1/2 - share/4)
        over_r = alpha * self.T0 * ((1 + nu) * (0.5 - share / 4) + (1 - nu) / 4)
        return np.stack([over_r * xs, over_r * ys], axis=-1)

    def stress(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """s11, s22 and s12, (..., 3), Pa."""
        xs, ys = checked_points(x, y)
        E, _, alpha = self.plane
        unit, square = alpha * E * self.T0, xs**2 + ys**2
        share = square / self.radius**2
        radial, hoop = unit * (share - 1) / 4, unit * (3 * share - 1) / 4
        # (radial - hoop)/r^2 is the same everywhere: no direction is needed at the centre
        turn = -unit / (2 * self.radius**2)
        mean = 0.5 * (radial + hoop)
        half = 0.5 * turn * (xs**2 - ys**2)
        return np.stack([mean + half, mean - half, turn * xs * ys], axis=-1)
