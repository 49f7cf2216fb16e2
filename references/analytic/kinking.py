"""Kink angle of a crack by the hoop stress intensity factor, for any plane tensor.

The hoop and shear factors are the limits of sqrt(2 pi r) sigma_ww and sqrt(2 pi r) sigma_rw at
the tip; the crack is taken to kink where the first is largest (A. Azhdari and S. Nemat-Nasser,
*J. Mech. Phys. Solids* 44 (1996) 929-951, for anisotropic bodies).  Balance of forces around the
tip, for stresses that go as r^(-1/2), reads dK_ww/dw = -3/2 K_rw: the stationary directions are
the zeros of the shear factor, which is how they are found here.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from references.analytic.lekhnitskii import characteristic_roots, crack_tip_stress
from references.analytic.voigt import Floats, checked_voigt


class KinkDirection(NamedTuple):
    """A local maximum of the hoop factor: direction (rad) and factor (Pa m^(1/2))."""

    angle: float
    factor: float


def hoop_factors(
    voigt: ArrayLike, angle: ArrayLike, KI: float, KII: float
) -> tuple[Floats, Floats]:
    """Hoop and shear stress intensity factors of directions from the tip.

    Parameters
    ----------
    voigt : array_like, (3, 3)
        Positive definite stiffness in the crack's axes.
    angle : array_like
        Directions from the crack's own, anticlockwise, radians, in [-pi, pi].
    KI, KII : float
        Stress intensity factors, Pa m^(1/2).

    Returns
    -------
    hoop, shear : ndarray
        K_ww and K_rw, Pa m^(1/2).

    Raises
    ------
    ValueError
        If a direction lies outside the body, that is beyond the crack faces at +-pi.
    """
    w = np.asarray(angle, dtype=float)
    if not np.all(np.abs(w) <= np.pi):
        raise ValueError("directions from the crack tip lie between -pi and pi, the two faces")
    c, s = np.cos(w), np.sin(w)
    # cos(pi), sin(pi) come out a rounding error off the faces, on the right side of them.
    s11, s22, s12 = np.moveaxis(crack_tip_stress(voigt, c, s, KI, KII), -1, 0) * np.sqrt(2 * np.pi)
    hoop = s11 * s * s + s22 * c * c - 2 * s12 * s * c
    shear = (s22 - s11) * s * c + s12 * (c * c - s * s)
    return hoop, shear


def _search_angles(voigt: ArrayLike) -> Floats:
    """Directions between which the shear factor changes sign at most once.

    The field varies over angles of order one except, in strongly anisotropic bodies, near the
    directions in which cos + mu sin is almost zero, where it varies over an angle of Im mu.
    """
    angles = [np.linspace(-np.pi, np.pi, 1442)[1:-1]]
    for mu in characteristic_roots(voigt):
        steep = np.arctan2(1.0, -mu.real)  # cos + Re(mu) sin = 0
        width = mu.imag * np.sin(steep) ** 2
        cluster = np.arctan(width * np.tan(np.linspace(-1.55, 1.55, 241)))
        for centre in (steep, steep - np.pi):
            angles.append(centre + cluster)
    merged = np.concatenate(angles)
    return np.unique(merged[np.abs(merged) < np.pi])


def hoop_maxima(voigt: ArrayLike, KI: float, KII: float) -> list[KinkDirection]:
    """All local maxima of the hoop factor with a tensile hoop stress, the largest first.

    Parameters
    ----------
    voigt : array_like, (3, 3)
        Positive definite stiffness in the crack's axes.
    KI, KII : float
        Stress intensity factors, not both zero; KI < 0 is taken as it stands (faces that would
        press on each other are not in this solution).

    Returns
    -------
    list of KinkDirection
        Equal maxima (a mirror-symmetric body in mode I) stand in order of |angle|, the positive
        angle first.

    Raises
    ------
    ValueError
        If the tensor is not positive definite, a factor is not finite or both are zero.
    """
    tensor = checked_voigt(voigt)
    if not np.all(np.isfinite([KI, KII])):
        raise ValueError("a stress intensity factor is not finite")
    size = float(np.hypot(KI, KII))
    if size == 0.0:
        raise ValueError("a crack without load (KI = KII = 0) has no kink angle")
    k1, k2 = KI / size, KII / size
    angles = _search_angles(tensor)
    shear = hoop_factors(tensor, angles, k1, k2)[1]

    def shear_at(w: float) -> float:
        return float(hoop_factors(tensor, w, k1, k2)[1])

    found = []
    # dK_ww/dw = -3/2 K_rw: a maximum is where the shear factor goes from negative to positive.
    for i in np.flatnonzero((shear[:-1] < 0.0) & (shear[1:] >= 0.0)):
        w = float(brentq(shear_at, angles[i], angles[i + 1], xtol=1e-14, rtol=8.9e-16))
        factor = float(hoop_factors(tensor, w, k1, k2)[0])
        if factor > 1e-12:
            found.append(KinkDirection(w, factor * size))
    top = max((f.factor for f in found), default=0.0)
    # Maxima that differ by rounding only are ties, to be put in an order that means something.
    found.sort(key=lambda f: (-round(f.factor / top, 10), round(abs(f.angle), 9), -f.angle))
    return found


def hoop_kink_angle(voigt: ArrayLike, KI: float, KII: float) -> float:
    """Direction of the largest hoop stress intensity factor over all directions.

    Parameters
    ----------
    voigt : array_like, (3, 3)
        Positive definite stiffness in the crack's axes (axis 1 along the crack).
    KI, KII : float
        Stress intensity factors, Pa m^(1/2).

    Returns
    -------
    float
        Kink angle in radians, anticlockwise from the crack's own direction; negative for
        KII > 0 in an isotropic body.  Of two equal maxima (mode I in a strongly orthotropic
        body, whose maximum leaves angle 0) the positive one.

    Raises
    ------
    ValueError
        As `hoop_maxima`, and if no direction is in tension (pure closure).

    Examples
    --------
    >>> import numpy as np
    >>> from references.analytic.voigt import isotropic_voigt
    >>> round(float(np.degrees(hoop_kink_angle(isotropic_voigt(1.0, 0.3), 0.0, 1.0))), 4)
    -70.5288
    """
    found = hoop_maxima(voigt, KI, KII)
    if not found:
        raise ValueError("no direction from the tip is in tension: the crack is closed")
    return found[0].angle + 0.0  # turns -0.0 into 0.0
