"""Stress intensity factors of a field that is known at quadrature points around a crack tip.

J. F. Yau, S. S. Wang and H. T. Corten's interaction integral (J. Appl. Mech. 47 (1980) 335) in
its domain form: with the auxiliary fields of pure modes,

    M = ∫ [σ_ij u'_i,1 + σ'_ij u_i,1 − σ_ik ε'_ik δ_1j] q,j dA = 2 Kᵀ A K',

where G = Kᵀ A K and q falls from one at the tip to zero outside. It holds for straight,
traction-free faces within q's support and no body force there.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from references.analytic.lekhnitskii import (
    crack_tip_gradient,
    crack_tip_stress,
    energy_release_rate,
)
from references.analytic.voigt import Floats, checked_voigt, strain_of_gradient, turned_axes


def intensities(
    voigt: ArrayLike,
    points: ArrayLike,
    gradient: ArrayLike,
    weight: ArrayLike,
    angle: float,
    inner: float,
    outer: float,
) -> tuple[float, float]:
    """K_I and K_II from displacement gradients at points around a tip at the origin.

    Parameters
    ----------
    voigt : array_like, (3, 3)
        Stiffness, Pa, along the reference axes. It makes the stress of the gradient.
    points : array_like, (..., 2)
        m; the weight function's slope is zero nearer than `inner` and farther than `outer`.
    gradient : array_like, (..., 2, 2)
        u_i,j in the reference axes.
    weight : array_like, broadcast to the points
        Area of each quadrature point, m².
    angle : float
        Direction in which the crack would advance along itself, rad from axis 1.
    inner, outer : float
        Radii of the ring, m.

    Returns
    -------
    KI, KII : float
        In the crack's own axes, Pa √m.

    Raises
    ------
    ValueError
        If the radii are no ring, a number is not finite or the tensor not positive definite.
    """
    if not (np.isfinite([angle, inner, outer]).all() and 0 < inner < outer):
        raise ValueError("an integration ring needs 0 < inner < outer radius and a finite angle")
    at, slopes = np.asarray(points, float), np.asarray(gradient, float)
    if not (np.isfinite(at).all() and np.isfinite(slopes).all()):
        raise ValueError("a point or a displacement gradient of the integration ring is not finite")
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    local = at @ turn.T
    du = np.einsum("ia,...ab,jb->...ij", turn, slopes, turn)
    own = turned_axes(checked_voigt(voigt), angle)
    stress = _matrix(strain_of_gradient(du) @ own.T)
    dq = _slope(local, inner, outer)
    products = []
    for mode in ((1.0, 0.0), (0.0, 1.0)):
        du_aux = crack_tip_gradient(own, local[..., 0], local[..., 1], *mode)
        stress_aux = _matrix(crack_tip_stress(own, local[..., 0], local[..., 1], *mode))
        mutual = np.einsum("...ij,...ij->...", stress, du_aux)
        vector = np.einsum("...ij,...i->...j", stress, du_aux[..., 0])
        vector += np.einsum("...ij,...i->...j", stress_aux, du[..., 0])
        vector[..., 0] -= mutual
        # q falls outwards, hence the sign
        products.append(-np.sum(np.einsum("...j,...j->...", vector, dq) * weight))
    g11, g22 = (energy_release_rate(own, *mode) for mode in ((1.0, 0.0), (0.0, 1.0)))
    g12 = (energy_release_rate(own, 1.0, 1.0) - g11 - g22) / 2
    k1, k2 = np.linalg.solve(2 * np.array([[g11, g12], [g12, g22]]), products)
    return float(k1), float(k2)


def _matrix(voigt_stress: Floats) -> Floats:
    s11, s22, s12 = np.moveaxis(voigt_stress, -1, 0)
    return np.stack([np.stack([s11, s12], -1), np.stack([s12, s22], -1)], -2)


def _slope(local: Floats, inner: float, outer: float) -> Floats:
    """Gradient of −q, with q = 1 inside, 0 outside and a smooth cubic between."""
    r = np.hypot(local[..., 0], local[..., 1])
    s = np.clip((r - inner) / (outer - inner), 0, 1)
    fall = 6 * s * (1 - s) / (outer - inner)
    return np.asarray(fall[..., None] * local / np.maximum(r, 1e-300)[..., None])
