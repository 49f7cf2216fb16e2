"""Work against precision: which method reaches an error in the least time."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from cmverify.case import Case, Measurement, Outcomes
from cmverify.judge.convergence import fitted_order


@dataclass(frozen=True)
class Point:
    """One measurement in the work-precision diagram."""

    method: str
    kind: str
    resolution: int
    unknowns: int
    seconds: float
    error: float


def points(case: Case, outcomes: Outcomes, quantity: str | None = None) -> list[Point]:
    """Every finished measurement of a case, methods as declared, coarse to fine."""
    name = quantity or case.primary
    found = []
    for method in case.methods:
        for n, outcome in sorted(outcomes.get(method.name, {}).items()):
            if isinstance(outcome, Measurement) and name in outcome.quantities:
                error, seconds = outcome.quantities[name], outcome.total_seconds
                found.append(Point(method.name, method.kind, n, outcome.unknowns, seconds, error))
    return found


def seconds_for(series: Iterable[Point], error: float) -> float:
    """Seconds in which a method reaches an error, interpolated between its measurements.

    Straight lines in log(error)-log(seconds); NaN where the error is finer than every
    measurement: no extrapolation. If even the coarsest measurement is better, its time counts.
    """
    known = sorted((p for p in series if p.error > 0 and p.seconds > 0), key=lambda p: -p.error)
    if not known or not math.isfinite(error) or error < known[-1].error:
        return math.nan
    if error >= known[0].error:
        return known[0].seconds
    x = np.log([p.error for p in reversed(known)])
    y = np.log([p.seconds for p in reversed(known)])
    return float(np.exp(np.interp(math.log(error), x, y)))


def front(series: Iterable[Point]) -> list[Point]:
    """The measurements that no other beats in both time and error, fastest first."""
    best: list[Point] = []
    for p in sorted(series, key=lambda p: (p.seconds, p.error)):
        if not best or p.error < best[-1].error:
            best.append(p)
    return best


def order_of(case: Case, series: Iterable[Point], floor: float = 1e-10) -> float:
    """Fitted order in the spacing of one method's points; NaN below the noise floor."""
    ordered = sorted(series, key=lambda p: p.resolution)
    if len(ordered) < 2:
        return math.nan
    fit = fitted_order([1.0 / p.resolution for p in ordered], [p.error for p in ordered], floor)
    return fit.order if fit else math.nan
