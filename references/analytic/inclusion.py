"""A circular inclusion in an infinite plane: conduction and plane elasticity.

A disc of radius a of another isotropic solid, firmly bonded, in a uniform far field. Its own field
is uniform (J. D. Eshelby, Proc. R. Soc. A 241, 1957, for ellipses; J. N. Goodier, Trans. ASME 55,
1933, for the stresses around it). Derived here:

* Conduction: T = G·x outside less the dipole b G·x a²/r², and inside (1 - b) G·x, with continuous
  temperature and normal flux: b = (k1 - k)/(k1 + k).
* Elasticity, by the potentials of Kolosov and Muskhelishvili (2 mu (u + iv) = kappa phi - z phi'* -
  psi*): outside phi = A z + B a²/z, psi = C z + D a²/z + B a⁴/z³, inside phi = F z, psi = H z.
  Continuous traction, 2A + D = 2F and B + C* = H*, and continuous displacement,
  (kappa A - A - D)/mu = (kappa1 - 1) F/mu1 and (kappa B - C*)/mu = -H*/mu1, give all of them.

Lengths in m, stress in Pa; the centre is the origin.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from references.analytic.voigt import Floats


@dataclass(frozen=True)
class ConductingInclusion:
    """Temperature around and in a disc of another conductivity.

    Parameters
    ----------
    matrix, inclusion : float
        Conductivities, W/(m K).
    gradient : pair of float
        Of the temperature far away, K/m.
    radius : float
        m.
    """

    matrix: float
    inclusion: float
    gradient: tuple[float, float] = (1.0, 0.0)
    radius: float = 1.0

    def value(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Temperature at the points, K."""
        x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
        far = self.gradient[0] * x + self.gradient[1] * y
        square = (x * x + y * y) / self.radius**2
        dipole = (self.inclusion - self.matrix) / (self.inclusion + self.matrix)
        outside = 1.0 - dipole / np.maximum(square, 1.0)
        return np.asarray(far * np.where(square < 1.0, 1.0 - dipole, outside))


@dataclass(frozen=True)
class ElasticInclusion:
    """Displacement and stress around and in a disc of another solid, plane stress.

    Parameters
    ----------
    matrix, inclusion : pair of float
        Young's modulus, Pa, and Poisson's ratio.
    stress : triple of float
        Far away: s11, s22, s12, Pa.
    radius : float
        m.
    """

    matrix: tuple[float, float]
    inclusion: tuple[float, float]
    stress: tuple[float, float, float] = (1.0, 0.0, 0.0)
    radius: float = 1.0

    def _constants(self) -> tuple[list[float], list[float], list[complex]]:
        mu, kappa = [], []
        for modulus, poisson in (self.matrix, self.inclusion):
            mu.append(modulus / (2 * (1 + poisson)))
            kappa.append((3 - poisson) / (1 + poisson))
        g = mu[0] / mu[1]
        s11, s22, s12 = self.stress
        a, c = 0.25 * (s11 + s22), 0.5 * (s22 - s11) + 1j * s12
        f = (kappa[0] + 1) * a / (2 + g * (kappa[1] - 1))
        b = np.conj(c) * (1 - g) / (kappa[0] + g)
        d = 2 * (f - a)
        h = np.conj(b + np.conj(c))
        return mu, kappa, [a, b, c, d, f, h]

    def displacement(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """u at the points, shape (..., 2), m; no translation and no rotation at the centre."""
        mu, kappa, (a, b, c, d, f, h) = self._constants()
        z, inside = self._places(x, y)
        r2 = self.radius**2
        with np.errstate(divide="ignore", invalid="ignore"):
            phi, slope = a * z + b * r2 / z, a - b * r2 / z**2
            psi = c * z + d * r2 / z + b * r2**2 / z**3
            outer = (kappa[0] * phi - z * np.conj(slope) - np.conj(psi)) / (2 * mu[0])
        inner = (kappa[1] * f * z - z * np.conj(f) - np.conj(h * z)) / (2 * mu[1])
        u = np.where(inside, inner, outer)
        return np.stack([u.real, u.imag], axis=-1)

    def rotation(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Half the curl of u at the points, rad."""
        mu, kappa, (a, b, _, _, f, _) = self._constants()
        z, inside = self._places(x, y)
        with np.errstate(divide="ignore", invalid="ignore"):
            slope = a - b * self.radius**2 / z**2
        outer = (kappa[0] + 1) * np.imag(slope) / (2 * mu[0])
        inner = (kappa[1] + 1) * np.imag(f + 0 * z) / (2 * mu[1])
        return np.asarray(np.where(inside, inner, outer))

    def stress_at(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """(s11, s22, s12) at the points, shape (..., 3), Pa."""
        _, _, (a, b, c, d, f, h) = self._constants()
        z, inside = self._places(x, y)
        r2 = self.radius**2
        with np.errstate(divide="ignore", invalid="ignore"):
            slope, bend = a - b * r2 / z**2, 2 * b * r2 / z**3
            turn = c - d * r2 / z**2 - 3 * b * r2**2 / z**4
        slope, bend = np.where(inside, f, slope), np.where(inside, 0.0, bend)
        turn = np.where(inside, h, turn)
        total, difference = 4 * slope.real, 2 * (np.conj(z) * bend + turn)
        return np.stack(
            [
                0.5 * (total - difference.real),
                0.5 * (total + difference.real),
                0.5 * difference.imag,
            ],
            axis=-1,
        )

    def _places(self, x: ArrayLike, y: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        z = np.asarray(x, dtype=float) + 1j * np.asarray(y, dtype=float)
        return z, np.abs(z) < self.radius
