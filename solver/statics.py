"""Static and steady solutions: the method follows the sign of the operator.

positive, central (no rotations)
    Conjugate gradients (SciPy) with a block-Jacobi preconditioner. A direction of non-positive
    energy, as a damaged body may have, ends the solve with a named error.
indefinite (negative shear stiffness, positive condensed symbol)
    A saddle in the rotations. Sparse factorisation for small bodies, MINRES with the absolute
    value of the diagonal blocks for large ones.

BLAS reductions change in the last bits with its thread count, so BLAS is pinned to one thread
here; the kernels themselves do not depend on theirs.
"""

from __future__ import annotations

from time import perf_counter

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, cg, minres, splu
from threadpoolctl import threadpool_limits

from .errors import ConvergenceError, NegativeCurvatureError
from .operators import BondOperator
from .scene import Discretisation
from .solution import Solution, Statistics

Array = NDArray[np.float64]

# Largest saddle point that is factorised; fill grows with the horizon, and beyond this MINRES
# is faster and far smaller.
_FACTORISE = 15_000
# Krylov recurrences drift from the true residual: restarts from the current solution repair it.
_RESTARTS = 6


class _Guarded(LinearOperator):
    """The operator, watching for directions of non-positive energy."""

    def __init__(self, operator: BondOperator) -> None:
        super().__init__(operator.dtype, operator.shape)
        self.operator = operator

    def _matvec(self, x: Array) -> Array:
        y = self.operator.matvec(x)
        energy = float(x @ y)
        if energy <= 0.0 and float(x @ x) > 0.0:
            raise NegativeCurvatureError(
                f"the body has a direction of non-positive energy (x·Kx = {energy:.3g}): damage "
                f"or a cut family has taken more stiffness than the bulk can spare. Use "
                f"calibration='positive', another m, or hold the loose part"
            )
        return y


def block_jacobi(operator: BondOperator, absolute: bool = False) -> LinearOperator:
    """Inverse of the diagonal blocks, or of their absolute values (for MINRES).

    Raises
    ------
    NegativeCurvatureError
        If a block is not positive definite and `absolute` is not asked for.
    """
    values, vectors = np.linalg.eigh(operator.block_diagonal)
    smallest = values[:, 0] / np.abs(values).max()
    if not absolute and smallest.min() <= 1e-13:
        particle = operator.active[np.argmin(smallest)]
        x, y = operator.bonds.lattice.points[particle]
        raise NegativeCurvatureError(
            f"the particle at ({x:.4g}, {y:.4g}) is a mechanism: the stiffness of its own bonds "
            f"is singular or negative (too few bonds are left). Hold it or remove it"
        )
    values = np.abs(values)
    # einsum keeps a fixed order of sums, whatever BLAS does.
    inverse = np.einsum("pij,pj,pkj->ikp", vectors, 1.0 / values, vectors)
    c = operator.components

    def apply(x: Array) -> Array:
        r = x.reshape(c, -1)
        out = np.empty_like(r)
        for i in range(c):
            out[i] = inverse[i, 0] * r[0]
            for k in range(1, c):
                out[i] += inverse[i, k] * r[k]
        return out.ravel()

    return LinearOperator(operator.shape, matvec=apply, dtype=np.float64)


