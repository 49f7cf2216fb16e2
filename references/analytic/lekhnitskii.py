"""Crack-tip fields of a plane anisotropic body in the Lekhnitskii formalism.

The crack lies along the negative x axis with its tip at the origin and free faces.  Sources:
S. G. Lekhnitskii, *Theory of Elasticity of an Anisotropic Body* (1963), for the characteristic
equation; G. C. Sih, P. C. Paris and G. R. Irwin, *Int. J. Fract. Mech.* 1 (1965) 189-203, for the
fields and the energy release rate.  They stand where the paper has Eqs. 79-82 and 109 (Eq. 79 is
misprinted; the frames of Eq. 109 are not said, see `references.errata`).

Every textbook form carries the factor 1/(mu1 - mu2), which is 0/0 in an isotropic body.  Here the
fields are written as divided differences h[mu1, mu2] and these are expanded by hand with

    sqrt(z1) - sqrt(z2) = (mu1 - mu2) y / (sqrt(z1) + sqrt(z2)),    z = x + mu y,

where the sum on the right cannot cancel (both roots lie in one quadrant).  The fields are then
smooth functions of mu1 + mu2 and mu1 mu2, and those two are what `characteristic_factor` computes
to full accuracy even where the roots themselves coincide.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from references.analytic.voigt import Floats, checked_points, checked_voigt, turned_axes

Complexes = NDArray[np.complex128]


def characteristic_factor(voigt: ArrayLike) -> tuple[complex, complex]:
    """Sum and product of the two characteristic roots that have a positive imaginary part.

    They are the coefficients of the quadratic factor mu^2 - sum mu + product of

        S11 mu^4 - 2 S16 mu^3 + (2 S12 + S66) mu^2 - 2 S26 mu + S22 = 0.

    The factor is well conditioned wherever the roots stay off the real axis, coincident or not:
    its roots and those of the conjugate factor are separated by that axis.

    Parameters
    ----------
    voigt : array_like, (3, 3)
        Positive definite stiffness.

    Returns
    -------
    total, product : complex
    """
    s = np.linalg.inv(checked_voigt(voigt))
    # mu = scale * nu makes the constant coefficient one, whatever the ratio of the stiffnesses.
    scale = (s[1, 1] / s[0, 0]) ** 0.25
    s11 = s[0, 0] * scale**4
    a3 = -2 * s[0, 2] * scale**3 / s11
    a2 = (2 * s[0, 1] + s[2, 2]) * scale**2 / s11
    a1 = -2 * s[1, 2] * scale / s11
    roots = np.roots([1.0, a3, a2, a1, 1.0])
    upper = roots[np.argsort(roots.imag)][2:]
    total, product = complex(upper.sum()), complex(upper.prod())
    # Newton on the four real equations of the factorisation, in the unknowns Re and Im of sum
    # and product.  Two steps reach rounding from the companion matrix' worst (half the digits).
    for _ in range(4):
        p, q, u, v = total.real, total.imag, product.real, product.imag
        residual = np.array(
            [
                -2 * p - a3,
                2 * u + p * p + q * q - a2,
                -2 * (p * u + q * v) - a1,
                u * u + v * v - 1.0,
            ]
        )
        jacobian = np.array(
            [
                [-2, 0, 0, 0],
                [2 * p, 2 * q, 2, 0],
                [-2 * u, -2 * v, -2 * p, -2 * q],
                [0, 0, 2 * u, 2 * v],
            ]
        )
        dp, dq, du, dv = np.linalg.solve(jacobian, -residual)
        total += complex(dp, dq)
        product += complex(du, dv)
    return scale * total, scale**2 * product


def characteristic_roots(voigt: ArrayLike) -> Complexes:
    """The two roots of Lekhnitskii's characteristic equation with a positive imaginary part.

    Parameters
    ----------
    voigt : array_like, (3, 3)
        Positive definite stiffness, engineering shear.

    Returns
    -------
    ndarray of complex, (2,)
        In order of real, then imaginary part; the order means nothing.  Their sum and product
        are right to rounding; two roots closer than 1e-8 are individually known to about 1e-8,
        which no field here feels.

    Raises
    ------
    ValueError
        If the tensor is not a positive definite elastic tensor.

    Notes
    -----
    Eq. 79 of the paper prints mu^4 for mu^3 and drops mu from the last odd term.
    """
    total, product = characteristic_factor(voigt)
    half = 0.5 * total
    spread = np.sqrt(half * half - product)
    # The larger of the two is free of cancellation; the product gives the other.
    larger = half + spread if abs(half + spread) >= abs(half - spread) else half - spread
    roots = np.array([larger, product / larger])
    if np.min(roots.imag) <= 0.0:
        raise ValueError("the elastic tensor has a real characteristic root: not positive definite")
    return np.sort_complex(roots)


class RootPair(NamedTuple):
    """Values of a function at the two roots and its divided difference between them."""

    # Complex numbers, or complex arrays of the points' shape.
    first: Any
    second: Any
    difference: Any

    def times(self, other: RootPair) -> RootPair:
        """The product of two functions (Leibniz' rule for divided differences)."""
        return RootPair(
            self.first * other.first,
            self.second * other.second,
            self.difference * other.first + self.second * other.difference,
        )

    def over(self, other: RootPair) -> RootPair:
        """The quotient of two functions."""
        second = self.second / other.second
        return RootPair(
            self.first / other.first,
            second,
            (self.difference - second * other.difference) / other.first,
        )


class TipBasis:
    """What all the fields share: roots, polynomials in mu, and the root functions at the points."""

    def __init__(self, voigt: ArrayLike, x: ArrayLike, y: ArrayLike, face: str | None) -> None:
        if face not in (None, "upper", "lower"):
            raise ValueError(f"face must be 'upper', 'lower' or None, not {face!r}")
        xs, ys = checked_points(x, y)
        if face is not None:
            ys = np.where(ys == 0.0, 0.0 if face == "upper" else -0.0, ys)
        s = np.linalg.inv(checked_voigt(voigt))
        mu = characteristic_roots(voigt)
        p = s[0, 0] * mu**2 - s[0, 2] * mu + s[0, 1]
        q = s[0, 1] * mu + s[1, 1] / mu - s[1, 2]
        self.mu = RootPair(mu[0], mu[1], 1.0)
        self.p = RootPair(p[0], p[1], s[0, 0] * (mu[0] + mu[1]) - s[0, 2])
        self.q = RootPair(q[0], q[1], s[0, 1] - s[1, 1] / (mu[0] * mu[1]))
        # Built by parts, since complex multiplication would lose the sign of y = -0.0, which
        # tells the lower crack face from the upper one.
        z = np.empty((2, *xs.shape), dtype=complex)
        for k in range(2):
            z.real[k] = xs + mu[k].real * ys
            z.imag[k] = mu[k].imag * ys
        w = np.sqrt(z)
        with np.errstate(divide="ignore", invalid="ignore"):
            self.root = RootPair(w[0], w[1], np.where(w[0] == 0, 0.0, ys / (w[0] + w[1])))
            self.inverse = RootPair(1 / w[0], 1 / w[1], -ys / (w[0] * w[1] * (w[0] + w[1])))
        self.at_tip = np.any((xs == 0.0) & (ys == 0.0))

    def refuse_tip(self, what: str) -> None:
        if self.at_tip:
            raise ValueError(f"the {what} is unbounded at the crack tip (a point equals the tip)")

    def field(self, h: RootPair, KI: float, KII: float) -> Floats:
        """Re[KI (mu1 h2 - mu2 h1) - KII (h1 - h2)] / (mu1 - mu2), the form of every field."""
        if not np.all(np.isfinite([KI, KII])):
            raise ValueError("a stress intensity factor is not finite")
        return np.real(KI * (h.second - self.mu.second * h.difference) - KII * h.difference)


def crack_tip_displacement(
    voigt: ArrayLike, x: ArrayLike, y: ArrayLike, KI: float, KII: float, *, face: str | None = None
) -> Floats:
    """Displacement near a crack tip (Eqs. 80-82), without the rigid motion.

    Parameters
    ----------
    voigt : array_like, (3, 3)
        Stiffness in Pa.
    x, y : array_like
        Points relative to the tip, m; the crack is x < 0, y = 0.
    KI, KII : float
        Stress intensity factors, Pa m^(1/2), with sigma22 = KI / sqrt(2 pi x) ahead.
    face : {"upper", "lower"}, optional
        The face that points with y = 0 exactly belong to.  By default the sign of zero decides:
        y = +0.0 is the upper face, y = -0.0 the lower one.

    Returns
    -------
    ndarray, (..., 2)
        u1, u2 in m.

    Raises
    ------
    ValueError
        If the tensor is not positive definite, or a coordinate or stress intensity factor is not
        finite.
    """
    basis = TipBasis(voigt, x, y, face)
    parts = [basis.field(f.times(basis.root), KI, KII) for f in (basis.p, basis.q)]
    return np.sqrt(2 / np.pi) * np.stack(parts, axis=-1)


def crack_tip_gradient(
    voigt: ArrayLike, x: ArrayLike, y: ArrayLike, KI: float, KII: float, *, face: str | None = None
) -> Floats:
    """Displacement gradient u_i,j near a crack tip, (..., 2, 2).

    Parameters as in `crack_tip_displacement`.

    Raises
    ------
    ValueError
        If a point is the tip itself.
    """
    basis = TipBasis(voigt, x, y, face)
    basis.refuse_tip("displacement gradient")
    rows = []
    for f in (basis.p, basis.q):
        h = f.times(basis.inverse)
        along = basis.field(h, KI, KII)
        across = basis.field(basis.mu.times(h), KI, KII)
        rows.append(np.stack([along, across], axis=-1))
    return np.stack(rows, axis=-2) / np.sqrt(2 * np.pi)


def crack_tip_stress(
    voigt: ArrayLike, x: ArrayLike, y: ArrayLike, KI: float, KII: float, *, face: str | None = None
) -> Floats:
    """Stress near a crack tip, from the stress functions (not from the displacement).

    Parameters as in `crack_tip_displacement`.

    Returns
    -------
    ndarray, (..., 3)
        s11, s22, s12 in Pa.

    Raises
    ------
    ValueError
        If a point is the tip itself.
    """
    basis = TipBasis(voigt, x, y, face)
    basis.refuse_tip("stress")
    g = basis.inverse
    mu_g = basis.mu.times(g)
    parts = [
        basis.field(basis.mu.times(mu_g), KI, KII),
        basis.field(g, KI, KII),
        -basis.field(mu_g, KI, KII),
    ]
    return np.stack(parts, axis=-1) / np.sqrt(2 * np.pi)


def crack_tip_rotation(
    voigt: ArrayLike, x: ArrayLike, y: ArrayLike, KI: float, KII: float, *, face: str | None = None
) -> Floats:
    """Macrorotation (u2,1 - u1,2)/2 near a crack tip, positive anticlockwise (Eq. 85).

    Parameters as in `crack_tip_displacement`; returns radians, shape of the points.

    Raises
    ------
    ValueError
        If a point is the tip itself.
    """
    gradient = crack_tip_gradient(voigt, x, y, KI, KII, face=face)
    return 0.5 * (gradient[..., 1, 0] - gradient[..., 0, 1])


def energy_release_rate(voigt: ArrayLike, KI: float, KII: float, angle: float = 0.0) -> float:
    """Energy released per unit area of a crack that advances along itself (Sih-Paris-Irwin).

    Parameters
    ----------
    voigt : array_like, (3, 3)
        Stiffness in Pa, components along the reference axes.
    KI, KII : float
        Stress intensity factors in the axes of the crack, Pa m^(1/2).
    angle : float
        Direction of the crack from axis 1, radians.

    Returns
    -------
    float
        G in J/m^2.

    Notes
    -----
    With sum and product of the roots in the crack's axes,

        G = -KI/2 S22 Im[(KI sum + KII) / product] + KII/2 S11 Im[KII sum + KI product].

    The roots multiply to |product|^2 = S22/S11, so in mode I this is S11/2 Im[-KI^2 sum
    conj(product)], the form of Eq. 109.  Its second line is that with S1111 and roots in the
    material's axes; its first line, for a crack along axis 2, has the material's S2222 (S1111 in
    the crack's axes) and roots in the crack's axes, which the paper does not say.
    """
    if not np.all(np.isfinite([KI, KII, angle])):
        raise ValueError("a stress intensity factor or the crack angle is not finite")
    own = turned_axes(checked_voigt(voigt), angle)
    s = np.linalg.inv(own)
    total, product = characteristic_factor(own)
    opening = -0.5 * KI * s[1, 1] * ((KI * total + KII) / product).imag
    sliding = 0.5 * KII * s[0, 0] * (KII * total + KI * product).imag
    return float(opening + sliding)
