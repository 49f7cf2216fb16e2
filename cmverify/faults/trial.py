"""Faults tried on cases: what a process does that is given a fault, or none.

A trial is one method of one case, at level quick if not said otherwise. Without a fault it measures
what is right and notes which targets are called and how long it takes; with one it is judged
against that.
"""

from __future__ import annotations

import math
import signal
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

from cmverify.case import Case, Failed, Level, Measurement, Outcome
from cmverify.cases import registry as cases
from cmverify.faults import registry as faults
from cmverify.faults.fault import Calls, Fault, applied, forget, import_all
from cmverify.judge.verdict import judge, not_finite
from cmverify.run import worker

JUDGES = "cmverify.judge."
#: Seconds for one resolution, before a fault is taken to have made an iteration endless.
PATIENCE = {Level.QUICK: 120.0, Level.STANDARD: 1800.0, Level.PAPER: 7200.0}
#: Cases that have to catch a fault before no other is tried.
ENOUGH = 2

Pair = tuple[str, str]


@dataclass(frozen=True)
class Sound:
    """A method without a fault: its outcomes by resolution, targets it called, wall seconds."""

    outcomes: Mapping[int, Outcome]
    called: frozenset[str]
    seconds: float


@dataclass(frozen=True)
class Found:
    """What one method of a case makes of a fault.

    Attributes
    ----------
    caught : str
        The check that fails, in words; empty if none does.
    moved : bool
        Whether any figure differs from the sound run's.
    called : bool
        Whether the wrong function was called at all.
    """

    case: str
    method: str
    caught: str
    moved: bool
    called: bool


def pairs(level: Level = Level.QUICK) -> list[Pair]:
    """Every method of every case that measures something at a level."""
    found = {(case.name, m.name) for case in cases.all_cases() for m, _ in case.plan(level)}
    return sorted(found)


def sound(pair: Pair, level: Level = Level.QUICK) -> Sound:
    """Measure without a fault, counting calls of every fault's target."""
    case = cases.get(pair[0])
    targets = dict.fromkeys(sorted({f.target for f in faults.all_faults()}))
    _warm(case, pair[1])
    begun = time.perf_counter()
    with applied(targets) as calls:
        outcomes = _measure(case, pair[1], level)
    called = frozenset(target for target, count in calls.of.items() if count)
    return Sound(outcomes, called, time.perf_counter() - begun)


def search(
    name: str,
    plan: Sequence[tuple[Pair, Sound]],
    enough: int = ENOUGH,
    seconds: float = math.inf,
    found: Sequence[Found] = (),
    level: Level = Level.QUICK,
) -> list[Found]:
    """Try a fault on methods one after the other until so many cases have caught it.

    Parameters
    ----------
    name : str
        Of the fault.
    plan : sequence of (Pair, Sound)
    enough : int
    seconds : float
        What may be spent, by what the methods take without the fault.
    found : sequence of Found
        What is known of it already, first in what is returned.
    """
    fault, found, spent = faults.get(name), list(found), 0.0
    for pair, before in plan:
        catching = {f.case for f in found if f.caught}
        if len(catching) >= enough or spent + before.seconds > seconds:
            break
        # A second method of a case that has caught it says nothing new.
        if pair[0] not in catching:
            spent += before.seconds
            found.append(attempt(fault, pair, before, level))
    return found


def attempt(fault: Fault, pair: Pair, before: Sound, level: Level = Level.QUICK) -> Found:
    """One method with a fault, held against the same without."""
    case = _alone(cases.get(pair[0]), pair[1])
    _warm(case, pair[1])
    right = judge(case, {pair[1]: before.outcomes})
    passed = {(v.quantity, v.where, v.kind) for v in right if v.passed}
    # Judges are judged too: what they say while they are wrong counts.
    with applied({fault.target: fault.change}) as calls:
        outcomes = _measure(case, pair[1], level)
        if fault.target.startswith(JUDGES):
            wrong = judge(case, {pair[1]: outcomes})
    if not fault.target.startswith(JUDGES):
        wrong = judge(case, {pair[1]: outcomes})
    failing = [
        f"{v.quantity}, {v.where}: {v.value:.3g}, asked {v.asked} {v.message}".strip()
        for v in wrong
        # A failure that is there without the fault is no catch; one that never passes is.
        if not v.passed and (v.kind == "ran" or (v.quantity, v.where, v.kind) in passed)
    ]
    called = _called(calls, outcomes)
    return Found(*pair, failing[0] if failing else "", _moved(outcomes, before.outcomes), called)


def _called(calls: Calls, outcomes: Mapping[int, Outcome]) -> bool:
    return any(calls.of.values()) or any(isinstance(o, Failed) for o in outcomes.values())


def _moved(wrong: Mapping[int, Outcome], right: Mapping[int, Outcome]) -> bool:
    """Whether a figure differs, or there is none."""
    for n, outcome in wrong.items():
        other = right[n]
        if isinstance(outcome, Failed) or isinstance(other, Failed):
            return True
        for name, value in outcome.quantities.items():
            if name != "seconds" and not abs(value - other.quantities[name]) <= 1e-9 * abs(value):
                return True
    return False


def _alone(case: Case, method: str) -> Case:
    """A case with one of its methods, and what is said of it."""
    return replace(
        case,
        methods=(case.method(method),),
        checks=tuple(c for c in case.checks if c.method == method),
        poses=tuple(p for p in case.poses if p.method == method),
        featured=method,
    )


def _warm(case: Case, method: str) -> None:
    """Compile what the method needs, while everything is right."""
    import_all()
    forget()
    worker.warm_up(case.method(method))


def _measure(case: Case, method: str, level: Level) -> dict[int, Outcome]:
    chosen = case.method(method)
    found: dict[int, Outcome] = {}
    for n in chosen.resolutions.get(level, ()):
        with _patience(PATIENCE[level]):
            outcome = worker.attempt(chosen, n)
        if isinstance(outcome, Measurement) and not not_finite(outcome):
            # Fields were looked at for NaN; nobody draws them.
            outcome = replace(outcome, fields=None, lines=())
        found[n] = outcome
    return found


@contextmanager
def _patience(seconds: float) -> Iterator[None]:
    """TimeoutError in the block after so many seconds, where signals can say so."""

    def late(*_: object) -> None:
        raise TimeoutError(f"no result after {seconds:g} s")

    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
