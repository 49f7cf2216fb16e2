"""Effective tensor of the tetrachiral block lattice (A. Bacigalupo and L. Gambarotta, 2017).

Rigid squares of side a stand on a square grid of pitch l = a / cos(beta), turned by the chirality
angle beta; neighbours touch along interfaces of length b = (1 - tan beta) a whose normal is turned
by beta from the line of centroids.  Per unit depth an interface is a spring bed with normal and
tangential stiffness K_n, K_t (Eq. 86), acting at the midpoint of the centroids.

In a homogeneous strain the blocks turn, all by the same angle, until the energy is least.  With

    A = K_n cos^2 + K_t sin^2,  M = (K_n - K_t) sin cos,  D = K_n sin^2 + K_t cos^2

the energy per cell and pitch squared is, before and after that,

    A/2 (e11^2 + e22^2) + M [e11 (e12 - phi) - e22 (e12 + phi)] + D (e12^2 + phi^2),
    phi = M (e11 + e22) / (2 D),

which gives Eqs. 87-90 with cos 2 beta in the denominator of Eq. 87.
"""

from __future__ import annotations

import numpy as np

from references.analytic.voigt import Floats


def _checked_angle(beta: float) -> float:
    if not 0.0 <= beta < np.pi / 4:
        raise ValueError("the chirality angle lies in [0, pi/4): beyond, the blocks do not touch")
    return float(beta)


def effective_voigt(Kn: float, Kt: float, beta: float) -> Floats:
    """Stiffness of the homogenised lattice (Eqs. 87-90, the first of them corrected).

    Parameters
    ----------
    Kn, Kt : float
        Normal and tangential stiffness of an interface per unit depth, Pa (force per length of
        jump and depth).
    beta : float
        Chirality angle in radians, 0 <= beta < pi/4; blocks turned anticlockwise.

    Returns
    -------
    ndarray, (3, 3)
        Square-symmetric Voigt stiffness in Pa, C16 = -C26, independent of the pitch.

    Raises
    ------
    ValueError
        If a stiffness is not positive and finite or the angle is outside its range.
    """
    if not (np.isfinite(Kn) and np.isfinite(Kt) and Kn > 0.0 and Kt > 0.0):
        raise ValueError("the interface stiffnesses Kn and Kt must be positive and finite")
    c, s = np.cos(_checked_angle(beta)), np.sin(beta)
    axial = Kn * c * c + Kt * s * s
    mixed = (Kn - Kt) * s * c
    shear = Kn * s * s + Kt * c * c
    softening = mixed**2 / (2 * shear)  # what the turning blocks give away
    c11, c12, c16 = axial - softening, -softening, 0.5 * mixed
    return np.array([[c11, c12, c16], [c12, c11, -c16], [c16, -c16, 0.5 * shear]])


def effective_turn(Kn: float, Kt: float, beta: float) -> Floats:
    """What the blocks turn by beside the displacement's own rotation, per unit strain.

    Parameters
    ----------
    Kn, Kt, beta : float
        As of `effective_voigt`.

    Returns
    -------
    ndarray, (3,)
        r in theta - omega = r . (e11, e22, 2 e12): M/(2 D) (1, 1, 0), a dilation's alone.

    Raises
    ------
    ValueError
        As `effective_voigt`.
    """
    effective_voigt(Kn, Kt, beta)
    c, s = np.cos(beta), np.sin(beta)
    turn = 0.5 * (Kn - Kt) * s * c / (Kn * s * s + Kt * c * c)
    return np.array([turn, turn, 0.0])


def interface_stiffness(
    young: float, poisson: float, length: float, thickness: float
) -> tuple[float, float]:
    """K_n and K_t of a thin isotropic interface between rigid blocks, plane stress (Eq. 86).

    Parameters
    ----------
    young : float
        Pa.
    poisson : float
    length, thickness : float
        Of the interface, m; the thickness is small against the length.

    Returns
    -------
    Kn, Kt : float
        Pa.
    """
    sizes = np.array([young, length, thickness], dtype=float)
    if not (np.all((sizes > 0.0) & (sizes < np.inf)) and -1.0 < poisson <= 0.5):
        raise ValueError(
            "an interface needs E > 0, -1 < nu <= 1/2 and positive dimensions, all of them finite"
        )
    slenderness = length / thickness
    normal = slenderness * young / (1 - poisson**2)
    return normal, slenderness * young / (2 * (1 + poisson))


def cell_geometry(side: float, beta: float) -> tuple[float, float, float]:
    """Pitch l, interface length b (both m) and solid fraction cos^2(beta) of the lattice.

    Raises
    ------
    ValueError
        If the side is not positive or the angle is outside [0, pi/4).
    """
    if not 0.0 < side < np.inf:
        raise ValueError("the side of a block must be positive and finite")
    angle = _checked_angle(beta)
    return (
        float(side / np.cos(angle)),
        float((1 - np.tan(angle)) * side),
        float(np.cos(angle) ** 2),
    )
