"""Displacements alone: the operator with rotations condensed out.

Where no bond has positive shear stiffness the rotation block −K_θθ is positive, well conditioned
(eigenvalues within a factor of three in bulk) and cheap to invert by conjugate gradients, so that
S = K_uu − K_uθ K_θθ⁻¹ K_θu can be applied without assembling anything. It costs an inner solve a
product, several times MINRES on the full system, but unlike MINRES it *notices* a direction of
non-positive energy, which a damaged body may have although its bulk has none.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, cg

from .errors import NegativeCurvatureError
from .operators import BondOperator

Array = NDArray[np.float64]

# Inner solves must not disturb the outer conjugacy.
_INNER = 1e-13


class Condensed(LinearOperator):
    """S = K_uu − K_uθ K_θθ⁻¹ K_θu of an operator with negative rotation stiffness.

    Parameters
    ----------
    operator : BondOperator
        With three components.
    """

    def __init__(self, operator: BondOperator) -> None:
        count = len(operator.active)
        super().__init__(operator.dtype, (2 * count, 2 * count))
        self.operator, self.count = operator, count
        diagonal = -operator.block_diagonal[:, 2, 2]
        if operator.fixed is not None:
            diagonal = np.where(operator.fixed[2], 1.0, diagonal)
        if diagonal.min(initial=1.0) <= 0:
            raise NegativeCurvatureError(
                "a particle's rotation stiffness is not negative where the bulk's is: condensing "
                "rotations needs bonds whose shear moduli share one sign"
            )
        self._rotation = LinearOperator((count, count), matvec=self._negative, dtype=np.float64)
        self._scaled = LinearOperator(
            (count, count), matvec=lambda r: r / diagonal, dtype=np.float64
        )

    def _field(self, u: Array | None, theta: Array | None) -> Array:
        values = np.zeros((3, self.count))
        if u is not None:
            values[:2] = u.reshape(2, -1)
        if theta is not None:
            values[2] = theta
        return values

    def _negative(self, theta: Array) -> Array:
        out = -self.operator.product(self._field(None, theta), masked=True)[2]
        if self.operator.fixed is not None:
            out = np.where(self.operator.fixed[2], theta, out)
        return out

    def rotations(self, moment: Array) -> Array:
        """K_θθ⁻¹ m, zero where rotations are prescribed."""
        if not moment.any():
            return np.zeros_like(moment)
        theta, _ = cg(self._rotation, -moment, rtol=_INNER, M=self._scaled, maxiter=2000)
        return np.asarray(theta, dtype=np.float64)

    def _matvec(self, u: Array) -> Array:
        u = np.asarray(u, dtype=np.float64).ravel()
        first = self.operator.product(self._field(u, None), masked=True)
        second = self.operator.product(self._field(None, self.rotations(first[2])), masked=True)
        out = first[:2] - second[:2]
        fixed = self.operator.fixed
        if fixed is not None:
            out[fixed[:2]] = self.operator.identity_scale * u.reshape(2, -1)[fixed[:2]]
        return out.ravel()

    def _adjoint(self) -> Condensed:
        return self

    def condense(self, rhs: Array) -> Array:
        """Right-hand side of the displacements."""
        force = rhs.reshape(3, -1)
        moment = (
            force[2]
            if self.operator.fixed is None
            else np.where(self.operator.fixed[2], 0.0, force[2])
        )
        second = self.operator.product(self._field(None, self.rotations(moment)), masked=True)
        return (force[:2] - second[:2]).ravel()

    def expand(self, u: Array, rhs: Array) -> Array:
        """The full solution from its displacements."""
        force = rhs.reshape(3, -1)
        moment = force[2] - self.operator.product(self._field(u, None), masked=True)[2]
        fixed = self.operator.fixed
        if fixed is not None:
            moment = np.where(fixed[2], 0.0, moment)
        values = self._field(u, self.rotations(moment))
        if fixed is not None:
            values[2] = np.where(fixed[2], force[2] / self.operator.identity_scale, values[2])
        return values.ravel()

    def preconditioner(self, full: LinearOperator) -> LinearOperator:
        """Displacement part of a preconditioner of the full system: its own condensation."""

        def apply(r: Array) -> Array:
            return full.matvec(self._field(r, None).ravel()).reshape(3, -1)[:2].ravel()

        return LinearOperator(self.shape, matvec=apply, dtype=np.float64)
