"""Fracture energy of bonds broken by a straight cut, by quadrature of Eq. 92 as it stands.

A bond through the cut plane starts at a distance z behind it and ends in front of it. Summed over
all of them the critical energies w_c(psi) of the bonds give the energy per unit of cut area.
V. Diana, *Anisotropic Continuum-Molecular Models*, Arch. Comput. Methods Eng. (2022), Sect. 3.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import beta

from references.analytic.quadrature import gauss
from references.analytic.voigt import Floats


def fracture_energy(
    critical: Callable[[Floats], Floats], horizon: float, thickness: float = 1.0, points: int = 96
) -> float:
    """Eq. 92 by Gauss quadrature over all three variables, in the printed order.

    Parameters
    ----------
    critical : callable
        w_c(psi) of bond directions from the cut's normal (rad), J/m^6.
    horizon, thickness : float
        m.
    points : int
        Gauss points a variable; the integrand is smooth in the variables used.

    Returns
    -------
    float
        J/m^2.

    Raises
    ------
    ValueError
        If horizon or thickness is not positive.
    """
    if not (horizon > 0 and thickness > 0):
        raise ValueError("a cut needs a positive horizon and thickness")
    node, weight = gauss(points)
    node, weight = (node + 1) / 2, weight / 2
    # z = horizon t^2 and xi = z + (horizon - z) s^2: the limit arccos(z/xi) is smooth in s, t.
    z, dz = horizon * node**2, 2 * horizon * node * weight
    xi = z[:, None] + (horizon - z[:, None]) * node**2
    dxi = 2 * (horizon - z[:, None]) * node * weight
    limit = np.arccos(np.minimum(z[:, None] / xi, 1.0))
    psi = limit[..., None] * (2 * node - 1)
    inner = (critical(psi) * (2 * limit[..., None] * weight)).sum(axis=-1)
    return float(thickness * np.sum(dz[:, None] * dxi * xi * inner))


class CriticalEnergies(NamedTuple):
    """w_c1 and w_c2, J/m^6."""

    along: float
    across: float


def two_lobe_constants(
    across_fibres: float, along_fibres: float, n: int, horizon: float, thickness: float = 1.0
) -> CriticalEnergies:
    """Constants of Eq. 93 for any even n, by beta functions (Eqs. 97-99 for n = 2, 4, 8).

    Parameters
    ----------
    across_fibres, along_fibres : float
        Fracture energies of cuts normal to and along the axis (zeta = 0 and pi/2), J/m^2.
    n : int
        Even exponent.
    horizon, thickness : float
        m.

    Raises
    ------
    ValueError
        If n is not even and positive.
    """
    if n < 2 or n % 2:
        raise ValueError("the exponent must be even and positive")
    scale = thickness * horizon**3 / 3
    # int cos^(n+1) and int sin^n cos over the half circle
    crossed, aligned = beta(0.5, n / 2 + 1), 2 / (n + 1)
    matrix = scale * np.array([[crossed, 2 - crossed], [aligned, 2 - aligned]])
    return CriticalEnergies(*map(float, np.linalg.solve(matrix, [across_fibres, along_fibres])))


def fourfold_constants(
    aligned: float, diagonal: float, horizon: float, thickness: float = 1.0
) -> CriticalEnergies:
    """Constants of Eq. 101 for n = 4, by Eq. 103: cuts at zeta = 0 and at zeta = pi/4."""
    scale = 14 * thickness * horizon**3
    return CriticalEnergies(
        (208 * diagonal - 187 * aligned) / scale, (128 * aligned - 107 * diagonal) / scale
    )


def effective_energy(
    critical: Callable[[Floats], Floats], zeta: ArrayLike, horizon: float, points: int = 96
) -> Floats:
    """G of a cut normal to axis 1 when the law is turned by each zeta (Figs. 16-18).

    Eq. 92 collapses to h delta^3/3 int w_c(psi - zeta) cos(psi) dpsi over the half circle (proved
    in the errata), taken by Gauss quadrature; unit thickness.

    Returns
    -------
    ndarray, one value for each zeta, J/m^2
    """
    node, weight = gauss(points)
    psi = 0.5 * np.pi * node
    angles = np.atleast_1d(np.asarray(zeta, dtype=float))
    values = critical(psi - angles[:, None])
    return horizon**3 / 3 * (values @ (0.5 * np.pi * weight * np.cos(psi)))
