"""The inverse of damage sensing: how long a crack is by the drop that is measured over it.

A run (or drawn cracks) gives pairs of crack lengths a and drops; with r = Δφ/Δφ₀ a cubic

    a = c₀ + c₁ z + c₂ z² + c₃ z³,     z = ln r,

is fitted to them by least squares. (ASTM E1457 has a cubic in r itself, up to a/W = 0.7; the drop
grows without bound as the ligament ends, its logarithm slowly.) A measured drop then means the
length a(r) with

    u² = (a′(r) u_r)² + xᵀ V x + s²,     x = (1, z, z², z³),

from the noise u_r of the measurement, what the fit leaves of its coefficients (covariance V) and
the scatter s of cracks about it (their ragged tips, and what a cubic cannot follow).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..arrays import Array
from ..errors import SceneError

if TYPE_CHECKING:
    from .growth import Growth

_DEGREE = 3


class CrackLength(NamedTuple):
    """A length and its standard uncertainty, m (or in the unit of the curve's lengths)."""

    length: float
    uncertainty: float


@dataclass(frozen=True, eq=False)
class DropCurve:
    """Crack lengths over relative drops.

    Parameters
    ----------
    lengths, drops : array_like, shape (n,)
        n ≥ 5 cracks; drops in any unit, relative to `intact`.
    intact : float
        Drop Δφ₀ of the body whose crack has not grown.

    Raises
    ------
    SceneError
        If there are too few cracks, a value is not finite, or the drop does not tell the length.
    """

    lengths: Array
    drops: Array
    intact: float

    def __post_init__(self) -> None:
        a, v = (np.asarray(x, dtype=np.float64) for x in (self.lengths, self.drops))
        object.__setattr__(self, "lengths", a)
        object.__setattr__(self, "drops", v)
        if a.ndim != 1 or a.shape != v.shape or len(np.unique(v)) < _DEGREE + 2:
            raise SceneError(
                f"a drop curve needs the lengths of at least {_DEGREE + 2} cracks with different "
                f"drops, one drop each"
            )
        if not (np.isfinite(a).all() and np.isfinite(v).all() and self.intact > 0):
            raise SceneError(
                "lengths and drops of a drop curve are finite, that before is positive"
            )
        low, high = self.range
        if not (self._slope(np.linspace(low, high, 101)) > 0).all():
            raise SceneError(
                "the drop does not tell the crack's length: their curve turns back between the "
                "cracks it was made of. Take other probes, or cracks of a narrower range"
            )

    @classmethod
    def of_run(cls, run: Growth, drop: str, initial: float) -> DropCurve:
        """The curve of a run whose monitor `drop` is a `Sensor`.

        Parameters
        ----------
        run : Growth
        drop : str
            Name of the monitor.
        initial : float
            Length of the crack before it grew, m.

        Raises
        ------
        SceneError
            As for any curve.
        """
        h = run.history
        drops = np.array(h[drop])
        kept = np.isfinite(drops) & (np.array(h.settled) > 0)
        # A line a state: loads that broke nothing tell nothing new.
        _, first = np.unique(np.array(h.broken)[kept], return_index=True)
        return cls(initial + np.array(h.advance)[kept][first], drops[kept][first], float(drops[0]))

    @property
    def range(self) -> tuple[float, float]:
        """Smallest and largest relative drop of the cracks that it was made of."""
        relative = self.drops / self.intact
        return float(relative.min()), float(relative.max())

    @cached_property
    def _fit(self) -> tuple[Array, Array, float]:
        """Coefficients, their covariance, and the variance of lengths about the curve."""
        x = self._powers(self.drops / self.intact)
        coefficients: Array = np.linalg.lstsq(x, self.lengths, rcond=None)[0].astype(np.float64)
        left = self.lengths - x @ coefficients
        variance = float(left @ left) / (len(left) - _DEGREE - 1)
        covariance: Array = variance * np.linalg.pinv(x.T @ x).astype(np.float64)
        return coefficients, covariance, variance

    def _powers(self, relative: Array | float) -> Array:
        """1, z, z², z³ of ln r in units of its range, (n, 4): well conditioned."""
        low, high = np.log(self.range)
        z = (np.log(np.atleast_1d(relative)) - low) / (high - low)
        return np.vander(z, _DEGREE + 1, increasing=True)

    def _slope(self, relative: Array | float) -> Array:
        """da/dr."""
        low, high = np.log(self.range)
        powers = self._powers(relative)[:, :-1] * np.arange(1, _DEGREE + 1)
        return np.asarray(powers @ self._fit[0][1:] / ((high - low) * np.atleast_1d(relative)))

    def length(self, drop: float, noise: float = 0.0) -> CrackLength:
        """The crack's length for a measured drop.

        Parameters
        ----------
        drop : float
            Relative to the intact body's, Δφ/Δφ₀.
        noise : float
            Standard uncertainty of that.

        Raises
        ------
        SceneError
            If the drop is none that the curve knows, or the noise is negative.

        Examples
        --------
        >>> import numpy as np
        >>> drops = np.array([1.0, 1.2, 1.5, 1.9, 2.4])
        >>> found = DropCurve(5.0 + np.log(drops), drops, 1.0).length(1.7, noise=0.017)
        >>> f"{found.length:.3f} ± {found.uncertainty:.3f}"
        '5.531 ± 0.010'
        """
        low, high = self.range
        if not low <= drop <= high:
            raise SceneError(
                f"a relative drop of {drop:.4g} lies beyond the cracks that the curve was made of "
                f"({low:.4g} to {high:.4g})"
            )
        if not noise >= 0:
            raise SceneError(f"the noise of a drop cannot be {noise}")
        coefficients, covariance, variance = self._fit
        x = self._powers(drop)[0]
        total = (float(self._slope(drop)[0]) * noise) ** 2 + float(x @ covariance @ x) + variance
        return CrackLength(float(x @ coefficients), float(np.sqrt(total)))
