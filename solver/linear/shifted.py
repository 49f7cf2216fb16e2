"""Solves with K + σ M, the matrix of an implicit step, for a σ that changes now and then.

A preconditioner made for one σ serves its neighbours: with σ' = r σ the spectrum of the one
against the other lies between 1 and r. So it is kept until σ has changed by more than `_KEEP`.
A new one need not probe the lattice again: the coarse matrix is linear in σ.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator

from ..arrays import Array, Indices
from ..errors import ConvergenceError
from ..operators import BondOperator
from . import method
from .krylov import Task
from .two_level import BlockJacobi, TwoLevel

# Factor by which σ may move away from the one that the preconditioner was made for.
_KEEP = 2.0
# With σ M above this share of K's diagonal block Jacobi is as good as two levels: the condition
# of D⁻¹(K + σ M) is at most 1 + 2/share.
_DOMINANT = 0.2


class Shifted:
    """Solver of (K + σ M) x = b.

    Parameters
    ----------
    operator : BondOperator
    kind : str
        See `solver.material.stability.Stability`.
    mass : ndarray, shape (components, active)
        Diagonal of M in the units of the operator's rows.
    parts : ndarray of int, shape (active,), optional
        Connected part of each particle. In conduction what each part stores in a step is then,
        to rounding, what flows into it, however well the rest is solved.

    Attributes
    ----------
    anchor : float or None
        The σ that the preconditioner was made for: all of the solver's state, so that
        `restore` leads a resumed run to the same bits.
    built, iterations : int
        Preconditioners made and iterations taken so far.
    """

    def __init__(
        self, operator: BondOperator, kind: str, mass: Array, parts: Indices | None = None
    ) -> None:
        self.operator, self.kind, self._parts = operator, kind, parts
        self.mass = mass if operator.identity_rows is None else mass * ~operator.identity_rows
        self._base = method.positive(operator, kind)
        self.anchor: float | None = None
        self.built = self.iterations = 0
        self._inverse: LinearOperator | None = None
        #: Coarse matrix at σ = 0 without the surface's nodes, and what σ adds to it.
        self._coarse: tuple[sparse.csc_array, sparse.csc_array, int] | None = None
        self._shift: float | None = None
        self._matrix: BondOperator = operator
        self._levelled: tuple[float, Array] | None = None

    def matrix(self, shift: float) -> BondOperator:
        """K + σ M."""
        if shift != self._shift:
            self._matrix, self._shift = self.operator.shifted(shift * self.mass), shift
        return self._matrix

    def restore(self, anchor: float | None) -> None:
        """Make the preconditioner that a run had when it was saved."""
        if anchor is not None:
            self._make(anchor)

    def _make(self, shift: float) -> None:
        base = self._base.shifted(shift * self.mass)
        dominant = shift * self.mass.max() > _DOMINANT * np.abs(self._base.bulk).max()
        if dominant or method.small(base):
            self._inverse = BlockJacobi(base)
        else:
            self._inverse = self._two_level(base, shift)
        self.anchor, self.built = shift, self.built + 1

    def _two_level(self, base: BondOperator, shift: float) -> TwoLevel:
        if self._coarse is None:
            # Probed without the shift, so that the next σ does not depend on this one.
            bare = TwoLevel(self._base, regularisation=1e-7)
            p = bare.hats.prolongation
            parts = [p.T @ sparse.diags_array(row) @ p for row in self.mass]
            added = sparse.csc_array(sparse.block_diag(parts, format="csc"))
            self._coarse = bare.coarse, added, bare.hats.coarsening
        still, added, coarsening = self._coarse
        return TwoLevel(base, coarsening, coarse=sparse.csc_array(still + shift * added))

    def _image(self, shift: float) -> Array:
        """(K + σ M) 1."""
        if self._levelled is None or self._levelled[0] != shift:
            self._levelled = shift, self.matrix(shift).matvec(np.ones(self.operator.shape[0]))
        return self._levelled[1]

    def solve(
        self, shift: float, rhs: Array, guess: Array, tolerance: float, limit: int = 5000
    ) -> Array:
        """x with |b − (K + σ M) x| ≤ tolerance |b|.

        Raises
        ------
        ConvergenceError, NegativeCurvatureError
        """
        if not len(rhs):
            # Every particle is prescribed.
            return np.zeros(0)
        if self.anchor is None or not 1 / _KEEP <= shift / self.anchor <= _KEEP:
            self._make(shift)
        matrix, inverse = self.matrix(shift), self._inverse
        assert inverse is not None
        x, count = method.iterate(matrix, self.kind, inverse, Task(rhs, guess, tolerance, limit))
        self.iterations += count
        residual = rhs - matrix.matvec(x)
        if self._parts is not None:
            # The exact correction along the constant of each part; they do not feel each other.
            image = self._image(shift)
            level = np.bincount(self._parts, residual) / np.bincount(self._parts, image)
            x, residual = x + level[self._parts], residual - level[self._parts] * image
        size = float(np.linalg.norm(rhs))
        left = float(np.linalg.norm(residual)) / size if size else 0.0
        if not left <= tolerance:
            raise ConvergenceError(
                f"an implicit step stopped at a relative residual of {left:.2e} after {count} "
                f"iterations; {tolerance:.1e} was asked for"
            )
        return x
