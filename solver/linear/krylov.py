"""SciPy's conjugate gradients, guarded: true residuals, and negative curvature by name."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import LinearOperator, cg

from ..arrays import Array
from ..errors import NegativeCurvatureError
from ..operators import BondOperator
from .condensed import Condensed

# Krylov recurrences drift from the true residual: restarts from the current solution repair it.
_RESTARTS = 6


@dataclass(frozen=True)
class Task:
    """What is to be solved, from where and how well.

    Attributes
    ----------
    rhs, guess : ndarray
        Right-hand side and first guess.
    tolerance : float
        Of |rhs − K x| / |rhs|.
    limit : int
        Largest number of iterations, restarts included.
    residual : ndarray, optional
        rhs − K guess, where it is known.
    aim : float
        Share of the tolerance to iterate to: what is left may drift from what the iterations say.
    """

    rhs: Array
    guess: Array
    tolerance: float
    limit: int
    residual: Array | None = None
    aim: float = 0.5


@dataclass(frozen=True)
class Answer:
    """What has been found, after how many iterations.

    Attributes
    ----------
    x : ndarray
    iterations : int
    residual : ndarray, optional
        rhs − K x, where it is known.
    """

    x: Array
    iterations: int
    residual: Array | None = None


class _Guarded(LinearOperator):
    """The operator, watching for directions of non-positive energy."""

    def __init__(self, operator: LinearOperator) -> None:
        super().__init__(operator.dtype, operator.shape)
        self.operator = operator

    def _matvec(self, x: Array) -> Array:
        y = self.operator.matvec(x)
        energy = float(x @ y)
        if not energy > 0.0 and float(x @ x) > 0.0:
            raise NegativeCurvatureError(
                f"the body has a direction of non-positive energy (x·Kx = {energy:.3g}): a "
                f"cut family, or damage, has taken more stiffness than the bulk can spare. Use "
                f"calibration='positive' (for C66 ≥ C12), another m, or hold the loose part"
            )
        return y


class _Counter:
    """Counts iterations as SciPy's callback."""

    def __init__(self) -> None:
        self.count = 0

    def __call__(self, _: Array) -> None:
        self.count += 1


def conjugate_gradients(
    operator: LinearOperator, preconditioner: LinearOperator, task: Task
) -> tuple[Array, int]:
    """`positive_answer` as the solution and the number of iterations."""
    found = positive_answer(operator, preconditioner, task)
    return found.x, found.iterations


def positive_answer(operator: LinearOperator, preconditioner: LinearOperator, task: Task) -> Answer:
    """Solve a positive system.

    Raises
    ------
    NegativeCurvatureError
        If the operator turns out not to be positive.
    """
    guarded, counter = _Guarded(operator), _Counter()
    x, size = task.guess.copy(), float(np.linalg.norm(task.rhs))
    defect = task.rhs - operator.matvec(x) if task.residual is None else task.residual
    for _ in range(_RESTARTS):
        # Solve for the correction: its residual is small, so nothing is lost to cancellation.
        share = float(np.linalg.norm(defect)) / size if size else 0.0
        left = task.limit - counter.count
        if share <= task.tolerance or left <= 0:
            break
        rtol = task.aim * task.tolerance / share
        step, _info = cg(
            guarded, defect, rtol=rtol, atol=0.0, maxiter=left, M=preconditioner, callback=counter
        )
        x = x + step
        defect = task.rhs - operator.matvec(x)
    return Answer(x, counter.count, defect)


def condensed_gradients(
    operator: BondOperator, preconditioner: LinearOperator, task: Task
) -> tuple[Array, int]:
    """Solve an indefinite body by `conjugate_gradients` on its displacements alone."""
    condensed = Condensed(operator)
    inverse, rhs = condensed.preconditioner(preconditioner), condensed.condense(task.rhs)
    x, count, wanted = task.guess, 0, task.tolerance
    for _ in range(_RESTARTS):
        displacement = x.reshape(3, -1)[:2].ravel()
        part = Task(rhs, displacement, wanted, task.limit - count)
        u, more = conjugate_gradients(condensed, inverse, part)
        x, count = condensed.expand(u, task.rhs), count + more
        # The condensed load may be larger than the load: then more is asked for.
        left = np.linalg.norm(task.rhs - operator.matvec(x)) / np.linalg.norm(task.rhs)
        if left <= task.tolerance or count >= task.limit:
            break
        wanted *= 0.5 * task.tolerance / float(left)
    return x, count
