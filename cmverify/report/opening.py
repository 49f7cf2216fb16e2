"""The first page of the report: what was checked, what came of it, the best figures."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from cmverify.case import Measurement
from cmverify.report.picture import Picture
from cmverify.report.summary import CaseResult, Tally, tally
from cmverify.report.topics import Topic, by_topic

#: What the pictures of the first page show, one each, by how their names begin.
SHOWN = ("convergence", "work-precision", "field", "stages")


@dataclass(frozen=True)
class Best:
    """The smallest judged error of a topic, and what it cost."""

    case: str
    what: str
    method: str
    where: str
    value: float
    unknowns: int
    seconds: float


@dataclass(frozen=True)
class Line:
    """A topic with its counts and its best figure."""

    topic: Topic
    counts: Tally
    best: Best | None


def lines(summary: Sequence[CaseResult]) -> list[Line]:
    """One line a topic."""
    return [Line(topic, tally(own), best_of(own)) for topic, own in by_topic(summary)]


def best_of(summary: Iterable[CaseResult]) -> Best | None:
    """The smallest error by the bond solver that a check bounds and that holds.

    What is zero but for rounding comes last: another figure says more of a method.
    """
    found: list[tuple[bool, bool, float, Best]] = []
    for result in summary:
        case = result.case
        exact = {(c.method, c.quantity) for c in case.checks if c.exact}
        for v in result.checks:
            if v.kind != "bound" or not v.passed or not v.value > 0.0:
                continue
            n = int(v.where.rsplit("/", 1)[1])
            outcome = result.outcomes[v.method][n]
            if isinstance(outcome, Measurement) and case.method(v.method).kind != "fem":
                best = Best(
                    case.name, case.quantities[v.quantity], v.method, v.where, v.value,
                    outcome.unknowns, outcome.total_seconds,
                )  # fmt: skip
                rounding, minor = (v.method, v.quantity) in exact, v.quantity != case.primary
                found.append((minor, rounding, v.value, best))
    first = min(found, key=lambda item: item[:3], default=None)
    return first and first[3]


def pictures(
    summary: Sequence[CaseResult], drawn: dict[str, list[Picture]]
) -> list[tuple[CaseResult, Picture]]:
    """One picture of each kind, of the first case that has it, topics in their order."""
    ordered = [result for _, own in by_topic(summary) for result in own]
    found = []
    for kind in SHOWN:
        every = ((r, p) for r in ordered for p in drawn[r.case.name] if p.name.startswith(kind))
        if (first := next(every, None)) is not None:
            found.append(first)
    return found
