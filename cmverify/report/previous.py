"""A run beside the one before it in the same folder: what changed in verdicts, figures, times."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from cmverify.report import numbers

#: The numbers of the run before, beside those of this one.
NAME = "previous.json"
#: A figure that moves by less than a per cent, or below rounding, stands still.
MOVED, NOISE = 0.01, 1e-12
#: Shortest time (s) and smallest change of it that are told.
LEAST, SLOWER = 0.05, 1.25


@dataclass(frozen=True)
class Change:
    """One figure then and now."""

    case: str
    method: str
    where: str
    quantity: str
    before: float
    after: float

    @property
    def ratio(self) -> float:
        """Now over then."""
        return self.after / self.before if self.before else math.inf


@dataclass(frozen=True)
class Comparison:
    """What changed since the run before; `figures` and `times` begin with the largest change."""

    before: numbers.Results
    broken: list[str] = field(default_factory=list)
    mended: list[str] = field(default_factory=list)
    new: list[str] = field(default_factory=list)
    gone: list[str] = field(default_factory=list)
    figures: list[Change] = field(default_factory=list)
    times: list[Change] = field(default_factory=list)
    common: int = 0
    time_ratio: float = math.nan


def set_aside(folder: Path) -> None:
    """Keep the numbers of a folder's run as those of the run before, if there are any."""
    with suppress(FileNotFoundError):
        (folder / "results.json").replace(folder / NAME)


def compare(folder: Path, now: numbers.Results) -> Comparison | None:
    """The run before beside this one; None if there was none.

    Raises
    ------
    ValueError
        If its numbers cannot be read.
    """
    if not (folder / NAME).is_file():
        return None
    before = numbers.read(folder / NAME)
    common = [name for name in now.cases if name in before.cases]
    # What is kept from the same run has not been measured again.
    again = [n for n in common if now.cases[n].run.started != before.cases[n].run.started]
    figures, times = [], []
    count, spent = 0, [0.0, 0.0]
    for name in again:
        for method, where, old, new in _pairs(before.cases[name], now.cases[name]):
            count += 1
            for quantity, value in new.quantities.items():
                was = old.quantities.get(quantity)
                if _moved(was, value):
                    assert was is not None
                    assert value is not None
                    figures.append(Change(name, method, where, quantity, was, value))
            if old.total and new.total:
                spent = [spent[0] + old.total, spent[1] + new.total]
                if max(old.total, new.total) > LEAST and _factor(old.total, new.total) > SLOWER:
                    times.append(Change(name, method, where, "total", old.total, new.total))
    return Comparison(
        before,
        broken=[n for n in common if before.cases[n].passed and not now.cases[n].passed],
        mended=[n for n in common if now.cases[n].passed and not before.cases[n].passed],
        new=[n for n in now.cases if n not in before.cases],
        gone=[n for n in before.cases if n not in now.cases],
        figures=sorted(figures, key=lambda c: -_factor(c.before, c.after)),
        times=sorted(times, key=lambda c: -_factor(c.before, c.after)),
        common=count,
        time_ratio=spent[1] / spent[0] if spent[0] > 0 else math.nan,
    )


def _pairs(
    before: numbers.Case, now: numbers.Case
) -> Iterator[tuple[str, str, numbers.Measurement, numbers.Measurement]]:
    old = {(m.method, m.resolution): m for m in before.measurements}
    for m in now.measurements:
        if other := old.get((m.method, m.resolution)):
            yield m.method, f"{now.length}/{m.resolution}", other, m


def _moved(before: float | None, after: float | None) -> bool:
    if before is None or after is None:
        return False
    size = max(abs(before), abs(after))
    return size > NOISE and abs(after - before) > MOVED * size


def _factor(before: float, after: float) -> float:
    """By how much one exceeds the other, whichever is larger; signs and zeros are far apart."""
    small, large = sorted((abs(before), abs(after)))
    return math.inf if small == 0.0 or before * after < 0 else large / small
