"""Which check covers what: physics, calibration, treatment of surfaces, m.

The matrix is drawn from the cases themselves: every measurement knows with what its scenes were
solved, and its checks count for those places. A place of which no check says anything is empty.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from cmverify.case import Measurement
from cmverify.judge.verdict import Verdict
from cmverify.report.summary import CaseResult
from cmverify.report.wording import number, tidy

#: Rows and columns that are shown whether anything covers them or not.
PHYSICS = ("elasticity", "heat conduction", "electrical conduction")
CALIBRATIONS = ("continuum", "lattice", "positive")
TREATMENTS = ("none", "volume", "extrapolated")
HORIZONS = ("3", "5", "7", "other")

Row = tuple[str, str]
Column = tuple[str, str]


@dataclass
class Cell:
    """The checks that say something of one place."""

    verdicts: list[Verdict] = field(default_factory=list)
    primary: list[tuple[float, Verdict]] = field(default_factory=list)

    @property
    def held(self) -> int:
        """Checks that hold."""
        return sum(v.passed for v in self.verdicts)

    @property
    def cases(self) -> list[str]:
        """Whose they are, in their order."""
        return list(dict.fromkeys(v.case for v in self.verdicts))

    @property
    def narrowest(self) -> Verdict | None:
        """The smallest bound on a case's main figure, of what is not zero but for rounding."""
        return min(self.primary, key=lambda item: item[0], default=(0.0, None))[1]


@dataclass(frozen=True)
class Matrix:
    """Cells by row (physics, calibration) and column (treatment, m)."""

    rows: list[Row]
    columns: list[Column]
    cells: dict[tuple[Row, Column], Cell]

    def at(self, row: Row, column: Column) -> Cell | None:
        """The cell of a place, None if nothing covers it."""
        return self.cells.get((row, column))

    @property
    def covered(self) -> int:
        """Places of which a check says something."""
        return len(self.cells)

    @property
    def places(self) -> int:
        """All of them."""
        return len(self.rows) * len(self.columns)


def matrix(summary: Iterable[CaseResult]) -> Matrix:
    """Every check of a summary at the places that its measurement solved scenes at."""
    cells: dict[tuple[Row, Column], Cell] = {}
    for result in summary:
        case = result.case
        exact = {(c.method, c.quantity) for c in case.checks if c.exact}
        for v in result.checks:
            places = set()
            for n in _resolutions(v):
                outcome = result.outcomes.get(v.method, {}).get(n)
                if isinstance(outcome, Measurement):
                    places |= {_place(*setting[:4]) for setting in outcome.scenes}
            for place in sorted(places):
                cell = cells.setdefault(place, Cell())
                cell.verdicts.append(v)
                main = v.kind == "bound" and v.quantity == case.primary and v.margin > 0
                if main and (v.method, v.quantity) not in exact:
                    cell.primary.append((v.value / v.margin, v))
    found = list(cells)
    rows = [(p, c) for p in PHYSICS for c in CALIBRATIONS]
    rows += sorted({row for row, _ in found} - set(rows))
    columns = [(t, m) for t in TREATMENTS for m in HORIZONS]
    columns += sorted({column for _, column in found} - set(columns))
    return Matrix(rows, columns, cells)


def _place(physics: str, calibration: str, surface: str, m: float) -> tuple[Row, Column]:
    horizon = f"{m:g}"
    return (physics, calibration), (surface, horizon if horizon in HORIZONS else "other")


def _resolutions(verdict: Verdict) -> list[int]:
    """Of "a/30" and of "a/30 → a/60"."""
    return [int(part.rsplit("/", 1)[1]) for part in verdict.where.split(" → ")]


def lines(found: Matrix) -> list[tuple[str, ...]]:
    """One line a place, as text: physics, calibration, treatment, m, checks, cases, bound."""
    rows: list[tuple[str, ...]] = []
    for row in found.rows:
        for column in found.columns:
            cell = found.at(row, column)
            if cell is None:
                rows.append((*row, *column, "0", "", ""))
                continue
            share = f"{cell.held}/{len(cell.verdicts)}"
            rows.append((*row, *column, share, ", ".join(cell.cases), bound_of(cell)))
    return rows


def bound_of(cell: Cell) -> str:
    """The narrowest bound of a cell in words; nothing if it has only exact ones or orders."""
    v = cell.narrowest
    if v is None:
        return ""
    return f"{v.case}: {v.quantity} {tidy(v.asked)} at {v.where} ({number(v.value)})"


def as_data(found: Matrix) -> list[dict[str, str | int]]:
    """The same for programs and for the documentation."""
    names: Sequence[str] = ("physics", "calibration", "treatment", "m", "held", "cases", "bound")
    return [dict(zip(names, line, strict=True)) for line in lines(found)]
