"""Static and steady solutions: the method follows the sign of the operator.

positive, central (no rotations)
    Conjugate gradients (SciPy) with the two-level preconditioner. A direction of non-positive
    energy, as a damaged body may have, ends the solve with a named error.
indefinite (negative shear stiffness, positive condensed symbol)
    A saddle in the rotations. Sparse factorisation for small bodies, MINRES with the two-level
    preconditioner of a positive companion body for large ones (condensing the rotations needs
    an inner solve in every product). A *damaged* body of this kind may have lost the positive
    condensed energy of its bulk, which only conjugate gradients on the condensed displacements
    notice: it is solved that way.

BLAS reductions change in the last bits with its thread count, so BLAS is pinned to one thread
here; the kernels themselves do not depend on theirs.
"""

from __future__ import annotations

import resource
import sys
from time import perf_counter
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, cg, minres, splu
from threadpoolctl import threadpool_limits

from .condensed import Condensed
from .errors import ConvergenceError, NegativeCurvatureError
from .micromoduli import ElasticModuli
from .operators import BondOperator
from .preconditioner import BlockJacobi, TwoLevel
from .scene import Discretisation
from .solution import Solution, Statistics

Array = NDArray[np.float64]
Preconditioner = Literal["auto", "two-level", "block-jacobi"]

# Largest saddle point that is factorised; beyond this MINRES is faster and far smaller.
_FACTORISE = 3_000
# Below this many unknowns block Jacobi needs less time than the set-up of two levels.
_TWO_LEVEL = 2_000
# getrusage counts kilobytes, but bytes on macOS.
_RSS_UNIT = 1 if sys.platform == "darwin" else 1024
# Krylov recurrences drift from the true residual: restarts from the current solution repair it.
_RESTARTS = 6


class _Guarded(LinearOperator):
    """The operator, watching for directions of non-positive energy."""

    def __init__(self, operator: LinearOperator) -> None:
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


def companion(operator: BondOperator) -> BondOperator:
    """The same body with every negative modulus turned positive.

    Its symbol is equivalent to the absolute value of the indefinite one, wave by wave, so that a
    preconditioner built on it leaves eigenvalues in two fixed intervals, whatever the spacing.
    """
    moduli = operator.moduli
    assert isinstance(moduli, ElasticModuli)
    positive = ElasticModuli(np.abs(moduli.normal), np.abs(moduli.shear))
    return operator.with_moduli(positive)


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
    if jacobi:
        return BlockJacobi(operator, absolute=sign == "indefinite")
    positive = companion(operator) if sign == "indefinite" else operator
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
        small = operator.shape[0] <= _FACTORISE
        if not rhs.any():
            method = "nothing to solve"
        elif sign == "indefinite" and small and not discretisation.damaged:
            method = "sparse LU"
            x, iterations = _factorise(operator, rhs, tolerance)
        else:
            m = preconditioner(operator, sign, preconditioning, previous)
            ready = perf_counter()
            name = "two-level" if isinstance(m, TwoLevel) else "block Jacobi"
            krylov, label = _conjugate_gradients, "CG"
            if sign == "indefinite":
                krylov, label = _minres, "MINRES"
                if discretisation.damaged:
                    krylov, label = _condensed, "CG on condensed displacements"
            method = f"{label}, {name}"
            x, iterations = krylov(operator, m, rhs, start, tolerance, max_iterations)
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
        peak_memory=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * _RSS_UNIT,
    )
    return Solution(discretisation, discretisation.field(x), statistics, m)


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


class _Counter:
    """Counts iterations as SciPy's callback."""

    def __init__(self) -> None:
        self.count = 0

    def __call__(self, _: Array) -> None:
        self.count += 1


def _conjugate_gradients(
    operator: LinearOperator,
    m: LinearOperator,
    rhs: Array,
    start: Array,
    tolerance: float,
    limit: int,
) -> tuple[Array, int]:
    guarded = _Guarded(operator)
    counter, x = _Counter(), start.copy()
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
            M=m,
            callback=counter,
        )
        x = x + step
    return x, counter.count


def _minres(
    operator: BondOperator,
    m: LinearOperator,
    rhs: Array,
    start: Array,
    tolerance: float,
    limit: int,
) -> tuple[Array, int]:
    counter, x = _Counter(), start.copy()
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
            M=m,
            callback=counter,
        )
        x = x + step
    return x, counter.count


def _condensed(
    operator: BondOperator,
    m: LinearOperator,
    rhs: Array,
    start: Array,
    tolerance: float,
    limit: int,
) -> tuple[Array, int]:
    condensed = Condensed(operator)
    u, count = _conjugate_gradients(
        condensed,
        condensed.preconditioner(m),
        condensed.condense(rhs),
        start.reshape(3, -1)[:2].ravel(),
        0.1 * tolerance,
        limit,
    )
    return condensed.expand(u, rhs), count


def _factorise(operator: BondOperator, rhs: Array, tolerance: float) -> tuple[Array, int]:
    factors = splu(operator.to_csr().tocsc())
    x = factors.solve(rhs)
    for step in range(1, _RESTARTS):
        defect = rhs - operator.matvec(x)
        if np.linalg.norm(defect) <= 0.1 * tolerance * np.linalg.norm(rhs):
            return x, step
        x = x + factors.solve(defect)
    return x, _RESTARTS
