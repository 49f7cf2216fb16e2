"""Plane elastic tensors as 3x3 Voigt matrices: checks, turned axes, strains.

Order 11, 22, 12 with engineering shear (the third strain is 2 eps12), so that stress = voigt @
strain.  Everything in `references.analytic` takes tensors in this form.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


def checked_voigt(voigt: ArrayLike) -> Floats:
    """The tensor as a symmetric float array, once it is known to be an elastic tensor.

    Parameters
    ----------
    voigt : array_like, (3, 3)
        Stiffness in Pa (any unit will do), engineering shear.

    Raises
    ------
    ValueError
        If the array is not 3x3, holds NaN or infinity, is not symmetric (1e-8 relative), or is
        not positive definite: then some strain would store no energy and none of the closed
        forms holds.
    """
    tensor = np.asarray(voigt, dtype=float)
    if tensor.shape != (3, 3):
        raise ValueError(f"an elastic tensor is a 3x3 Voigt matrix, not an array {tensor.shape}")
    if not np.all(np.isfinite(tensor)):
        raise ValueError("the elastic tensor holds NaN or infinite moduli")
    if np.max(np.abs(tensor - tensor.T)) > 1e-8 * np.max(np.abs(tensor)):
        raise ValueError("the elastic tensor is not symmetric")
    tensor = 0.5 * (tensor + tensor.T)
    # Scaled to a unit diagonal first: the test must not depend on how stiff one axis is.
    diagonal = np.diag(tensor)
    if np.any(diagonal <= 0.0):
        raise ValueError("the elastic tensor is not positive definite: a modulus Cii is <= 0")
    scale = 1.0 / np.sqrt(diagonal)
    smallest = float(np.linalg.eigvalsh(tensor * np.outer(scale, scale))[0])
    if smallest < 1e-14:
        raise ValueError(
            "the elastic tensor is not positive definite (smallest eigenvalue, at unit diagonal, "
            f"{smallest:.3g})"
        )
    return tensor


def turned_axes(voigt: ArrayLike, angle: float) -> Floats:
    """Components of the same stiffness along axes turned anticlockwise by `angle` (Eqs. 43, 45).

    A material whose own axes stand at `angle` and whose components there are `own` has
    `turned_axes(own, -angle)` along the reference axes.

    Parameters
    ----------
    voigt : array_like, (3, 3)
    angle : float
        Radians.

    Returns
    -------
    ndarray, (3, 3)
    """
    if not np.isfinite(angle):
        raise ValueError("the angle of the axes is not finite")
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array(
        [[c * c, s * s, 2 * c * s], [s * s, c * c, -2 * c * s], [-c * s, c * s, c * c - s * s]]
    )
    return turn @ np.asarray(voigt, dtype=float) @ turn.T


def checked_points(x: ArrayLike, y: ArrayLike) -> tuple[Floats, Floats]:
    """Coordinates as float arrays of one shape; ValueError if one of them is not finite."""
    xs, ys = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
    if not (np.all(np.isfinite(xs)) and np.all(np.isfinite(ys))):
        raise ValueError("a coordinate is NaN or infinite")
    return xs, ys


def strain_of_gradient(gradient: ArrayLike) -> Floats:
    """Voigt strain (..., 3) of a displacement gradient (..., 2, 2) with entries u_i,j."""
    g = np.asarray(gradient, dtype=float)
    return np.stack([g[..., 0, 0], g[..., 1, 1], g[..., 0, 1] + g[..., 1, 0]], axis=-1)


def isotropic_voigt(young: float, poisson: float, plane: str = "stress") -> Floats:
    """Isotropic stiffness in plane stress or plane strain.

    Parameters
    ----------
    young : float
        Young's modulus, Pa.
    poisson : float
        Poisson's ratio of the solid.
    plane : {"stress", "strain"}

    Raises
    ------
    ValueError
        If `plane` is another word or the moduli do not make a stable solid.
    """
    if plane not in ("stress", "strain"):
        raise ValueError(f"plane must be 'stress' or 'strain', not {plane!r}")
    if not (np.isfinite(young) and young > 0.0 and -1.0 < poisson < 0.5):
        raise ValueError("an isotropic solid needs a finite E > 0 and -1 < nu < 1/2")
    shear = young / (2 * (1 + poisson))
    axial = young / (1 - poisson**2)
    if plane == "strain":
        axial = young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))
    cross = axial - 2 * shear
    return np.array([[axial, cross, 0.0], [cross, axial, 0.0], [0.0, 0.0, shear]])
