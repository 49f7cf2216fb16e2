"""The method that the kind of an operator asks for, for every analysis.

positive, central (no rotations)
    Conjugate gradients (SciPy) with the two-level preconditioner. A direction of non-positive
    energy, as a damaged body may have, ends the solve with a named error.
indefinite (negative shear stiffness, positive condensed symbol)
    A saddle in the rotations, solved by the same method on the displacements alone, rotations
    condensed out matrix-free, preconditioned by a positive companion body. MINRES on the whole
    saddle would take about as long, but could not notice what a bounded or damaged body may
    have although its bulk has not: a direction of negative condensed energy.

BLAS reductions change in the last bits with its thread count: whoever calls this pins BLAS to one
thread. The kernels themselves do not depend on theirs.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Literal, get_args

import numpy as np
from scipy.sparse.linalg import LinearOperator

from ..arrays import Array
from ..operators import BondOperator
from .bordered import Border, bordered_answer
from .krylov import Answer, Task, condensed_gradients, positive_answer
from .two_level import BlockJacobi, TwoLevel, for_many

Preconditioner = Literal["auto", "two-level", "block-jacobi"]

# Roundings of a row of the product that add up in its sum.
_ROUNDINGS = 4.0
# Largest residual that rounding excuses. Inclusions 1e10, 1e11, 1e12 and 1e14 times as conductive
# as the body left 5e-4, 3e-3, 3e-2 and 0.4, and temperatures wrong by 1e-5, 5e-4, 3e-3 and 0.9.
_EXCUSED = 1e-3
# Largest entries of right-hand sides that are solved as they are.
_PLAIN = 1e-60, 1e60
# Below this many unknowns block Jacobi needs less time than the set-up of two levels.
_TWO_LEVEL = 2_000


def positive(operator: BondOperator, kind: str) -> BondOperator:
    """The operator, or its positive companion if it is indefinite."""
    return operator.companion() if kind == "indefinite" else operator


def small(operator: BondOperator) -> bool:
    """Whether block Jacobi needs less time than the set-up of two levels."""
    return bool(operator.shape[0] < _TWO_LEVEL)


def preconditioner(
    operator: BondOperator,
    kind: str,
    choice: Preconditioner = "auto",
    earlier: LinearOperator | None = None,
    often: bool = False,
) -> LinearOperator:
    """The preconditioner of a body: two-level, or block Jacobi where that is cheaper.

    Parameters
    ----------
    operator : BondOperator
    kind : str
        See `solver.material.stability.Stability`.
    choice : {"auto", "two-level", "block-jacobi"}
    earlier : LinearOperator, optional
        One of the same body before some bonds changed: a two-level one is brought up to date.
    often : bool
        Whether it is to serve many solves.

    Raises
    ------
    ValueError
        If `choice` is unknown.
    """
    if choice not in get_args(Preconditioner):
        raise ValueError(
            f"unknown preconditioner {choice!r}; known: {', '.join(get_args(Preconditioner))}"
        )
    if choice == "block-jacobi" or (choice == "auto" and small(operator)):
        return BlockJacobi(positive(operator, kind))
    if isinstance(earlier, TwoLevel):
        return earlier.updated(positive(operator, kind))
    return (for_many if often else TwoLevel)(positive(operator, kind))


def iterate(
    operator: BondOperator,
    kind: str,
    preconditioner: LinearOperator,
    task: Task,
    border: Border | None = None,
) -> tuple[Array, int]:
    """`answer` as the solution and the number of iterations."""
    found = answer(operator, kind, preconditioner, task, border)
    return found.x, found.iterations


def answer(
    operator: BondOperator,
    kind: str,
    preconditioner: LinearOperator,
    task: Task,
    border: Border | None = None,
) -> Answer:
    """Solve a task.

    With a `border` the task is that of the bordered system; the preconditioner may then be a
    `BorderedInverse`, to be used more than once.

    Raises
    ------
    NegativeCurvatureError
        If a body taken to be positive is not.
    """
    if not task.rhs.any():
        return Answer(np.zeros_like(task.rhs), 0, np.zeros_like(task.rhs))
    size = float(np.abs(task.rhs).max())
    if not _PLAIN[0] < size < _PLAIN[1]:
        # Products of what is left of it would leave the range of numbers. A power of two is exact.
        unit = 2.0 ** np.floor(np.log2(size))
        left = None if task.residual is None else task.residual / unit
        scaled = replace(task, rhs=task.rhs / unit, guess=task.guess / unit, residual=left)
        found = answer(operator, kind, preconditioner, scaled, border)
        residual = None if found.residual is None else found.residual * unit
        return Answer(found.x * unit, found.iterations, residual)
    if border is not None:
        return bordered_answer(operator, kind, preconditioner, border, task)
    if kind == "indefinite":
        return Answer(*condensed_gradients(operator, preconditioner, task))
    return positive_answer(operator, preconditioner, task)


def name(kind: str, preconditioner: LinearOperator | None) -> str:
    """What `iterate` does, in words."""
    if preconditioner is None:
        return "nothing to solve"
    levels = "two-level" if isinstance(preconditioner, TwoLevel) else "block Jacobi"
    on = "CG on condensed displacements" if kind == "indefinite" else "CG"
    return f"{on}, {levels}"


def relative_residual(operator: LinearOperator, x: Array, rhs: Array) -> float:
    """|b − K x| / |b| with the operator itself, 0 for b = 0."""
    size = float(np.linalg.norm(rhs))
    return float(np.linalg.norm(rhs - operator.matvec(x))) / size if size else 0.0


def attainable(operator: BondOperator, x: Array, rhs: Array) -> float:
    """The relative residual that rounding of x excuses: `rounded`, as far as an answer is left."""
    return min(rounded(operator, x, rhs), _EXCUSED)


def rounded(operator: BondOperator, x: Array, rhs: Array) -> float:
    """The relative residual that rounding of x leaves: some roundings of |K| |x| / |b|.

    Each row sums differences of neighbours; where displacements are large beside the strains that
    they make (a slender body in bending) these cancel.
    """
    size = float(np.linalg.norm(rhs))
    largest = 2.0 * float(np.abs(operator.bulk_blocks).max())
    rounding = _ROUNDINGS * np.finfo(np.float64).eps
    return rounding * largest * float(np.linalg.norm(x)) / size if size else 0.0
