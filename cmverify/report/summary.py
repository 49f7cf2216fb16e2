"""A finished run as one object: what the terminal, the JSON file and the report all print."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from cmverify.case import Case, Check, Failed, Measurement, Outcome
from cmverify.judge import precision
from cmverify.judge.convergence import observed_orders
from cmverify.judge.verdict import Verdict, judge, unjudged
from cmverify.report import numbers
from cmverify.report.wording import counted
from cmverify.run import results

#: Kind of failure of what was not measured, or whose record is gone.
MISSING = "NotMeasured"
#: Kinds of verdicts that are no checks and only ever fail.
INCIDENTS = ("ran", "silent")


@dataclass(frozen=True)
class RunInfo:
    """How a run was made, so that it can be made again.

    `measured` lists its (case, method, resolution), planned ones included: its folder may hold
    records of others. `finished` is false until all of them were measured. `kept` are earlier runs
    in the same folder with the cases that this one did not measure again.
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
    kept: list[dict[str, Any]] = field(default_factory=list)

    @property
    def everything(self) -> Iterator[RunInfo]:
        """This run and those that are kept beside it, without what they keep themselves."""
        yield replace(self, kept=[])
        for earlier in self.kept:
            yield RunInfo(**earlier)

    def keeping(self, earlier: RunInfo) -> RunInfo:
        """This run beside the cases of an earlier one in its folder that it does not measure."""
        anew = {case for case, _, _ in self.measured}
        kept = []
        for run in earlier.everything:
            rest = [task for task in run.measured if task[0] not in anew]
            if rest:
                kept.append(asdict(replace(run, measured=rest)))
        return replace(self, kept=kept)


@dataclass(frozen=True)
class CaseResult:
    """A case with its records and verdicts; `run` is the one that measured it, if known."""

    case: Case
    records: tuple[results.Record, ...]
    verdicts: tuple[Verdict, ...]
    unjudged: tuple[Check, ...]
    run: RunInfo | None = None

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
    def checks(self) -> list[Verdict]:
        """What the case's checks say; their number follows from what was asked to be measured."""
        return [v for v in self.verdicts if v.kind not in INCIDENTS]

    @property
    def incidents(self) -> list[Verdict]:
        """What went wrong that no check is about: methods that raised, figures that are none."""
        return [v for v in self.verdicts if v.kind in INCIDENTS]

    @property
    def crashed(self) -> list[results.Record]:
        """Measurements that raised or whose worker died."""
        return [
            r for r in self.records if isinstance(r.outcome, Failed) and r.outcome.error != MISSING
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


def summarise(
    cases: Iterable[Case], records: Iterable[results.Record], run: RunInfo | None = None
) -> list[CaseResult]:
    """Group records by case and judge them; cases without records are left out."""
    known = list(records)
    found = []
    for case in cases:
        own = tuple(r for r in known if r.case == case.name)
        if not own:
            continue
        bare = CaseResult(case, own, (), ())
        verdicts = judge(case, bare.outcomes)
        waiting = tuple(unjudged(case, verdicts))
        found.append(CaseResult(case, own, tuple(verdicts), waiting, run))
    return found


def beside(
    cases: Sequence[Case], own: Sequence[CaseResult], info: RunInfo, folder: Path
) -> list[CaseResult]:
    """A run's results and those of the runs kept in its folder, in the order of the cases.

    Cases that this version does not know any more are left out: see `forgotten`.
    """
    found = list(own)
    for run in info.everything:
        if run.started != info.started:
            found += summarise(cases, complete(run, folder), run)
    order = {case.name: place for place, case in enumerate(cases)}
    return sorted(found, key=lambda result: order.get(result.case.name, -1))


def forgotten(cases: Sequence[Case], info: RunInfo) -> list[str]:
    """Cases that are kept from earlier runs and unknown to this version."""
    known = {(case.name, method.name) for case in cases for method in case.methods}
    kept = [task for run in info.kept for task in run["measured"]]
    return list(dict.fromkeys(case for case, method, _ in kept if (case, method) not in known))


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
class Tally:
    """Counts of a summary, as the terminal, the page and the numbers all give them."""

    cases: int
    good_cases: int
    checks: int
    good_checks: int
    measurements: int
    crashed: int
    missing: int
    passed: bool

    @property
    def failing(self) -> int:
        """Checks that do not hold."""
        return self.checks - self.good_checks

    @property
    def sentence(self) -> str:
        """What came of it, in a line."""
        if not self.cases:
            return "Nothing was judged."
        if self.passed:
            return f"All {counted(self.checks, 'check')} of {counted(self.cases, 'case')} hold."
        said = []
        if self.failing:
            fail = "fails" if self.failing == 1 else "fail"
            said.append(f"{self.failing} of {counted(self.checks, 'check')} {fail}")
        else:
            said.append(f"{counted(self.checks, 'check')} hold, but not every case is sound")
        if self.crashed:
            said.append(f"{counted(self.crashed, 'measurement')} crashed")
        if self.missing:
            are = "is" if self.missing == 1 else "are"
            said.append(f"{counted(self.missing, 'measurement')} {are} missing")
        return "; ".join(said) + "."


def tally(summary: Sequence[CaseResult]) -> Tally:
    """Count what a summary holds."""
    checks = [v for result in summary for v in result.checks]
    return Tally(
        cases=len(summary),
        good_cases=sum(result.passed for result in summary),
        checks=len(checks),
        good_checks=sum(v.passed for v in checks),
        measurements=sum(len(result.records) for result in summary),
        crashed=sum(len(result.crashed) for result in summary),
        missing=sum(len(result.missing) for result in summary),
        passed=all_passed(summary),
    )


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
    """All numbers of a run, without arrays; not-a-number is null.

    The format is described by `cmverify.report.numbers`.
    """
    cases = {}
    for result in summary:
        case, run = result.case, result.run or info
        cases[case.name] = {
            "title": case.title,
            "section": case.section,
            "shows": case.shows,
            "length": case.length,
            "primary": case.primary,
            "passed": result.passed,
            "run": {"level": run.level, "started": run.started, "command": run.command},
            "quantities": dict(case.quantities),
            "verdicts": [verdict.as_dict() for verdict in result.verdicts],
            "not_judged_at_this_level": [[c.method, c.quantity] for c in result.unjudged],
            "measurements": [asdict(row) for row in table(result)],
            "work_precision": [asdict(p) for p in precision.points(case, result.outcomes)],
        }
    data = {
        "format": numbers.FORMAT,
        "passed": all_passed(summary),
        "counts": asdict(tally(summary)),
        "run": asdict(info),
        "cases": cases,
    }
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
