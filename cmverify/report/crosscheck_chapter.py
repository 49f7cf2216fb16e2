"""The chapter on the cross-check by FEniCSx: what `run --cross-check` has left in a folder."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from cmverify.report import study_file
from cmverify.studies.crosscheck import Row

NAME, FORMAT = "crosscheck.json", 1


@dataclass(frozen=True)
class CrossCheck:
    """Rows with the code that made them.

    Attributes
    ----------
    rows : list of Row
    fenicsx : str
        Versions and interpreter; empty if there is none.
    skipped : str
        How to install FEniCSx, where it was asked for and not found.
    started : str
    """

    rows: list[Row]
    fenicsx: str
    skipped: str
    started: str

    @property
    def failed(self) -> list[Row]:
        """What does not agree."""
        return [row for row in self.rows if not row.passed]

    def of(self, case: str) -> list[Row]:
        """Rows of a case."""
        return [row for row in self.rows if row.case == case]

    @property
    def now(self) -> str:
        """What made the rows that are not kept from an earlier run, and when."""
        return f"{self.fenicsx}; {self.started}"

    @property
    def makers(self) -> Mapping[str, int]:
        """FEniCSx and time of every run whose rows are here, with how many they are."""
        return Counter(row.made or self.now for row in self.rows)


@dataclass(frozen=True)
class Cell:
    """A case's place in the report's column: the largest difference, and whether all agree."""

    passed: bool
    difference: float | None
    count: int


def column(found: CrossCheck) -> Mapping[str, Cell]:
    """The column of the table of verdicts, by case."""
    cells = {}
    for case in dict.fromkeys(row.case for row in found.rows):
        own = found.of(case)
        known = [row.difference for row in own if row.difference is not None]
        cells[case] = Cell(all(row.passed for row in own), max(known, default=None), len(own))
    return cells


def keeping(new: CrossCheck, folder: Path, cases: Iterable[str]) -> CrossCheck:
    """A cross-check of some cases with what its folder holds of others."""
    try:
        old = read(folder)
    except ValueError:
        old = None
    if old is None:
        return new
    own = set(cases)
    kept = [replace(row, made=row.made or old.now) for row in old.rows if row.case not in own]
    return replace(new, rows=new.rows + kept)


def write(found: CrossCheck, folder: Path) -> None:
    """Write crosscheck.json."""
    study_file.write(folder / NAME, FORMAT, asdict(found))


def read(folder: Path) -> CrossCheck | None:
    """The cross-check of a folder; None if there is none.

    Raises
    ------
    ValueError
        If it cannot be read.
    """
    return study_file.read(
        folder / NAME,
        FORMAT,
        "cross-check",
        lambda data: CrossCheck(**{**data, "rows": [Row(**one) for one in data["rows"]]}),
    )