def solve(
    discretisation: Discretisation, tolerance: float = 1e-10, max_iterations: int = 20_000
) -> Solution:
    """Solve K x = b for the free unknowns.

    Parameters
    ----------
    discretisation : Discretisation
    tolerance : float
        Stop at |b − K x| ≤ tolerance |b|, checked with the operator, not the recurrence.
    max_iterations : int
        Of the Krylov method, all restarts together.

    Returns
    -------
    Solution

    Raises
    ------
    ValueError
        If the tolerance is not in (0, 1).
    NegativeCurvatureError
        If a body taken to be positive is not.
    ConvergenceError
        If the tolerance is not reached.
    """
    if not 0 < tolerance < 1:
        raise ValueError(f"the tolerance must lie between 0 and 1, not {tolerance}")
    begun = perf_counter()
    operator = discretisation.operator
    with threadpool_limits(limits=1, user_api="blas"):
        rhs = discretisation.right_hand_side()
        ready = perf_counter()
        if not rhs.any():
            x, iterations, method = np.zeros_like(rhs), 0, "nothing to solve"
        elif discretisation.stability.sign != "indefinite":
            x, iterations = _conjugate_gradients(operator, rhs, tolerance, max_iterations)
            method = "CG, block Jacobi"
        elif operator.shape[0] <= _FACTORISE:
            x, iterations = _factorise(operator, rhs, tolerance)
            method = "sparse LU"
        else:
            x, iterations = _minres(operator, rhs, tolerance, max_iterations)
            method = "MINRES, block Jacobi"
        residual = _residual(operator, x, rhs)
    if not residual <= tolerance:
        raise ConvergenceError(
            f"{method} stopped at a relative residual of {residual:.2e} after {iterations} "
            f"iterations; {tolerance:.1e} was asked for"
        )
    statistics = Statistics(
        particles=discretisation.lattice.count,
        unknowns=operator.shape[0] if operator.fixed is None else int((~operator.fixed).sum()),
        bonds=operator.directed_bonds,
        method=method,
        sign=discretisation.stability.sign,
        margin=discretisation.stability.margin,
        iterations=iterations,
        residual=residual,
        setup_seconds=discretisation.seconds + (ready - begun),
        solve_seconds=perf_counter() - ready,
    )
    return Solution(discretisation, discretisation.field(x), statistics)


def _residual(operator: BondOperator, x: Array, rhs: Array) -> float:
    size = float(np.linalg.norm(rhs))
    return float(np.linalg.norm(rhs - operator.matvec(x))) / size if size else 0.0


class _Counter:
    """Counts iterations as SciPy's callback."""

    def __init__(self) -> None:
        self.count = 0

    def __call__(self, _: Array) -> None:
        self.count += 1


def _conjugate_gradients(
    operator: BondOperator, rhs: Array, tolerance: float, limit: int
) -> tuple[Array, int]:
    guarded, preconditioner = _Guarded(operator), block_jacobi(operator)
    counter, x = _Counter(), np.zeros_like(rhs)
    for _ in range(_RESTARTS):
        # Solve for the correction: its residual is small, so nothing is lost to cancellation.
        defect = rhs - operator.matvec(x)
        size = float(np.linalg.norm(defect) / np.linalg.norm(rhs))
        left = limit - counter.count
        if size <= tolerance or left <= 0:
            break
        step, _info = cg(
            guarded,
            defect,
            rtol=0.5 * tolerance / size,
            atol=0.0,
            maxiter=left,
            M=preconditioner,
            callback=counter,
        )
        x = x + step
    return x, counter.count


def _minres(operator: BondOperator, rhs: Array, tolerance: float, limit: int) -> tuple[Array, int]:
    preconditioner = block_jacobi(operator, absolute=True)
    counter, x = _Counter(), np.zeros_like(rhs)
    for _ in range(4 * _RESTARTS):
        defect = rhs - operator.matvec(x)
        size = float(np.linalg.norm(defect) / np.linalg.norm(rhs))
        left = limit - counter.count
        if size <= tolerance or left <= 0:
            break
        # SciPy measures the residual against |A||x|, which is larger: ask for less each time.
        step, _info = minres(
            operator,
            defect,
            rtol=max(1e-3 * tolerance / size, 1e-12),
            maxiter=left,
            M=preconditioner,
            callback=counter,
        )
        x = x + step
    return x, counter.count


def _factorise(operator: BondOperator, rhs: Array, tolerance: float) -> tuple[Array, int]:
    factors = splu(operator.to_csr().tocsc())
    x = factors.solve(rhs)
    for step in range(1, _RESTARTS):
        defect = rhs - operator.matvec(x)
        if np.linalg.norm(defect) <= 0.1 * tolerance * np.linalg.norm(rhs):
            return x, step
        x = x + factors.solve(defect)
    return x, _RESTARTS
