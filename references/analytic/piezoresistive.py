"""Conductivity of a continuum whose directions conduct by their stretch (no lattice, no solver).

A direction ψ conducts with k(ψ), D = (1/π) ∫ k n nᵀ dψ over the circle, and under a strain with
k f(s), s = n·ε·n. Angular means of smooth periodic functions are those of equally spaced angles.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from references.analytic.conduction import checked_conductivity

__all__ = ["angular_conductivity", "factor", "strained_conductivity"]

_ANGLES = 192


def angular_conductivity(
    conductivity: ArrayLike, exponent: int
) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    """k(ψ) = k2 + (k1 − k2) cosⁿ(ψ − ζ) with the moments of a tensor, ζ its better axis.

    Parameters
    ----------
    conductivity : (2, 2) array_like
        S/m; symmetric positive definite.
    exponent : int
        n, even.

    Raises
    ------
    ValueError
        If the exponent is odd or not positive.
    """
    if exponent < 2 or exponent % 2:
        raise ValueError(f"the exponent must be even and positive, not {exponent}")
    tensor = checked_conductivity(conductivity)
    values, axes = np.linalg.eigh(tensor)
    zeta = np.arctan2(axes[1, 1], axes[0, 1])
    psi = 2 * np.pi * np.arange(_ANGLES) / _ANGLES
    power = np.cos(psi) ** exponent
    # Moments along the axis and across it of cosⁿ and of what is left of one.
    moments = np.array(
        [[2 * np.mean(p * np.cos(psi) ** 2), 2 * np.mean(p * np.sin(psi) ** 2)]
         for p in (power, 1 - power)]
    ).T  # fmt: skip
    k1, k2 = np.linalg.solve(moments, values[::-1])

    def of(angle: NDArray[np.float64]) -> NDArray[np.float64]:
        found: NDArray[np.float64] = k2 + (k1 - k2) * np.cos(angle - zeta) ** exponent
        return found

    return of


def factor(
    stretch: NDArray[np.float64], gauge: float, resistive: bool = False, actual: bool = False
) -> NDArray[np.float64]:
    """What k is multiplied by at a stretch: conductivity or resistivity linear, which length."""
    change = 1.0 + gauge * stretch
    found = 1.0 / change if resistive else change
    return np.asarray(found / (1.0 + stretch) ** 2 if actual else found)


def strained_conductivity(
    conductivity: ArrayLike,
    strain: ArrayLike,
    gauge: float,
    exponent: int = 2,
    resistive: bool = False,
    actual: bool = False,
) -> NDArray[np.float64]:
    """D under strains.

    Parameters
    ----------
    conductivity : (2, 2) array_like
        Without strain, S/m.
    strain : (3, ...) array_like
        ε11, ε22, 2 ε12.
    gauge : float
        Relative change of k (or 1/k) per stretch.
    exponent : int
        Of k(ψ).
    resistive, actual : bool
        As `factor`.

    Returns
    -------
    (2, 2, ...) float array

    Examples
    --------
    >>> d = strained_conductivity([[2, 0], [0, 2]], [1e-3, 0, 0], 4.0)
    >>> [f"{x:.3f}" for x in (d[0, 0], d[1, 1])]
    ['2.006', '2.002']
    """
    psi = 2 * np.pi * np.arange(_ANGLES) / _ANGLES
    k = angular_conductivity(conductivity, exponent)(psi)
    given = np.asarray(strain, dtype=float)
    n = np.array([np.cos(psi), np.sin(psi)])
    rows = np.array([n[0] ** 2, n[1] ** 2, n[0] * n[1]])
    result = np.zeros((2, 2, *given.shape[1:]))
    for a in range(_ANGLES):
        stretch = np.tensordot(rows[:, a], given, axes=1)
        share = 2.0 / _ANGLES * k[a] * factor(stretch, gauge, resistive, actual)
        for i in (0, 1):
            for j in (0, 1):
                result[i, j] += share * n[i, a] * n[j, a]
    return result
