"""Systems with a few unknowns more than the operator has: a border about it.

    [ K   W ] [x]   [b]
    [ Wᵀ  D ] [z] = [r]

The preconditioner of K, taken for K⁻¹ in the block elimination of x, makes one of the whole: a
border of k unknowns costs k applications once, and no more iterations than K alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import LinearOperator

from ..arrays import Array
from ..errors import NegativeCurvatureError
from ..operators import BondOperator
from .krylov import Answer, Task, condensed_gradients, positive_answer

# Least eigenvalue of the preconditioner's Schur complement relative to D: it need not be accurate,
# but must be positive.
_LEAST = 1e-4
# Rounds of refinement where the border is eliminated.
_ROUNDS = 4


@dataclass(frozen=True, eq=False)
class Border:
    """What stands beside the operator.

    Attributes
    ----------
    coupling : ndarray, shape (n, k)
        W.
    stiffness : ndarray, shape (k, k)
        D.
    force : ndarray, shape (k,)
        r.
    """

    coupling: Array
    stiffness: Array
    force: Array


class Bordered(LinearOperator):
    """The bordered operator."""

    def __init__(self, operator: LinearOperator, border: Border) -> None:
        size = operator.shape[0] + len(border.force)
        super().__init__(np.float64, (size, size))
        self.operator, self.border = operator, border

    def _matvec(self, v: Array) -> Array:
        v = np.asarray(v, dtype=np.float64).ravel()
        count = self.operator.shape[0]
        x, z = v[:count], v[count:]
        first = self.operator.matvec(x) + self.border.coupling @ z
        return np.concatenate([first, self.border.coupling.T @ x + self.border.stiffness @ z])

    def _adjoint(self) -> Bordered:
        return self


class BorderedInverse(LinearOperator):
    """Preconditioner of a bordered operator from one of the operator within.

    Parameters
    ----------
    inverse : LinearOperator
        Symmetric positive definite, about K⁻¹.
    border : Border
    """

    def __init__(self, inverse: LinearOperator, border: Border) -> None:
        size = inverse.shape[0] + len(border.force)
        super().__init__(np.float64, (size, size))
        self.inverse, self.border = inverse, border
        columns = [inverse.matvec(column) for column in border.coupling.T]
        #: About K⁻¹ W, shape (n, k).
        self.answer: Array = np.column_stack(columns) if columns else border.coupling
        schur = border.stiffness - border.coupling.T @ self.answer
        scale = np.sqrt(np.maximum(np.abs(np.diagonal(border.stiffness)), 1e-300))
        relative = 0.5 * (schur + schur.T) / np.outer(scale, scale)
        values, vectors = np.linalg.eigh(np.nan_to_num(relative))
        vectors = vectors / scale[:, None]
        self._schur = (vectors / np.maximum(values, _LEAST)) @ vectors.T

    def _matvec(self, v: Array) -> Array:
        v = np.asarray(v, dtype=np.float64).ravel()
        count = self.inverse.shape[0]
        x = self.inverse.matvec(v[:count])
        z = self._schur @ (v[count:] - self.border.coupling.T @ x)
        return np.concatenate([x - self.answer @ z, z])

    def _adjoint(self) -> BorderedInverse:
        return self


def bordered_answer(
    operator: BondOperator,
    kind: str,
    inverse: LinearOperator | BorderedInverse,
    border: Border,
    task: Task,
) -> Answer:
    """Solve a bordered system; right-hand side, guess and result hold x and then z.

    Parameters
    ----------
    operator : BondOperator
        K.
    kind : str
        See `solver.material.stability.Stability`.
    inverse : LinearOperator
        Preconditioner of K, or `BorderedInverse` made of it.
    border : Border
    task : Task

    Raises
    ------
    NegativeCurvatureError
        If the system turns out not to be positive (but for rotations of indefinite bodies).
    """
    if kind != "indefinite":
        whole = (
            inverse if isinstance(inverse, BorderedInverse) else BorderedInverse(inverse, border)
        )
        return positive_answer(Bordered(operator, border), whole, task)
    # Rotations are condensed on K alone: one more solve for each unknown of the border.
    inner = inverse.inverse if isinstance(inverse, BorderedInverse) else inverse
    count, total = operator.shape[0], 0

    def solve(rhs: Array, guess: Array) -> Array:
        nonlocal total
        if not rhs.any():
            return np.zeros_like(rhs)
        part = Task(rhs, guess, max(0.1 * task.tolerance, 1e-12), task.limit)
        found, iterations = condensed_gradients(operator, inner, part)
        total += iterations
        return found

    answer = np.column_stack([solve(w, np.zeros(count)) for w in border.coupling.T])
    schur = border.stiffness - border.coupling.T @ answer
    if np.linalg.eigvalsh(0.5 * (schur + schur.T)).min() <= 0:
        raise NegativeCurvatureError(
            "a rigid pin or tied component can move without energy, or gains some: hold it"
        )
    whole, found = Bordered(operator, border), task.guess.copy()
    goal = task.tolerance * float(np.linalg.norm(task.rhs))
    for _ in range(_ROUNDS):
        left = task.rhs - whole.matvec(found)
        if np.linalg.norm(left) <= goal or total >= task.limit:
            break
        x = solve(left[:count], np.zeros(count))
        z = np.linalg.solve(schur, left[count:] - border.coupling.T @ x)
        found = found + np.concatenate([x - answer @ z, z])
    return Answer(found, total)
