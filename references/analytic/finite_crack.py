"""A straight crack in an infinite anisotropic plane under uniform stress far away.

The crack is |x| < a, y = 0, its faces free. S. G. Lekhnitskii, *Theory of Elasticity of an
Anisotropic Body* (1963); G. C. Sih, P. C. Paris and G. R. Irwin, *Int. J. Fract. Mech.* 1 (1965)
189-203. With f(z) = sqrt(z^2 - a^2), cut along the crack, potentials sigma f(z_k) leave the faces
free of traction and tend to uniform stress; a uniform stress along the crack may be added. They
are those of a tip with sqrt(z) replaced: the notation, and the divided differences that bear equal
roots, are those of `references.analytic.lekhnitskii`, here

    f(z1) - f(z2) = (mu1 - mu2) y (z1 + z2) / (f(z1) + f(z2)).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from references.analytic.lekhnitskii import RootPair, TipBasis, characteristic_factor
from references.analytic.voigt import Floats, checked_voigt


def intensities(half_length: float, opening: float, sliding: float) -> tuple[float, float]:
    """K_I and K_II, sigma sqrt(pi a), at the right tip and, in its own axes, at the left one.

    Parameters
    ----------
    half_length : float
        a, m.
    opening, sliding : float
        sigma22 and sigma12 far away, Pa.
    """
    scale = float(np.sqrt(np.pi * half_length))
    return opening * scale, sliding * scale


class FiniteCrack:
    """Displacement and rotation around the crack.

    Parameters
    ----------
    voigt : array_like, (3, 3)
        Stiffness in the crack's axes, Pa.
    half_length : float
        a, m.
    opening, sliding, along : float
        sigma22, sigma12 and sigma11 far away, Pa.

    Raises
    ------
    ValueError
        If the tensor is not positive definite, or the half length not positive.
    """

    def __init__(
        self,
        voigt: ArrayLike,
        half_length: float,
        opening: float,
        sliding: float = 0.0,
        along: float = 0.0,
    ) -> None:
        if not half_length > 0:
            raise ValueError(f"a crack's half length is positive, not {half_length}")
        self.voigt, self.half_length = checked_voigt(voigt), float(half_length)
        self.opening, self.sliding = float(opening), float(sliding)
        total, product = characteristic_factor(self.voigt)
        # The potentials' own sigma11 far away, Re[-sigma22 mu1 mu2 - sigma12 (mu1 + mu2)].
        own = -opening * product.real - sliding * total.real
        self._strain = np.linalg.inv(self.voigt) @ [along - own, 0.0, 0.0]

    def displacement(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """(..., 2), m, without a rigid motion; y = -0.0 is the lower face."""
        basis = TipBasis(self.voigt, x, y, None)
        root, _ = self._functions(basis, x, y)
        parts = [basis.field(f.times(root), self.opening, self.sliding) for f in (basis.p, basis.q)]
        e11, e22, shear = self._strain
        x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
        uniform = e11 * x + 0.5 * shear * y, 0.5 * shear * x + e22 * y
        return np.stack([part + more for part, more in zip(parts, uniform, strict=True)], axis=-1)

    def rotation(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """(u2,1 - u1,2)/2, rad."""
        basis = TipBasis(self.voigt, x, y, None)
        _, slope = self._functions(basis, x, y)
        along = basis.field(basis.q.times(slope), self.opening, self.sliding)
        across = basis.field(basis.mu.times(basis.p.times(slope)), self.opening, self.sliding)
        return 0.5 * (along - across)

    def stress(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """(..., 3): s11, s22, s12 from the stress functions, Pa."""
        basis = TipBasis(self.voigt, x, y, None)
        _, slope = self._functions(basis, x, y)
        mu_slope = basis.mu.times(slope)
        parts = [
            basis.field(h, self.opening, self.sliding)
            for h in (basis.mu.times(mu_slope), slope, mu_slope)
        ]
        uniform = self.voigt @ self._strain
        return np.stack([parts[0] + uniform[0], parts[1], -parts[2]], axis=-1)

    def _functions(self, basis: TipBasis, x: ArrayLike, y: ArrayLike) -> tuple[RootPair, RootPair]:
        """f and its derivative z/f at both roots."""
        xs, ys = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
        a = self.half_length
        z = [_complex(xs + mu.real * ys, mu.imag * ys) for mu in (basis.mu.first, basis.mu.second)]
        # Two roots, each cut to the left of its end: what lies left of both is whole again.
        one, two = (
            np.sqrt(_complex(value.real - a, value.imag))
            * np.sqrt(_complex(value.real + a, value.imag))
            for value in z
        )
        difference = np.where(
            ys == 0.0, 0.0, ys * (z[0] + z[1]) / np.where(ys == 0.0, 1.0, one + two)
        )
        root = RootPair(one, two, difference)
        return root, RootPair(z[0], z[1], ys).over(root)


def _complex(real: Floats, imaginary: Floats) -> np.ndarray:
    """By parts: arithmetic of complex numbers would lose the sign of y = -0.0."""
    found = np.empty(np.shape(real), dtype=complex)
    found.real, found.imag = real, imaginary
    return found
