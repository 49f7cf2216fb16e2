"""Observed order, fitted order, Richardson extrapolation and the grid convergence index.

After Roache (1994) and Celik et al. (2008), *Procedure for estimation and reporting of
uncertainty due to discretization*. Grids are given by a size h (spacing or mesh size), errors
and values in the same order.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike


def observed_orders(h: ArrayLike, errors: ArrayLike) -> np.ndarray:
    """Order between neighbouring grids, ``log(e1/e2) / log(h1/h2)``.

    Parameters
    ----------
    h : (M,) grid sizes, coarse to fine
    errors : (M,) errors against an exact solution

    Returns
    -------
    (M-1,) array; NaN where an error is zero or not a number

    Raises
    ------
    ValueError
        If sizes are not positive and strictly decreasing, or lengths differ.
    """
    h, e = _grids(h, errors)
    with np.errstate(divide="ignore", invalid="ignore"):
        orders = np.log(e[:-1] / e[1:]) / np.log(h[:-1] / h[1:])
    return np.where(np.isfinite(orders), orders, np.nan)


@dataclass(frozen=True)
class Fit:
    """Error model ``constant * h**order`` with the rms residual of log10(error)."""

    order: float
    constant: float
    residual: float

    def __call__(self, h: ArrayLike) -> np.ndarray:
        """The fitted error at sizes h."""
        return self.constant * np.asarray(h, dtype=float) ** self.order


def fitted_order(h: ArrayLike, errors: ArrayLike, floor: float = 0.0) -> Fit | None:
    """Least-squares order over all grids whose error lies above a noise floor.

    Returns
    -------
    Fit, or None if fewer than two finite errors lie above `floor`
    """
    h, e = _grids(h, errors)
    keep = np.isfinite(e) & (e > floor)
    if keep.sum() < 2:
        return None
    x, y = np.log10(h[keep]), np.log10(e[keep])
    slope, intercept = np.polyfit(x, y, 1)
    residual = float(np.sqrt(np.mean((slope * x + intercept - y) ** 2)))
    return Fit(float(slope), float(10.0**intercept), residual)


@dataclass(frozen=True)
class Extrapolation:
    """Richardson's estimate from three grids.

    Attributes
    ----------
    value : estimate on an infinitely fine grid
    order : observed order, without knowledge of the exact value
    error : relative difference of the finest value from the estimate
    """

    value: float
    order: float
    error: float


def richardson(h: ArrayLike, values: ArrayLike) -> Extrapolation:
    """Extrapolate three values to h = 0 with the order that they themselves show.

    Solves ``(f3 - f2)/(f2 - f1) = (h3^p - h2^p)/(h2^p - h1^p)`` for p, whatever the refinement
    ratios, then ``f = f1 + (f1 - f2) h1^p / (h2^p - h1^p)``; 1 is the finest grid.

    Raises
    ------
    ValueError
        If there are not three grids, or the values do not converge monotonically: then there is
        no order to observe.
    """
    h, f = _grids(h, values)
    if h.size != 3:
        raise ValueError(f"Richardson extrapolation takes three grids, not {h.size}")
    coarse, fine = f[0] - f[1], f[1] - f[2]
    if fine == 0.0 or coarse / fine <= 0.0:
        raise ValueError("values do not converge monotonically: no order can be observed")
    ratio = coarse / fine

    from scipy.optimize import brentq  # not at the top: listing cases is to stay light

    def mismatch(p: float) -> float:
        return (h[0] ** p - h[1] ** p) / (h[1] ** p - h[2] ** p) - ratio

    low, high = 1e-3, 20.0
    if mismatch(low) * mismatch(high) > 0.0:
        raise ValueError(f"no order between {low} and {high} explains the ratio {ratio:.4g}")
    p = float(brentq(mismatch, low, high, xtol=1e-12))
    value = f[2] - fine * h[2] ** p / (h[1] ** p - h[2] ** p)
    error = abs(f[2] - value) / abs(value) if value != 0.0 else float("nan")
    return Extrapolation(float(value), p, float(error))


def grid_convergence_index(
    fine: float, coarse: float, ratio: float, order: float, safety: float = 1.25
) -> float:
    """Relative uncertainty of the fine value, ``Fs |(f2 - f1)/f1| / (r^p - 1)``.

    Parameters
    ----------
    fine, coarse : values on the two grids
    ratio : refinement ratio h_coarse/h_fine > 1
    order : observed or formal order, positive
    safety : 1.25 with an observed order from three grids, 3 for two grids (Roache)
    """
    if ratio <= 1.0 or order <= 0.0:
        raise ValueError(f"need ratio > 1 and order > 0, not {ratio} and {order}")
    if fine == 0.0:
        raise ValueError("a relative index needs a value that is not zero")
    return safety * abs((coarse - fine) / fine) / (ratio**order - 1.0)


def _grids(h: ArrayLike, values: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    sizes, data = np.asarray(h, dtype=float), np.asarray(values, dtype=float)
    if sizes.ndim != 1 or sizes.shape != data.shape:
        raise ValueError(f"sizes {sizes.shape} and values {data.shape} must be equal vectors")
    if np.any(sizes <= 0.0) or np.any(np.diff(sizes) >= 0.0):
        raise ValueError("grid sizes must be positive and strictly decreasing")
    return sizes, data
