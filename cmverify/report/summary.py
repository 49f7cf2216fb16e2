"""A finished run as one object: what the terminal, the JSON file and the report all print."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from cmverify.case import Case, Check, Failed, Measurement, Outcome
from cmverify.judge import precision
from cmverify.judge.convergence import observed_orders
from cmverify.judge.verdict import Verdict, judge, unjudged
from cmverify.run import results

#: Kind of failure of what was not measured, or whose record is gone.
MISSING = "NotMeasured"


@dataclass(frozen=True)
class RunInfo:
    """How a run was made, so that it can be made again.

    `measured` lists its (case, method, resolution), planned ones included: its folder may hold
    records of others. `finished` is false until all of them were measured.
    """

    level: str
    jobs: int
    threads: int
    command: str
    started: str
    wall_seconds: float
    environment: dict[str, Any] = field(default_factory=dict)
    measured: list[list[Any]] = field(default_factory=list)
    finished: bool = True


@dataclass(frozen=True)
class CaseResult:
    """A case with its records and verdicts."""

    case: Case
    records: tuple[results.Record, ...]
    verdicts: tuple[Verdict, ...]
    unjudged: tuple[Check, ...]

    @property
    def outcomes(self) -> dict[str, dict[int, Outcome]]:
        """Method name -> resolution -> outcome, methods as declared."""
        found: dict[str, dict[int, Outcome]] = {}
        for method in self.case.methods:
            series = {r.resolution: r.outcome for r in self.records if r.method == method.name}
            if series:
                found[method.name] = dict(sorted(series.items()))
        return found

    @property
    def missing(self) -> list[str]:
        """What belongs to the run and has no usable record, as "method 1/n"."""
        return [
            f"{r.case} {r.method} {self.case.length}/{r.resolution}"
            for r in self.records
            if isinstance(r.outcome, Failed) and r.outcome.error == MISSING
        ]

    @property
    def passed(self) -> bool:
        """Whether there are verdicts and all of them hold."""
        done = bool(self.verdicts) and not self.missing
        return done and all(v.passed for v in self.verdicts)

    @property
    def tightest(self) -> Verdict | None:
        """The absolute bound that is nearest to failing, or the worst that fails."""
        bounds = [v for v in self.verdicts if v.kind == "bound" and not math.isnan(v.margin)]
        return max(bounds, key=lambda v: v.margin, default=None)

    def finest(self, method: str) -> tuple[int, Measurement] | None:
        """The finest measurement of a method that has one."""
        series = self.outcomes.get(method, {})
        done = [(n, m) for n, m in series.items() if isinstance(m, Measurement)]
        return done[-1] if done else None

    @property
    def featured(self) -> str:
        """The method that figures show: the case's, or the first measured at this level."""
        named = self.case.featured
        if self.finest(named) is not None:
            return named
        drawn = (
            m.name
            for m in self.case.methods
            if (found := self.finest(m.name)) and (found[1].lines or found[1].fields)
        )
        return next(drawn, named)


def summarise(cases: Iterable[Case], records: Iterable[results.Record]) -> list[CaseResult]:
    """Group records by case and judge them; cases without records are left out."""
    known = list(records)
    found = []
    for case in cases:
        own = tuple(r for r in known if r.case == case.name)
        if not own:
            continue
        bare = CaseResult(case, own, (), ())
        verdicts = judge(case, bare.outcomes)
        found.append(CaseResult(case, own, tuple(verdicts), tuple(unjudged(case, verdicts))))
    return found


def complete(info: RunInfo, folder: Path) -> list[results.Record]:
    """The records of a run, in its order; a missing or damaged one is a failure that says so."""
    found = []
    for case, method, resolution in info.measured:
        path = results.stem(folder, case, method, resolution).with_suffix(".json")
        try:
            if not path.is_file():
                raise ValueError("there is no record of it")
            found.append(results.load(path))
        except ValueError as error:
            message = f"{error}; measure it with: {info.command} --resume"
            outcome = Failed(MISSING, message, "")
            found.append(results.Record(case, method, resolution, outcome, info.threads, 0.0, ""))
    return found


