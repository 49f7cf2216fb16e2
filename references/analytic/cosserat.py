"""Size effects of a micropolar (Cosserat) strip: simple shear between walls, and bending.

Energy of a plane orthotropic solid whose points turn by theta, not by omega = curl(u)/2:

    W = eps.C.eps/2 + 2 mu_c (omega - theta)^2 + (E1 theta,1^2 + E2 theta,2^2)/2.

**Shear** of a strip 0 < y < H between walls that move by U and do not turn. With u = u1(y),
equilibrium of forces gives tau = (C66 + mu_c) u' + 2 mu_c theta, constant,
that of couples E2 theta'' = 2 mu_c u' + 4 mu_c theta, so

    theta = -tau/(2 C66) [1 - cosh((y - H/2)/l)/cosh(H/2l)],    l^2 = E2 (C66 + mu_c)/(4 C66 mu_c),
    tau H/U = C66/(1 - N^2 tanh(a)/a),       a = H/2l,  N^2 = mu_c/(C66 + mu_c):

C66 for thick strips, C66 + mu_c for thin ones. Couple-stress elasticity is the limit N -> 1 at
l^2 = E2/(4 C66), where a thin strip is rigid.

**Bending** to the curvature k: u1 = -k x y, u2 = k x^2/2 + ..., theta = omega = k x, so that no
point turns against the displacement and mu_c does not matter:

    M/k = Y H^3/12 + E1 H,    Y = 1/S11: Young's modulus along the strip.

Derived here; the tests hold both against the energy and a numerical solution. H. Neuber (1966) and
R. D. Mindlin (1963) have the isotropic ones.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from references.analytic.voigt import Floats, checked_voigt


@dataclass(frozen=True)
class Strip:
    """A strip of thickness H along axis 1, its middle at y = 0.

    Attributes
    ----------
    voigt : (3, 3) array
        Orthotropic about the strip, Pa; C66 > C12.
    bending : pair of float
        E1 and E2, N.
    thickness : float
        H, m.
    cosserat : float, optional
        mu_c, Pa; by default C66 - C12, that of a solid of bonds.
    """

    voigt: ArrayLike
    bending: tuple[float, float]
    thickness: float = 1.0
    cosserat: float | None = None

    def __post_init__(self) -> None:
        c = checked_voigt(self.voigt)
        if max(abs(c[0, 2]), abs(c[1, 2])) > 1e-12 * abs(c).max():
            raise ValueError("the strip must be orthotropic about its own axes")
        if not (self.mu_c > 0 and self.thickness > 0 and min(self.bending) > 0):
            raise ValueError("mu_c, the thickness and the bending stiffness must be positive")

    @property
    def shear(self) -> float:
        """C66, Pa."""
        return float(np.asarray(self.voigt)[2, 2])

    @property
    def mu_c(self) -> float:
        """Pa."""
        return self.shear - float(np.asarray(self.voigt)[0, 1]) if self.cosserat is None else (
            self.cosserat
        )  # fmt: skip

    @property
    def coupling(self) -> float:
        """N^2."""
        return self.mu_c / (self.shear + self.mu_c)

    @property
    def length(self) -> float:
        """l over which rotations of the walls die out, m."""
        return float(np.sqrt(self.bending[1] / (4 * self.shear * self.coupling)))

    @property
    def apparent_shear(self) -> float:
        """tau H/U of the strip between walls, Pa."""
        a = self.thickness / (2 * self.length)
        return float(self.shear / (1 - self.coupling * np.tanh(a) / a))

    @property
    def couple_stress_shear(self) -> float:
        """The same where rotations follow the displacement, N = 1: not of bonds, to compare."""
        a = self.thickness / (2 * np.sqrt(self.bending[1] / (4 * self.shear)))
        return float(self.shear / (1 - np.tanh(a) / a))

    def rotation(self, y: ArrayLike, slip: float = 1.0) -> Floats:
        """theta where the walls move by `slip` = U (m) against each other, rad."""
        tau = self.apparent_shear * slip / self.thickness
        half = self.thickness / (2 * self.length)
        at = np.asarray(y, dtype=float) / self.length
        # cosh(at)/cosh(half) without overflow.
        ratio = np.exp(np.abs(at) - half) * (1 + np.exp(-2 * np.abs(at))) / (1 + np.exp(-2 * half))
        return np.asarray(-tau / (2 * self.shear) * (1 - ratio))

    @property
    def bending_ratio(self) -> float:
        """M/k over that without couple stress."""
        young = 1 / np.linalg.inv(np.asarray(self.voigt, dtype=float))[0, 0]
        return float(1 + 12 * self.bending[0] / (young * self.thickness**2))

    @property
    def moment(self) -> float:
        """M/k, N m per m of depth times m."""
        young = 1 / np.linalg.inv(np.asarray(self.voigt, dtype=float))[0, 0]
        return float(young * self.thickness**3 / 12 * self.bending_ratio)


def shear_speed(
    voigt: ArrayLike, bending: float, wave_number: ArrayLike, cosserat: float | None = None
) -> Floats:
    """rho c^2 of a shear wave along 1 in a solid whose points turn without inertia, Pa.

    With u2 = a exp(ikx) the moment that is left, (4 mu_c + E1 k^2) theta = 2 mu_c u2', gives
    rho c^2 = C66 + mu_c - 4 mu_c^2/(4 mu_c + E1 k^2): C66 for long waves, C66 + mu_c for short
    ones.
    """
    c = checked_voigt(voigt)
    mu_c = c[2, 2] - c[0, 1] if cosserat is None else cosserat
    k = np.asarray(wave_number, dtype=float)
    return np.asarray(c[2, 2] + mu_c - 4 * mu_c**2 / (4 * mu_c + bending * k**2))
