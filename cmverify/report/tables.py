"""How the measurements of a case are laid out, so that no table is wider than the page."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from cmverify.report.summary import Row

#: Columns of figures that fit beside the cost, and where there is none.
BESIDE_COST, WITHOUT_COST = 4, 7


@dataclass(frozen=True)
class Block:
    """A table: "wide" has a line a measurement, "long" one a figure; `cost` with all seconds."""

    shape: Literal["wide", "long"]
    rows: list[Row]
    quantities: list[str]
    cost: bool = False


def blocks(rows: Sequence[Row], quantities: Sequence[str]) -> list[Block]:
    """Tables that hold every figure of a case once.

    Few measurements of many quantities, or methods that share none, are listed figure by figure.
    Otherwise a case with many quantities has several tables; the first has the cost in full, and
    the others repeat its sum.
    """
    timed = any(not math.isnan(row.total) and row.total > 0 for row in rows)
    done = [row for row in rows if row.failure is None]
    room = BESIDE_COST if timed else WITHOUT_COST
    if timed and all("iterations" in r.statistics for r in done if "iterations" in r.quantities):
        quantities = [q for q in quantities if q != "iterations"]  # a column of the cost
    filled = sum(q in row.quantities for row in done for q in quantities)
    sparse = filled < 0.4 * len(done) * len(quantities)
    if len(quantities) > room and (len(rows) <= 2 or sparse) and not timed:
        return [Block("long", list(rows), list(quantities))]
    found: list[Block] = []
    rest = list(quantities)
    while rest or not found:
        part, rest = rest[:room], rest[room:]
        chosen = [r for r in rows if not found or any(q in r.quantities for q in part)]
        found.append(Block("wide", chosen, part, timed and not found))
        room = WITHOUT_COST
    return found