def all_passed(summary: Sequence[CaseResult]) -> bool:
    """Whether something was judged and every check of every case holds."""
    return bool(summary) and all(result.passed for result in summary)


@dataclass(frozen=True)
class Row:
    """One line of a method table."""

    method: str
    kind: str
    resolution: int
    unknowns: int | None
    quantities: dict[str, float]
    orders: dict[str, float]
    seconds: dict[str, float]
    total: float
    statistics: dict[str, Any]
    failure: Failed | None = None
    warnings: tuple[str, ...] = ()


#: Errors below this are rounding: no order is printed for them.
NOISE = 1e-12


def table(result: CaseResult) -> list[Row]:
    """Every measurement of a case with the observed order from the next coarser one."""
    rows: list[Row] = []
    counted = {check.quantity for check in result.case.checks if check.equals}
    for name, series in result.outcomes.items():
        kind = result.case.method(name).kind
        coarser: tuple[int, Measurement] | None = None
        for n, outcome in series.items():
            if isinstance(outcome, Failed):
                rows.append(Row(name, kind, n, None, {}, {}, {}, math.nan, {}, outcome))
                continue
            orders = _orders(coarser, (n, outcome), counted) if coarser else {}
            rows.append(
                Row(
                    name, kind, n, outcome.unknowns, dict(outcome.quantities), orders,
                    dict(outcome.seconds), outcome.total_seconds, dict(outcome.statistics),
                    warnings=outcome.warnings,
                )
            )  # fmt: skip
            coarser = (n, outcome)
    return rows


def _orders(
    coarse: tuple[int, Measurement], fine: tuple[int, Measurement], counted: set[str]
) -> dict[str, float]:
    """Observed orders of the quantities that are relative errors (below 1) above the noise."""
    h = [1.0 / coarse[0], 1.0 / fine[0]]
    orders = {}
    for name, value in fine[1].quantities.items():
        before = coarse[1].quantities.get(name, math.nan)
        if name not in counted and min(before, value) > NOISE and max(before, value) < 1.0:
            orders[name] = float(observed_orders(h, [before, value])[0])
    return orders


def as_json(summary: Sequence[CaseResult], info: RunInfo) -> str:
    """All numbers of a run, without arrays; not-a-number is null."""
    cases = {}
    for result in summary:
        case = result.case
        cases[case.name] = {
            "title": case.title,
            "section": case.section,
            "shows": case.shows,
            "passed": result.passed,
            "quantities": dict(case.quantities),
            "verdicts": [verdict.as_dict() for verdict in result.verdicts],
            "not_judged_at_this_level": [[c.method, c.quantity] for c in result.unjudged],
            "measurements": [asdict(row) for row in table(result)],
            "work_precision": [asdict(p) for p in precision.points(case, result.outcomes)],
        }
    data = {"passed": all_passed(summary), "run": asdict(info), "cases": cases}
    return json.dumps(_finite(data), indent=1, allow_nan=False)


def save_info(info: RunInfo, folder: Path) -> None:
    """Write run.json beside the results, for a later `cmverify report`."""
    results.write_text(folder / "run.json", json.dumps(asdict(info), indent=1))


def load_info(folder: Path) -> RunInfo:
    """Read run.json; ValueError if the folder is not one of a run."""
    try:
        info = RunInfo(**json.loads((folder / "run.json").read_text(encoding="utf-8")))
        if not all(
            isinstance(case, str) and isinstance(method, str) and isinstance(n, int)
            for case, method, n in info.measured
        ):
            raise ValueError("its list of measurements is damaged")
        return info
    except (OSError, TypeError, ValueError) as error:
        raise ValueError(
            f"{folder} holds no finished run (run.json: {error}); "
            f"make one with: cmverify run --out {folder}"
        ) from error


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(k): _finite(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(v) for v in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
