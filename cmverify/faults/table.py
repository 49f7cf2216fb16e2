"""The fault table: every fault tried on the methods that can see it, in worker processes."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from cmverify.case import Level
from cmverify.faults import trial
from cmverify.faults.fault import Fault
from cmverify.faults.trial import Found, Pair, Sound
from cmverify.run.lifeline import workers
from cmverify.run.threads import child_environment, thread_environment

#: Methods that caught a fault when it was last searched for, cheapest first.
Map = dict[str, list[Pair]]
MAP = "map.json"


@dataclass(frozen=True)
class Result:
    """A fault and what the methods that were tried make of it."""

    fault: Fault
    found: tuple[Found, ...]

    @property
    def catching(self) -> tuple[Found, ...]:
        """Methods that fail."""
        return tuple(f for f in self.found if f.caught)

    @property
    def cases(self) -> tuple[str, ...]:
        """Cases that catch it."""
        return tuple(dict.fromkeys(f.case for f in self.catching))

    @property
    def state(self) -> str:
        """One of "caught", "moved but passed", "called but not felt", "never called"."""
        if self.catching:
            return "caught"
        if any(f.moved for f in self.found):
            return "moved but passed"
        return "called but not felt" if any(f.called for f in self.found) else "never called"

    @property
    def good(self) -> bool:
        """Whether it is caught, or argued to be harmless."""
        return bool(self.catching) or bool(self.fault.harmless)


def attempt(
    chosen: Sequence[Fault],
    known: Mapping[str, Sequence[Pair]],
    jobs: int,
    enough: int = trial.ENOUGH,
    seconds: float = 0.0,
    listen: Callable[[str, int, int], None] = lambda what, done, total: None,
    level: Level = Level.QUICK,
) -> list[Result]:
    """Try faults, first where the map says, then wherever a target is called.

    Parameters
    ----------
    known : mapping from a fault's name to the methods to try first
        What they do not catch, or what is not in it, is searched for everywhere.
    jobs : int
        Worker processes of one thread each.
    enough : int
        Cases that have to catch a fault before the search ends.
    seconds : float
        What may be spent on finding so many cases for a fault that fewer of the map catch.
    listen : callable
        Told what is being done, and how much of it.
    level : Level
        At which cases are measured; the map is that of level quick.
    """
    there = set(trial.pairs(level))
    plans = {f.name: [p for p in known.get(f.name, ()) if p in there] for f in chosen}
    results = {f.name: Result(f, ()) for f in chosen}
    with child_environment(thread_environment(1)), workers(jobs) as pool:

        def search(faults: Sequence[Fault], sound: Mapping[Pair, Sound], spend: float) -> None:
            before = {f.name: results[f.name].found for f in faults}
            waiting = {
                pool.submit(
                    trial.search, f.name, [(p, sound[p]) for p in plans[f.name]],
                    enough, spend, before[f.name], level,
                ): f
                for f in faults
            }  # fmt: skip
            for done, future in enumerate(as_completed(waiting), 1):
                fault = waiting[future]
                results[fault.name] = Result(fault, tuple(future.result()))
                listen(fault.name, done, len(waiting))

        sound = _sound(
            pool, sorted({p for plan in plans.values() for p in plan}), {}, listen, level
        )
        search([f for f in chosen if plans[f.name]], sound, math.inf)
        missed = [f for f in chosen if not results[f.name].good]
        single = [
            f
            for f in chosen
            if f not in missed
            and seconds
            and len(results[f.name].cases) < enough
            # What is argued to be harmless is not looked for at length.
            and not f.harmless
        ]
        if missed or single:
            sound = _sound(pool, sorted(there), sound, listen, level)
            cheap = sorted(sound, key=lambda pair: sound[pair].seconds)
            for fault in (*missed, *single):
                tried = {(f.case, f.method) for f in results[fault.name].found}
                plans[fault.name] = [
                    p
                    for p in cheap
                    if p not in tried
                    and (fault.target in sound[p].called or fault.target.startswith(trial.JUDGES))
                ]
            search(missed, sound, math.inf)
            search(single, sound, seconds)
    return [results[f.name] for f in chosen]


def _sound(
    pool: ProcessPoolExecutor,
    wanted: Sequence[Pair],
    known: Mapping[Pair, Sound],
    listen: Callable[[str, int, int], None],
    level: Level,
) -> dict[Pair, Sound]:
    found = dict(known)
    waiting = {pool.submit(trial.sound, p, level): p for p in wanted if p not in found}
    for done, future in enumerate(as_completed(waiting), 1):
        found[waiting[future]] = future.result()
        listen("without a fault", done, len(waiting))
    return found


def read_map() -> Map:
    """Which methods of which cases caught a fault when the map was last made."""
    resource = files("cmverify.faults") / MAP
    if not resource.is_file():
        return {}
    known = json.loads(resource.read_text(encoding="utf-8"))
    return {fault: [(case, method) for case, method in pairs] for fault, pairs in known.items()}


def write_map(results: Sequence[Result]) -> Path:
    """Keep, in the sources, the methods of two cases that catch each fault."""
    known: dict[str, list[Pair]] = read_map()
    for result in results:
        if seen := result.catching or tuple(f for f in result.found if f.moved):
            # One method a case: a second says nothing new.
            by_case = {f.case: f.method for f in reversed(seen)}
            cases = dict.fromkeys(f.case for f in seen)
            known[result.fault.name] = [(c, by_case[c]) for c in cases][: trial.ENOUGH]
    lines = [f" {_text(name)}: {_text(pairs)}" for name, pairs in sorted(known.items())]
    path = Path(str(files("cmverify.faults") / MAP))
    path.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
    return path


def _text(value: object) -> str:
    return json.dumps(value, ensure_ascii=False)
