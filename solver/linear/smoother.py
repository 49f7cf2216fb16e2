"""Chebyshev smoothing in single precision, on arrays that are made once.

A preconditioner needs no more digits than conjugate gradients gain with it: half the memory and
twice the lanes leave the iterations as they are down to residuals of 1e-12. Stiffness and residual
are taken over powers of two near their size, so that no unit of the user's leaves the range of
single precision, and what is negligible beside the largest entry becomes zero before it is too
small for a normal number (processors take many cycles for those).
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array, Float
from ..operators import BondOperator, kernels

# Ratio of the ends of the interval on which the polynomial is small beside a coarse grid: shorter
# waves than it resolves.
RATIO = 5.0


def size_of(values: Array) -> float:
    """The power of two below the largest magnitude, zero for zeros."""
    largest = max(float(values.max(initial=0.0)), -float(values.min(initial=0.0)))
    return float(2.0 ** np.floor(np.log2(largest))) if largest else 0.0


class Smoother:
    """Polynomials of D⁻¹K in D⁻¹ times a residual, K the operator and D its diagonal blocks.

    Parameters
    ----------
    operator : BondOperator
    bulk : ndarray, shape (phases, c, c)
    own : ndarray, shape (c, c, d)
        Inverses of the diagonal blocks, see `kernels.block_scale`.
    largest : float
        Bound of the eigenvalues of D⁻¹K.
    degree : int
        Products a sweep, that of the first residual included.
    precision : type
        Of all numbers.
    ratio : float
        Of the ends of the interval on which the polynomial is small.

    Attributes
    ----------
    residual, step, x : ndarray, shape (c, active)
        What is left, the last change of the answer, and the answer.
    """

    def __init__(
        self,
        operator: BondOperator,
        bulk: Array,
        own: Array,
        largest: float,
        degree: int,
        precision: type[np.floating] = np.float32,
        ratio: float = RATIO,
    ) -> None:
        self.operator, self._precision = operator, precision
        #: What the stiffness is taken over.
        self.unit = size_of(operator.bulk)

        def over(values: Array, unit: float) -> Float:
            found = np.empty(values.shape, dtype=precision)
            return np.divide(values, unit, out=found, casting="same_kind")

        self._stiffness = (
            over(operator.half_blocks, self.unit),
            over(operator.bulk, self.unit),
            over(operator.diagonal, self.unit),
            over(operator.strengths, 1.0),
        )
        fixed = operator.identity_rows
        #: Places of prescribed components among the flattened unknowns.
        self._fixed = np.nonzero(np.zeros(0) if fixed is None else fixed.ravel())[0]
        if fixed is not None:
            # Steps of prescribed components are zero: nobody need mask what they exert.
            which, component = np.nonzero(fixed.T[operator.own])
            own = own.copy()
            own[component, :, which] = own[:, component, which] = 0.0
        self._inverse = over(bulk, 1.0 / self.unit), over(own, 1.0 / self.unit)
        self._weights = _chebyshev(largest, degree, ratio)
        shape = operator.components, len(operator.active)
        self.residual, self.step, self.x, self._rows = np.zeros((4, *shape), dtype=precision)
        self._grid = np.zeros_like(operator.grid, dtype=precision)

    def start(self, residual: Array, unit: float) -> None:
        """Begin from zero with a residual (c, active) over `unit`."""
        kernels.narrow(self.operator.segments, residual, unit, self.residual)
        self.residual.ravel()[self._fixed] = 0.0
        self._rows.fill(0.0)
        self.x.fill(0.0)

    def sweep(self) -> None:
        """Smooth. What the last step takes from the residual is left to `leave` to find."""
        for number, (keep, gain) in enumerate(self._weights):
            if number:
                self._multiply()
            kernels.relax(
                self.operator.segments,
                *self._inverse,
                self._precision(keep),
                self._precision(gain),
                self._rows,
                self.residual,
                self.step,
                self.x,
                self._grid,
            )

    def leave(self) -> Float:
        """The residual after a sweep, zero at prescribed components."""
        self._multiply()
        self.residual -= self._rows
        self.residual.ravel()[self._fixed] = 0.0
        return self.residual

    def correct(self) -> None:
        """Add to the answer what has been written to `step`."""
        self.step.ravel()[self._fixed] = 0.0
        self.x += self.step
        kernels.scatter(self.operator.segments, self.step, self._grid)
        self._multiply()

    def answer(self, residual: Array, unit: float) -> Array:
        """The answer to a residual that was given over `unit`, flattened."""
        found = self.x.astype(np.float64).ravel()
        found *= unit / self.unit
        found[self._fixed] = residual.ravel()[self._fixed] / self.operator.identity_scale
        return found

    def _multiply(self) -> None:
        """K times the step on the grid."""
        operator, rows = self.operator, self._rows
        operator.kernel(self._grid, operator.segments, operator.steps, *self._stiffness, rows)
        if operator.ended_stiffness is not None:
            near = operator.at_surface
            rows[:, near] += operator.reaction(self.step[:, near]) / self.unit


def _chebyshev(largest: float, degree: int, ratio: float) -> list[tuple[float, float]]:
    """Factors of the last step and of D⁻¹r in each step."""
    low = largest / ratio
    centre, radius = 0.5 * (largest + low), 0.5 * (largest - low)
    sigma = centre / radius
    rho = 1.0 / sigma
    found = [(0.0, 1.0 / centre)]
    for _ in range(degree - 1):
        following = 1.0 / (2.0 * sigma - rho)
        found.append((following * rho, 2.0 * following / radius))
        rho = following
    return found
