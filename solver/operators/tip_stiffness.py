"""What calibrated tips add to the operator: a matrix on a few particles each (`solver.tips`)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Indices


@dataclass(frozen=True, eq=False)
class TipStiffness:
    """Stiffness added around one tip.

    Attributes
    ----------
    particles : ndarray of int, shape (t,)
        All of their unknowns are free.
    matrix : ndarray, shape (components t, components t)
        Symmetric, component by component, in the operator's units.
    """

    particles: Indices
    matrix: Array

    def force(self, values: Array) -> Array:
        """Its product with values of its particles, both (components, t)."""
        # einsum keeps a fixed order of sums, whatever BLAS does.
        return np.einsum("ij,j->i", self.matrix, values.ravel()).reshape(values.shape)

    def energy(self, values: Array) -> float:
        """½ uᵀ ΔK u of values (components, t), per volume of a particle."""
        return 0.5 * float((values * self.force(values)).sum())
