"""Two equal collinear cracks in an infinite isotropic plane under tension across them.

H. M. Westergaard's function for cracks on b < |x| < a (T. J. Willmore 1949; H. Tada, P. C. Paris
and G. R. Irwin, *The Stress Analysis of Cracks Handbook*):

    Z(z) = σ (z² − λ²) / sqrt((z² − a²)(z² − b²)),   λ² = a² E(k)/K(k),   k² = 1 − b²/a².

λ makes the opening vanish at both ends of a crack. A uniform −σ along the cracks is added, so that
far away there is tension across them only.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ellipe, ellipkm1

from references.analytic.quadrature import gauss
from references.analytic.voigt import Floats

# Gauss points between a point and infinity.
_POINTS = 80


def _middle(inner: float, outer: float) -> float:
    """λ², m²."""
    if not 0 < inner < outer:
        raise ValueError(f"tips lie at 0 < inner < outer, not {inner} and {outer}")
    ratio = (inner / outer) ** 2
    return float(outer**2 * ellipe(1 - ratio) / ellipkm1(ratio))


def intensities(inner: float, outer: float, tension: float = 1.0) -> tuple[float, float]:
    """K_I of the inner and of the outer tips, Pa m^(1/2).

    Parameters
    ----------
    inner, outer : float
        Distances b and a of the tips from the middle, m.
    tension : float
        σ, Pa.

    Raises
    ------
    ValueError
        If not 0 < inner < outer.
    """
    middle = _middle(inner, outer)
    spread = outer**2 - inner**2
    scale = tension * np.sqrt(np.pi)
    return (
        float(scale * (middle - inner**2) / np.sqrt(inner * spread)),
        float(scale * (outer**2 - middle) / np.sqrt(outer * spread)),
    )


def _function(z: np.ndarray, inner: float, outer: float, tension: float) -> np.ndarray:
    """Z(z); the product of principal roots is cut along both cracks only."""
    root = np.sqrt(z - outer) * np.sqrt(z + outer) * np.sqrt(z - inner) * np.sqrt(z + inner)
    found: np.ndarray = tension * (z**2 - _middle(inner, outer)) / root
    return found


def displacement_and_rotation(
    x: ArrayLike,
    y: ArrayLike,
    inner: float,
    outer: float,
    tension: float,
    young: float,
    poisson: float,
) -> tuple[Floats, Floats]:
    """Displacement (m) and rotation (rad) outside the circle through the outer tips, plane stress.

    The primitive of Z is σ z less the integral of Z − σ from the point to infinity along the ray
    from the middle, where it falls off as 1/z².

    Returns
    -------
    ndarray (..., 2), ndarray (...)

    Raises
    ------
    ValueError
        If a point lies within that circle.
    """
    z = np.asarray(x, dtype=float) + 1j * np.asarray(y, dtype=float)
    if not np.all(np.abs(z) > outer):
        raise ValueError("displacements are known outside the circle through the outer tips only")
    nodes, weights = gauss(_POINTS)
    u, w = 0.5 * (nodes + 1), 0.5 * weights
    far = z[..., None] / u
    rest = (_function(far, inner, outer, tension) - tension) * far / u
    primitive = tension * z - rest @ w
    value = _function(z, inner, outer, tension)
    shear = young / (2 * (1 + poisson))
    kappa = (3 - poisson) / (1 + poisson)
    u1 = (0.5 * (kappa - 1) * primitive.real - z.imag * value.imag) / (2 * shear)
    u2 = (0.5 * (kappa + 1) * primitive.imag - z.imag * value.real) / (2 * shear)
    u1 = u1 - tension * z.real / young
    u2 = u2 + poisson * tension * z.imag / young
    rotation = (kappa + 1) * value.imag / (4 * shear)
    return np.stack([u1, u2], axis=-1), rotation
