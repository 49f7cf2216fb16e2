"""Static and steady solutions: the method follows the sign of the operator.

positive, central (no rotations)
    Conjugate gradients (SciPy) with the two-level preconditioner. A direction of non-positive
    energy, as a damaged body may have, ends the solve with a named error.
indefinite (negative shear stiffness, positive condensed symbol)
    A saddle in the rotations, solved by the same method on the displacements alone, rotations
    condensed out matrix-free, preconditioned by a positive companion body. MINRES on the whole
    saddle would take about as long, but could not notice what a bounded or damaged body may
    have although its bulk has not: a direction of negative condensed energy.

BLAS reductions change in the last bits with its thread count, so BLAS is pinned to one thread
here; the kernels themselves do not depend on theirs.
"""

from __future__ import annotations

import sys
from time import perf_counter
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator
from threadpoolctl import threadpool_limits

from ..errors import ConvergenceError
from ..linear.krylov import Task, condensed_gradients, conjugate_gradients
from ..linear.two_level import BlockJacobi, TwoLevel
from ..operators.bond_operator import BondOperator
from ..scene import Discretisation
from ..solution import Solution, Statistics

Array = NDArray[np.float64]
Preconditioner = Literal["auto", "two-level", "block-jacobi"]

# Below this many unknowns block Jacobi needs less time than the set-up of two levels.
_TWO_LEVEL = 2_000


def preconditioner(
    operator: BondOperator, sign: str, choice: Preconditioner, previous: Solution | None = None
) -> LinearOperator:
    """The preconditioner of a body: two-level, or block Jacobi where that is cheaper.

    Raises
    ------
    ValueError
        If `choice` is unknown.
    """
    if choice not in get_args(Preconditioner):
        raise ValueError(
            f"unknown preconditioner {choice!r}; known: {', '.join(get_args(Preconditioner))}"
        )
    small = operator.shape[0] < _TWO_LEVEL
    jacobi = choice == "block-jacobi" or (choice == "auto" and small)
    positive = operator.companion() if sign == "indefinite" else operator
    if jacobi:
        return BlockJacobi(positive)
    earlier = None if previous is None else previous.preconditioner
    return earlier.updated(positive) if isinstance(earlier, TwoLevel) else TwoLevel(positive)


def solve(
    discretisation: Discretisation,
    tolerance: float = 1e-10,
    max_iterations: int = 20_000,
    preconditioning: Preconditioner = "auto",
    previous: Solution | None = None,
) -> Solution:
    """Solve K x = b for the free unknowns.

    Parameters
    ----------
    discretisation : Discretisation
    tolerance : float
        Stop at |b − K x| ≤ tolerance |b|, checked with the operator, not the recurrence.
    max_iterations : int
        Of the Krylov method, all restarts together.
    preconditioning : {"auto", "two-level", "block-jacobi"}
        ``auto`` takes two levels from 2,000 unknowns on.
    previous : Solution, optional
        Of the same body with other loads or fewer bonds: the solve starts from its fields, and
        its preconditioner is reused, brought up to date where bonds have changed.

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
    operator, sign = discretisation.operator, discretisation.stability.sign
    with threadpool_limits(limits=1, user_api="blas"):
        rhs = discretisation.right_hand_side()
        start = _start(discretisation, previous)
        x, iterations, ready = np.zeros_like(rhs), 0, perf_counter()
        m: LinearOperator | None = None
        if not rhs.any():
            method = "nothing to solve"
        else:
            m = preconditioner(operator, sign, preconditioning, previous)
            ready = perf_counter()
            task = Task(rhs, start, tolerance, max_iterations)
            name = "two-level" if isinstance(m, TwoLevel) else "block Jacobi"
            if sign == "indefinite":
                x, iterations = condensed_gradients(operator, m, task)
                method = f"CG on condensed displacements, {name}"
            else:
                x, iterations = conjugate_gradients(operator, m, task)
                method = f"CG, {name}"
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
        peak_memory=_peak_memory(),
    )
    return Solution(discretisation, discretisation.field(x), statistics, m)


def _peak_memory() -> int:
    """Peak resident memory of this process in bytes; 0 where the system does not tell."""
    try:
        import resource
    except ImportError:  # not POSIX
        return 0
    # Kilobytes, but bytes on macOS.
    unit = 1 if sys.platform == "darwin" else 1024
    return int(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit)


def _start(discretisation: Discretisation, previous: Solution | None) -> Array:
    """First guess of the active unknowns: those of an earlier solution, or zeros."""
    operator = discretisation.operator
    if previous is None or previous.unknowns.shape != discretisation.values.shape:
        return np.zeros(operator.shape[0])
    given = np.nan_to_num(previous.unknowns[:, operator.active])
    if operator.fixed is not None:
        values = discretisation.values[:, operator.active]
        given = np.where(operator.fixed, values, given)
    return given.ravel()


def _residual(operator: BondOperator, x: Array, rhs: Array) -> float:
    size = float(np.linalg.norm(rhs))
    return float(np.linalg.norm(rhs - operator.matvec(x))) / size if size else 0.0
