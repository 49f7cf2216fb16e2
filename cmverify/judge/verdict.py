"""Judge the measurements of a case by its declared checks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal

from cmverify.case import Case, Check, Failed, Measurement, Outcome, Outcomes
from cmverify.judge.convergence import fitted_order, observed_orders

Kind = Literal["ran", "bound", "equal", "order"]


@dataclass(frozen=True)
class Verdict:
    """One line of the verdict table.

    `where` names the resolutions, `asked` the requirement in words, `margin` the share of the
    bound that is used up (NaN where that has no meaning).
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

    A method that raised fails, checked or not; so does a quantity that is missing or not a
    number. A check whose resolutions were not run gives no verdict: see `unjudged`.
    """
    verdicts: list[Verdict] = []
    for method, series in outcomes.items():
        verdicts += _completion(case, method, series)
    for check in case.checks:
        series = outcomes.get(check.method, {})
        done = {n: m for n, m in sorted(series.items()) if isinstance(m, Measurement)}
        verdicts += _absolute(case, check, done)
        verdicts += _order(case, check, done)
    return verdicts


def unjudged(case: Case, verdicts: list[Verdict]) -> list[Check]:
    """Checks about which these verdicts say nothing, because the level did not run them."""
    said = {(v.method, v.quantity) for v in verdicts}
    return [c for c in case.checks if (c.method, c.quantity) not in said]


def _completion(case: Case, method: str, series: Mapping[int, Outcome]) -> list[Verdict]:
    """One verdict a method: it ran everywhere and its figures are numbers."""
    problems = []
    for n, outcome in sorted(series.items()):
        if isinstance(outcome, Failed):
            problems.append(f"{case.length}/{n}: {outcome.error}: {outcome.message}")
        else:
            bad = [q for q, value in outcome.quantities.items() if not math.isfinite(value)]
            problems += [f"{case.length}/{n}: {quantity} is not finite" for quantity in bad]
    where = ", ".join(f"{case.length}/{n}" for n in sorted(series))
    return [
        Verdict(
            case.name, method, "completion", "ran", where, float(len(problems)),
            "runs, figures finite", not problems, "; ".join(problems),
        )
    ]  # fmt: skip


def _absolute(case: Case, check: Check, done: Mapping[int, Measurement]) -> list[Verdict]:
    verdicts = []
    for n, measurement in done.items():
        value = measurement.quantities.get(check.quantity, math.nan)
        where = f"{case.length}/{n}"
        bound = check.bound_at(n)
        if bound is not None:
            verdicts.append(
                Verdict(
                    case.name, check.method, check.quantity, "bound", where, value,
                    f"≤ {bound:.2g}", value <= bound, _remark(value), value / bound,
                )
            )  # fmt: skip
        if n in check.equals:
            verdicts.append(
                Verdict(
                    case.name, check.method, check.quantity, "equal", where, value,
                    f"= {check.equals[n]:,.10g}", value == check.equals[n], _remark(value),
                )
            )  # fmt: skip
    return verdicts


def _order(case: Case, check: Check, done: Mapping[int, Measurement]) -> list[Verdict]:
    band = check.order
    if band is None:
        return []
    ladder = [n for n in done if n >= band.since]
    ladder = ladder if band.fitted else ladder[-2:]
    if len(ladder) < 2:
        return []
    errors = [done[n].quantities.get(check.quantity, math.nan) for n in ladder]
    if all(abs(e) <= band.floor for e in errors):
        # All errors are rounding: the absolute bounds judge, an order has no meaning.
        return []
    h = [1.0 / n for n in ladder]
    if band.fitted and all(math.isfinite(e) and e > 0.0 for e in errors):
        fit = fitted_order(h, errors)
        value = fit.order if fit else math.nan
    else:
        value = float(observed_orders(h, errors)[-1])
    where = f"{case.length}/{ladder[0]} → {case.length}/{ladder[-1]}"
    asked = f"order {band.low:g} … {band.high:g}"
    return [
        Verdict(
            case.name, check.method, check.quantity, "order", where, value, asked,
            band.low <= value <= band.high, _remark(value),
        )
    ]  # fmt: skip


def _remark(value: float) -> str:
    return "" if math.isfinite(value) else "missing or not a number"
