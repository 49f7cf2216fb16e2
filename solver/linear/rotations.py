"""Forces of a body whose rotations carry no inertia, for explicit steps: S u by warm inner solves.

Condensing couples neighbours, so that every step needs θ from K_θθ θ = m − K_θu u. The block is
well conditioned (2.6 in bulk), and the last steps say where θ is going: a few products with the
one-unknown kernel do. What is left of the moments acts on the body as a torque; a rigid turn of
each connected part takes its sum away exactly, so that angular momentum is kept to rounding
however loose the solve.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import LinearOperator, cg

from ..arrays import Array, Indices
from ..errors import NegativeCurvatureError
from ..operators import BondOperator
from .condensed import RotationBlock

# Weights of the last fields that extrapolate to the next one, for as many as are known.
_AHEAD = {0: (), 1: (1.0,), 2: (2.0, -1.0), 3: (3.0, -3.0, 1.0)}


class MasslessRotations:
    """Forces −S u of an operator, rotations in equilibrium.

    Parameters
    ----------
    operator : BondOperator
    kind : str
        See `solver.material.stability.Stability`; says the sign of K_θθ.
    tolerance : float
        Of the moments left over, relative to those that the displacements exert.
    parts : ndarray of int, shape (active,)
        Connected part of each particle.

    Attributes
    ----------
    past : list of ndarray, shape (active,)
        The last rotations, newest first: all of its state.
    products, inner : int
        Products with the whole operator and with the rotation block so far.
    """

    def __init__(self, operator: BondOperator, kind: str, tolerance: float, parts: Indices) -> None:
        self.operator, self.tolerance, self.parts = operator, tolerance, parts
        self.count = len(operator.active)
        self.has_rotations = operator.components == 3
        self.past: list[Array] = []
        self.products = self.inner = 0
        if not self.has_rotations:
            return
        fixed = operator.identity_rows
        self._free = np.ones(self.count, dtype=bool) if fixed is None else ~fixed[2]
        # K_θθ or −K_θθ, whichever is positive; the block of `condensed` is −K_θθ.
        self._sign = -1.0 if kind == "indefinite" else 1.0
        block = RotationBlock(operator)
        self._diagonal = self._sign * operator.block_diagonal[:, 2, 2]
        self._diagonal[~self._free] = 1.0
        if self._diagonal.min(initial=1.0) <= 0:
            raise NegativeCurvatureError(
                "a particle's rotation stiffness has not the sign of the bulk's: rotations cannot "
                "be condensed. Use law=UniformShear(), calibration='positive' or another m"
            )

        def apply(theta: Array) -> Array:
            self.inner += 1
            return np.where(self._free, -self._sign * block.matvec(theta.ravel()), 0.0)

        shape = (self.count, self.count)
        self._block = LinearOperator(shape, matvec=apply, dtype=np.float64)
        self._scaled = LinearOperator(
            shape, matvec=lambda r: r.ravel() / self._diagonal, dtype=np.float64
        )
        self._turn = apply(self._free.astype(np.float64))
        self.inner = 0
        # Where a support holds a rotation it takes the torque: such parts are not turned.
        self._turned = np.bincount(parts, self._turn)
        self._turned[np.bincount(parts, ~self._free) > 0] = np.inf

    def __call__(self, u: Array, moment: Array | None = None) -> tuple[Array, Array | None]:
        """S u less what `moment` exerts through the rotations, and the rotations.

        Parameters
        ----------
        u : ndarray, shape (2, active)
            Prescribed components count as zero, here and in the result.
        moment : ndarray, shape (active,), optional
            Couples on the particles, in the operator's units.

        Returns
        -------
        tuple of ndarray, shapes (2, active) and (active,), or None where there are no rotations
        """
        self.products += 1
        if not self.has_rotations:
            return self.operator.product(u, masked=True), None
        values = np.zeros((3, self.count))
        values[:2] = u
        for weight, theta in zip(_AHEAD[len(self.past)], self.past, strict=True):
            values[2] += weight * theta
        force = self.operator.product(values, masked=True)
        left = -force[2] if moment is None else moment - force[2]
        left[~self._free] = 0.0
        change = self._solve(left, values[2])
        self.products += 1
        theta = values[2] + change
        values[:2], values[2] = 0.0, change
        force[:2] += self.operator.product(values, masked=True)[:2]
        return force[:2], theta

    def _solve(self, left: Array, guess: Array) -> Array:
        """K_θθ⁻¹ of the moments that a guess leaves."""
        if not left.any():
            return np.zeros_like(left)
        # Relative to what the rotations balance, not to what a good guess leaves of it, nor to the
        # turn of a whole part, which strains nothing and may grow without bound.
        turn = np.bincount(self.parts, guess) / np.bincount(self.parts)
        balanced = float(np.linalg.norm(self._diagonal * (guess - turn[self.parts])))
        scale = max(float(np.linalg.norm(left)), balanced)
        left = self._sign * left
        change, stopped = cg(
            self._block, left, rtol=0.0, atol=self.tolerance * scale, M=self._scaled, maxiter=500
        )
        if stopped or not np.isfinite(change).all():
            raise NegativeCurvatureError(
                "the rotation stiffness of this body is not of one sign, rotations cannot be "
                "condensed: use law=UniformShear(), calibration='positive' or another m"
            )
        # 1·A x = (A 1)·x: the torque that is left needs no product.
        torque = np.bincount(self.parts, left - self._turn * change)
        change = change + np.where(self._free, (torque / self._turned)[self.parts], 0.0)
        return np.asarray(change, dtype=np.float64)

    def remember(self, theta: Array | None) -> None:
        """Hand over the rotations of a step that was taken."""
        if theta is not None:
            self.past = [theta, *self.past[:2]]

    def forget(self) -> None:
        """Start without knowledge of earlier steps."""
        self.past = []
