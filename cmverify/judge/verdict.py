"""Judge the measurements of a case by its declared checks."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np

from cmverify.case import Case, Check, Failed, Level, Measurement, Outcome, Outcomes
from cmverify.judge.convergence import fitted_order, observed_orders

Kind = Literal["ran", "silent", "bound", "equal", "order"]


@dataclass(frozen=True)
class Verdict:
    """One line of the verdict table.

    `where` names the resolutions, `asked` the requirement in words, `margin` the share of the
    bound that is used up (NaN where that has no meaning). "ran" and "silent" are no checks: they
    only ever fail, for a method that raised or measured what is no number, and for a case about
    which nothing was said.
    """

    case: str
    method: str
    quantity: str
    kind: Kind
    where: str
    value: float
    asked: str
    passed: bool
    message: str = ""
    margin: float = math.nan

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON, where NaN is written as null."""
        data = asdict(self)
        return {k: None if isinstance(v, float) and math.isnan(v) else v for k, v in data.items()}


def judge(case: Case, outcomes: Outcomes) -> list[Verdict]:
    """Every verdict of a case.

    A method that raised fails, checked or not, and so does any figure that is missing or not a
    number, whether a check looks at it or not. A check speaks wherever its method was asked to
    measure, so that the number of verdicts follows from what was asked for (`declared`) and not
    from what came of it. A check whose resolutions were not run gives none: see `unjudged`.
    """
    verdicts: list[Verdict] = []
    for method, series in outcomes.items():
        verdicts += _incidents(case, method, series)
    asked = {method: tuple(sorted(series)) for method, series in outcomes.items()}
    for check, where, kind in _questions(case, asked):
        series = outcomes[check.method]
        errors = [_value(series[n], check.quantity) for n in where]
        answer = {"bound": _bound, "equal": _equal, "order": _order}[kind]
        verdicts.append(answer(case, check, where, errors))
    if outcomes and not any(v.kind not in ("ran", "silent") for v in verdicts):
        verdicts.append(
            Verdict(
                case.name, case.featured, "any", "silent", _places(case, asked), 0.0,
                "something is judged", False, "no check of this case judges what was run",
            )
        )  # fmt: skip
    return verdicts


def declared(case: Case, level: Level) -> int:
    """How many checks judge a case at a level, whatever its measurements will say."""
    asked = {m.name: tuple(sorted(m.resolutions.get(level, ()))) for m in case.methods}
    return sum(1 for _ in _questions(case, asked))


def unjudged(case: Case, verdicts: list[Verdict]) -> list[Check]:
    """Checks about which these verdicts say nothing, because the level did not run them."""
    said = {(v.method, v.quantity) for v in verdicts}
    return [c for c in case.checks if (c.method, c.quantity) not in said]


def _questions(
    case: Case, asked: Mapping[str, tuple[int, ...]]
) -> Iterator[tuple[Check, tuple[int, ...], Literal["bound", "equal", "order"]]]:
    """What the checks ask about these resolutions of each method, measured or not."""
    for check in case.checks:
        ladder = asked.get(check.method, ())
        for n in ladder:
            if check.bound_at(n) is not None:
                yield check, (n,), "bound"
            if n in check.equals:
                yield check, (n,), "equal"
        if check.order is not None:
            used = tuple(n for n in ladder if n >= check.order.since)
            used = used if check.order.fitted else used[-2:]
            if len(used) >= 2:
                yield check, used, "order"


def _value(outcome: Outcome, quantity: str) -> float:
    """The figure, NaN if there is none."""
    if isinstance(outcome, Failed):
        return math.nan
    return outcome.quantities.get(quantity, math.nan)


