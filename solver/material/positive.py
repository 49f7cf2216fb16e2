"""Non-negative moduli with exact moments, as close as can be to a smooth law.

minimise |x − x₀|² subject to A x = d and x ≥ 0: strictly convex, a hundred unknowns, and wanted
to machine precision, which general solvers do not give. SciPy's non-negative least squares says
whether a solution exists and from which active set to start; the active set is then finished by
exact steps on the optimality conditions.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import nnls

from ..arrays import Array
from ..errors import CalibrationError

_FEASIBLE = 1e-9


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
