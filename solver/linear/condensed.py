"""Displacements alone: the operator with rotations condensed out.

Where shear stiffness is negative the rotation block −K_θθ is positive, well conditioned
(eigenvalues within a factor of three in bulk) and cheap to apply, one unknown a particle, so
that S = K_uu − K_uθ K_θθ⁻¹ K_θu is applied with an inner solve by conjugate gradients and without
assembling anything.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import LinearOperator, cg

from ..arrays import Array
from ..errors import NegativeCurvatureError
from ..operators import BondOperator, kernels

# Inner solves must not disturb the outer conjugacy.
_INNER = 1e-13


class RotationBlock(LinearOperator):
    """−K_θθ of an operator with three components, by the kernel of one unknown.

    Parameters
    ----------
    operator : BondOperator
    """

    def __init__(self, operator: BondOperator) -> None:
        count = len(operator.active)
        super().__init__(operator.dtype, (count, count))
        self.operator = operator
        self._grid = np.zeros((1, int(np.prod(operator.bonds.lattice.shape))))
        # The kernel subtracts its neighbours, K_θθ adds them: c enters with its own sign.
        self._blocks = np.ascontiguousarray(operator.half_blocks[..., 5:6])
        self._bulk = np.ascontiguousarray(-operator.bulk[:, 5:6])
        self._diagonal = np.ascontiguousarray(-operator.diagonal[5:6])

    def _matvec(self, theta: Array) -> Array:
        operator = self.operator
        theta = np.ascontiguousarray(theta, dtype=np.float64).ravel()
        fixed = None if operator.identity_rows is None else operator.identity_rows[2]
        given = theta if fixed is None else np.where(fixed, 0.0, theta)
        kernels.scatter(operator.segments, given[None], self._grid)
        out = np.empty((1, len(theta)))
        kernels.conductive_product(
            self._grid,
            operator.segments,
            operator.steps,
            self._blocks,
            self._bulk,
            self._diagonal,
            operator.bonds.strengths,
            out,
        )
        if operator.ended_stiffness is not None:
            turned = np.zeros((3, len(operator.at_surface)))
            turned[2] = given[operator.at_surface]
            out[0, operator.at_surface] -= operator.reaction(turned)[2]
        return out[0] if fixed is None else np.where(fixed, theta, out[0])

    def _adjoint(self) -> RotationBlock:
        return self


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
        self.block = RotationBlock(operator)
        diagonal = -operator.block_diagonal[:, 2, 2]
        if operator.identity_rows is not None:
            diagonal = np.where(operator.identity_rows[2], 1.0, diagonal)
        if diagonal.min(initial=1.0) <= 0:
            raise NegativeCurvatureError(
                "a particle's rotation stiffness is not negative where the bulk's is: condensing "
                "rotations needs bonds whose shear moduli share one sign (law=UniformShear())"
            )
        self._scaled = LinearOperator(
            (count, count), matvec=lambda r: r.ravel() / diagonal, dtype=np.float64
        )

    def _field(self, u: Array | None, theta: Array | None) -> Array:
        values = np.zeros((3, self.count))
        if u is not None:
            values[:2] = u.reshape(2, -1)
        if theta is not None:
            values[2] = theta
        return values

    def rotations(self, moment: Array) -> Array:
        """K_θθ⁻¹ m, zero where rotations are prescribed."""
        if not moment.any():
            return np.zeros_like(moment)
        theta, stopped = cg(self.block, -moment, rtol=_INNER, M=self._scaled, maxiter=2000)
        if stopped or not np.all(np.isfinite(theta)):
            raise NegativeCurvatureError(
                "the rotation stiffness of this body is not of one sign, rotations cannot be "
                "condensed: use law=UniformShear(), calibration='positive' or another m"
            )
        return np.asarray(theta, dtype=np.float64)

    def _matvec(self, u: Array) -> Array:
        u = np.asarray(u, dtype=np.float64).ravel()
        first = self.operator.product(self._field(u, None), masked=True)
        second = self.operator.product(self._field(None, self.rotations(first[2])), masked=True)
        out = first[:2] - second[:2]
        fixed = self.operator.identity_rows
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
            if self.operator.identity_rows is None
            else np.where(self.operator.identity_rows[2], 0.0, force[2])
        )
        second = self.operator.product(self._field(None, self.rotations(moment)), masked=True)
        return (force[:2] - second[:2]).ravel()

    def expand(self, u: Array, rhs: Array) -> Array:
        """The full solution from its displacements."""
        force = rhs.reshape(3, -1)
        moment = force[2] - self.operator.product(self._field(u, None), masked=True)[2]
        fixed = self.operator.identity_rows
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