def _incidents(case: Case, method: str, series: Mapping[int, Outcome]) -> list[Verdict]:
    """A verdict on a method that raised somewhere or measured what is no number; else none."""
    problems = []
    for n, outcome in sorted(series.items()):
        if isinstance(outcome, Failed):
            problems.append(f"{case.length}/{n}: {outcome.error}: {outcome.message}")
        else:
            problems += [f"{case.length}/{n}: {what} is not finite" for what in not_finite(outcome)]
    if not problems:
        return []
    where = ", ".join(f"{case.length}/{n}" for n in sorted(series))
    return [
        Verdict(
            case.name, method, "completion", "ran", where, float(len(problems)),
            "runs, figures finite", False, "; ".join(problems),
        )
    ]  # fmt: skip


def not_finite(measurement: Measurement) -> list[str]:
    """What of a measurement holds NaN or an infinity: figures, seconds, fields, curves."""
    bad = [q for q, value in measurement.quantities.items() if not math.isfinite(value)]
    bad += [f"seconds of {s}" for s, v in measurement.seconds.items() if not math.isfinite(v)]
    bad += [
        name
        for name, value in measurement.statistics.items()
        if not isinstance(value, str) and not math.isfinite(value)
    ]
    if measurement.fields is not None:
        for name, item in measurement.fields.items.items():
            if not (np.isfinite(item.computed).all() and np.isfinite(item.reference).all()):
                bad.append(f"field {name}")
    for line in measurement.lines:
        for curve in line.curves:
            if not (np.isfinite(curve.computed).all() and np.isfinite(curve.reference).all()):
                bad.append(f"curve {curve.label!r} of {line.title!r}")
    return bad


def _bound(case: Case, check: Check, where: tuple[int, ...], errors: list[float]) -> Verdict:
    (n,), (value,) = where, errors
    bound, least = check.bound_at(n), check.least_at(n)
    assert bound is not None
    message = _remark(value)
    if value <= least and not check.exact:
        message = f"too good to be true: this method cannot come below {least:.1g}"
    # In as many digits as what was measured, so that what holds also reads as if it held.
    asked = f"≤ {bound:.3g}"
    passed = 0.0 <= value <= bound if check.exact else least < value <= bound
    return Verdict(
        case.name, check.method, check.quantity, "bound", f"{case.length}/{n}", value,
        asked, passed, message, _share(value, bound),
    )  # fmt: skip


def _share(value: float, bound: float) -> float:
    """Of a bound that is used up; a bound of zero has none but for what is zero."""
    if bound == 0.0:
        return 0.0 if value == 0.0 else math.inf if value > 0.0 else math.nan
    return value / bound


def _equal(case: Case, check: Check, where: tuple[int, ...], errors: list[float]) -> Verdict:
    (n,), (value,) = where, errors
    return Verdict(
        case.name, check.method, check.quantity, "equal", f"{case.length}/{n}", value,
        f"= {check.equals[n]:,.10g}", value == check.equals[n], _remark(value),
    )  # fmt: skip


def _order(case: Case, check: Check, where: tuple[int, ...], errors: list[float]) -> Verdict:
    band = check.order
    assert band is not None
    h = [1.0 / n for n in where]
    message = ""
    if all(abs(e) <= band.floor for e in errors):
        # Rounding decides the order of such errors. What is exact has a bound and no order.
        value, message = math.nan, f"too good to be true: every error is below {band.floor:.1g}"
    elif not all(math.isfinite(e) for e in errors):
        value = math.nan
    elif band.fitted and all(e > 0.0 for e in errors):
        fit = fitted_order(h, errors)
        value = fit.order if fit else math.nan
    else:
        value = float(observed_orders(h, errors)[-1])
    return Verdict(
        case.name, check.method, check.quantity, "order",
        f"{case.length}/{where[0]} → {case.length}/{where[-1]}", value,
        f"order {band.low:g} … {band.high:g}", band.low <= value <= band.high,
        message or _remark(value),
    )  # fmt: skip


def _places(case: Case, asked: Mapping[str, tuple[int, ...]]) -> str:
    found = sorted({n for ladder in asked.values() for n in ladder})
    return ", ".join(f"{case.length}/{n}" for n in found)


def _remark(value: float) -> str:
    return "" if math.isfinite(value) else "missing or not a number"
