"""Load programmes: how the factor on all supports and loads of a scene changes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, inf, isfinite, sqrt
from typing import Literal

from ..errors import SceneError

Control = Literal["fixed", "following"]

# Events nearer than this share to a multiple of the increment count as on it.
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Programme:
    """The load factor λ that multiplies what a scene prescribes and applies.

    Between breaks the body is linear, so that the λ at which the next bond breaks is known: the
    load goes there without stops in between.

    Parameters
    ----------
    start : float
        First factor.
    stop : float
        Largest factor; the run ends when the body stands it.
    increment : float, optional
        Only ``start + k·increment`` are loads (the paper's steps): the load goes to the first of
        them at which a bond breaks. Without it, to the event.
    overload : float, optional
        Share by which the most loaded bond may exceed its w_c when the load arrives. Without an
        increment the load goes that far beyond the event (by default to the very event), so that
        events close to each other become one. An increment is halved until it is kept (adaptive
        steps; by default it stays as it is).
    levels : sequence of float, optional
        Factors to be visited one after the other, unloading included, instead of `stop`.
    least_force : float, optional
        The run ends when, at rest after something broke, what is conjugate to λ
        (`History.force`) has fallen below this share of its peak. When the body has parted, so
        that no load strains it any more, a run always ends.
    control : {"fixed", "following"}
        ``fixed``: the load stays where it is until no bond is overloaded; what an unstable crack
        sets free beyond its toughness is excess. ``following``: the load is lowered with every
        batch to what the weakest bonds bear, so that a crack grows at the critical load and
        there is (next to) no excess; the factor goes up and down.

    Raises
    ------
    SceneError
        If the numbers make no programme.

    Examples
    --------
    >>> Programme(increment=0.25).reach(0.6, 1.0)
    0.75
    """

    start: float = 0.0
    stop: float = inf
    increment: float | None = None
    overload: float | None = None
    levels: Sequence[float] | None = None
    control: Control = "fixed"
    least_force: float | None = None

    def __post_init__(self) -> None:
        if not (isfinite(self.start) and self.start >= 0):
            raise SceneError(f"the first load factor must be at least 0, not {self.start}")
        if self.levels is not None and isfinite(self.stop):
            raise SceneError("a programme ends at `stop` or visits `levels`, not both")
        if not self.stop >= self.start:
            raise SceneError(f"the programme stops at {self.stop}, before it starts")
        if self.increment is not None and not (isfinite(self.increment) and self.increment > 0):
            raise SceneError(f"the load increment must be positive, not {self.increment}")
        if self.overload is not None and not (isfinite(self.overload) and self.overload > 0):
            raise SceneError(f"the admissible overload must be positive, not {self.overload}")
        if self.least_force is not None and not 0 < self.least_force < 1:
            raise SceneError(
                f"least_force is a share of the peak between 0 and 1, not {self.least_force}"
            )
        if self.control not in ("fixed", "following"):
            raise SceneError(f"control must be 'fixed' or 'following', not {self.control!r}")
        if self.levels is not None:
            if not len(self.levels) or not all(isfinite(v) and v >= 0 for v in self.levels):
                raise SceneError("levels must be load factors of at least 0")
            if self.control == "following":
                raise SceneError("levels prescribe the load: it cannot follow the crack")
        if self.control == "following" and self.increment is not None:
            raise SceneError("a load that follows the crack has no increments")

    @property
    def targets(self) -> tuple[float, ...]:
        """Factors to be reached in turn."""
        return (self.stop,) if self.levels is None else tuple(float(v) for v in self.levels)

    def reach(self, event: float, target: float) -> float:
        """The factor to go to when the next bond breaks at `event` (not above `target`)."""
        if self.increment is None:
            return min(event * sqrt(1.0 + (self.overload or 0.0)), target)
        step, factor = self.increment, inf
        while True:
            factor = self.start + ceil((event - self.start) / step - _ROUNDING) * step
            if self.overload is None or (factor / event) ** 2 <= 1.0 + self.overload:
                return min(max(factor, event), target)
            step *= 0.5
