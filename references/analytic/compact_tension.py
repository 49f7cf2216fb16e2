"""Stress intensity factor of the compact-tension specimen.

ASTM E399, annex A4, with the polynomial of J. E. Srawley, *Int. J. Fract.* 12 (1976) 475-476,
stated to be within 0.5 % for an isotropic body and 0.2 <= a/W < 1.  For an orthotropic specimen
it is an approximation; `references.fem` computes such cases.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from references.analytic.voigt import Floats


def shape_factor(crack_ratio: ArrayLike) -> Floats:
    """f(a/W) in K = P / (B sqrt(W)) f(a/W).

    Parameters
    ----------
    crack_ratio : array_like
        a/W, both measured from the line of the load, in [0.2, 1).

    Raises
    ------
    ValueError
        If a ratio is outside the range of the formula.
    """
    r = np.asarray(crack_ratio, dtype=float)
    if not np.all((r >= 0.2) & (r < 1.0)):
        raise ValueError("the compact-tension formula holds for 0.2 <= a/W < 1")
    polynomial = 0.886 + r * (4.64 + r * (-13.32 + r * (14.72 - 5.6 * r)))
    return np.asarray((2 + r) * polynomial / (1 - r) ** 1.5)


def stress_intensity(load: float, thickness: float, width: float, crack: ArrayLike) -> Floats:
    """Mode I stress intensity factor, Pa m^(1/2).

    Parameters
    ----------
    load : float
        P, N.
    thickness, width : float
        B and W, m.
    crack : array_like
        a, m, from the line of the load.

    Raises
    ------
    ValueError
        If the load is not finite, a dimension not positive and finite or a/W outside [0.2, 1).
    """
    if not np.isfinite(load):
        raise ValueError("the load is not finite")
    if not (0.0 < thickness < np.inf and 0.0 < width < np.inf):
        raise ValueError("the specimen's thickness and width must be positive and finite")
    factor = shape_factor(np.asarray(crack, dtype=float) / width)
    return np.asarray(load / (thickness * np.sqrt(width)) * factor)


def critical_load(toughness: float, thickness: float, width: float, crack: ArrayLike) -> Floats:
    """Load P (N) at which K reaches `toughness` (Pa m^(1/2))."""
    if not 0.0 < toughness < np.inf:
        raise ValueError("a fracture toughness is positive and finite")
    return toughness / stress_intensity(1.0, thickness, width, crack)
