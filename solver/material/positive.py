"""Non-negative moduli with exact moments, as close as can be to a smooth law.

minimise |x − x₀|² subject to A x = d and x ≥ 0: strictly convex, a hundred unknowns and, at long
horizons, thousands, and wanted to machine precision, which general solvers do not give. SciPy's
non-negative least squares says whether a solution exists. The conditions are few: their multipliers
λ, of which x = max(0, x₀ + Aᵀ λ), say from which active set to start; the active set is then
finished by exact steps on the optimality conditions.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import nnls

from ..arrays import Array
from ..errors import CalibrationError

_FEASIBLE = 1e-9
# Steps of Newton's method for the multipliers, share of the moments that is left after them, and
# what keeps a step finite while too few entries are positive.
_STEPS, _LEFT, _FLAT = 100, 1e-9, 1e-10


def _least_squares(matrix: Array, target: Array) -> tuple[Array, float]:
    """x ≥ 0 nearest to ``matrix @ x == target``, and what is left.

    Raises
    ------
    CalibrationError
        If the search does not end, as with tensors whose entries are many orders apart.
    """
    try:
        found, residual = nnls(matrix, target, maxiter=50 * matrix.shape[1])
    except RuntimeError as error:
        raise CalibrationError(
            "the search for non-negative bond moduli does not end: the tensor's entries, or the "
            "moments of this family, are too many orders apart; take calibration='lattice'"
        ) from error
    return found, float(residual)


def feasible(moments: Array, target: Array) -> bool:
    """Whether some x ≥ 0 has ``moments @ x == target`` (shapes (k, n), (k,))."""
    scale = np.linalg.norm(target)
    residual = _least_squares(moments, target)[1]
    return bool(residual <= _FEASIBLE * scale)


def closest(moments: Array, target: Array, wanted: Array) -> Array | None:
    """Point of {x ≥ 0, moments x = target} nearest to `wanted`; None if that set is empty.

    Parameters
    ----------
    moments : ndarray, shape (k, n)
    target : ndarray, shape (k,)
    wanted : ndarray, shape (n,)

    Returns
    -------
    ndarray, shape (n,), or None
        Satisfies the moments to rounding; entries that are not positive are exactly zero.
    """
    rows = np.linalg.norm(moments, axis=1)
    keep = rows > 0
    a, d = moments[keep] / rows[keep, None], target[keep] / rows[keep]
    if not feasible(a, d):
        return None
    size = len(wanted)
    start = _by_multipliers(a, d, wanted)
    if start is None:
        # On the very edge of what is possible there are no finite ones.
        stiff = 1e5
        start = _least_squares(
            np.vstack([stiff * a, np.eye(size)]), np.concatenate([stiff * d, wanted])
        )[0]
    free = start > 0
    scale = max(np.abs(wanted).max(), start.max())
    for _ in range(20 * size):
        part = a[:, free]
        multiplier = np.linalg.lstsq(part @ part.T, d - part @ wanted[free], rcond=1e-13)[0]
        x = np.zeros(size)
        x[free] = wanted[free] + part.T @ multiplier
        if x.min() < -1e-14 * scale:
            # The most negative first: dropping all at once may lose feasibility.
            free[np.argmin(x)] = False
            continue
        # A zero entry wants in where the unconstrained optimum would make it positive.
        gain = np.where(free, -np.inf, wanted + a.T @ multiplier)
        if gain.max() > 1e-12 * scale:
            free[np.argmax(gain)] = True
            continue
        break
    else:
        # Moments on the very edge of what is possible leave the multipliers undetermined, and
        # the exchange goes round in circles: keep the starting point, close to the optimum.
        x = start
    # Corrections on the support take the moments to rounding. Entries of rounding size are zeros:
    # corrected, they could turn negative.
    for _ in range(size):
        x = np.where(x > 1e-12 * scale, x, 0.0)
        support = x > 0
        part = a[:, support]
        x[support] += np.linalg.lstsq(part, d - part @ x[support], rcond=1e-13)[0]
        if x.min() >= 0:
            break
    if np.abs(a @ x - d).max() > 1e-10 * np.abs(d).max() or x.min() < 0:
        return None
    return x


def _by_multipliers(a: Array, d: Array, wanted: Array) -> Array | None:
    """max(0, wanted + aᵀ λ) with the moments d, nearly; None if the search for λ does not end.

    The dual, d·λ − ½|max(0, wanted + aᵀ λ)|², is concave in a few unknowns, and its gradient is
    what the moments lack: Newton's method, each step as long as it climbs.
    """
    multiplier = np.zeros(len(d))
    x = np.maximum(wanted, 0.0)
    height = -0.5 * float(x @ x)
    for _ in range(_STEPS):
        gap = d - a @ x
        if np.abs(gap).max() <= _LEFT * np.abs(d).max():
            return x
        part = a[:, x > 0]
        slope = part @ part.T + _FLAT * np.eye(len(d))
        step = np.linalg.solve(slope, gap)
        share, least = 1.0, 1e-4 * float(gap @ step)
        while True:
            tried = np.maximum(wanted + a.T @ (multiplier + share * step), 0.0)
            reached = float(d @ (multiplier + share * step)) - 0.5 * float(tried @ tried)
            if reached >= height + share * least - 1e-14 * abs(height):
                break
            share *= 0.5
            if share < 1e-9:
                return None
        multiplier, x, height = multiplier + share * step, tried, reached
    return None
