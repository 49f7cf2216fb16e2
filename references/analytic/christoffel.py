"""Plane wave speeds of an anisotropic body: the long-wave limit of every lattice.

A wave u = d exp(i k (n . x - c t)) needs (Gamma - rho c^2) d = 0 with the Christoffel tensor
Gamma_ik = C_ijkl n_j n_l (B. A. Auld, *Acoustic Fields and Waves in Solids*, 1973, ch. 7).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from references.analytic.elasticity import acoustic_blocks
from references.analytic.voigt import Floats


def christoffel_tensor(voigt: ArrayLike, angle: ArrayLike) -> Floats:
    """Gamma_ik = C_ijkl n_j n_l for n = (cos, sin) of the angles, (..., 2, 2), Pa."""
    w = np.asarray(angle, dtype=float)
    if not np.all(np.isfinite(w)):
        raise ValueError("a direction of propagation is NaN or infinite")
    q, r, t = acoustic_blocks(voigt)
    c, s = np.cos(w)[..., None, None], np.sin(w)[..., None, None]
    return c * c * q + c * s * (r + r.T) + s * s * t


def wave_speeds(voigt: ArrayLike, density: float, angle: ArrayLike) -> Floats:
    """Phase speeds of the quasi-longitudinal and quasi-transverse wave.

    Parameters
    ----------
    voigt : array_like, (3, 3)
        Positive definite stiffness, Pa.
    density : float
        kg/m^3.
    angle : array_like
        Direction of propagation from axis 1, radians.

    Returns
    -------
    ndarray, (..., 2)
        The faster, then the slower speed, m/s.

    Raises
    ------
    ValueError
        If the tensor is not positive definite, the density not positive, an angle not finite.
    """
    if not (np.isfinite(density) and density > 0.0):
        raise ValueError("the mass density must be positive and finite")
    gamma = christoffel_tensor(voigt, angle)
    return np.sqrt(np.linalg.eigvalsh(gamma)[..., ::-1] / density)


def polarisations(voigt: ArrayLike, angle: ArrayLike) -> Floats:
    """Unit displacement directions of the two waves, (..., 2, 2): [..., :, k] goes with speed k."""
    return np.linalg.eigh(christoffel_tensor(voigt, angle))[1][..., ::-1]
