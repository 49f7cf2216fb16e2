"""Tables for the terminal: verdicts, orders, work against precision."""

from __future__ import annotations

import math
from collections.abc import Sequence
from textwrap import wrap
from typing import Any

from rich.console import Console
from rich.text import Text

from cmverify.case import Case, Level
from cmverify.console import columns, manner, mark, show
from cmverify.exchange.comparison import Comparison
from cmverify.judge import precision
from cmverify.report.summary import INCIDENTS, CaseResult, Row, table, tally
from cmverify.report.wording import tidy
from cmverify.studies import precision as study


def print_cases(screen: Console, cases: Sequence[Case]) -> None:
    """What there is to run, with the spacings of each level."""
    rows = []
    for case in cases:
        ladders = [
            " ".join(map(str, sorted({n for _, n in case.plan(level)}))) or "–" for level in Level
        ]
        rows.append([case.name, case.title, case.section, " ".join(case.tags), *ladders])
    names = ("case", "title", "paper", "tags", *Level)
    show(screen, columns(*names, prose=("title", "paper", "tags", *Level)), rows)


def print_differences(screen: Console, compared: Comparison) -> None:
    """How far a scene's fields are from those of finite elements."""
    rows = [
        [one.quantity, f"{one.l2:.2e}", f"{one.largest:.2e}",
         "" if one.at is None else f"({one.at[0]:.4g}, {one.at[1]:.4g})", f"{one.own:.1e}"]
        for one in compared.differences
    ]  # fmt: skip
    title = (
        f"beside quadratic finite elements of {compared.size:.3g} m, {compared.unknowns:,} unknowns"
    )
    numbers = ("relative L2", "largest", "at", "finite elements' own")
    show(screen, columns("quantity", *numbers, right=numbers), rows, title)
    for note in compared.notes:
        screen.print(note, soft_wrap=True)


def cases_as_data(cases: Sequence[Case]) -> list[dict[str, Any]]:
    """The same for programs: `cmverify list --json`."""
    return [
        {
            "name": case.name,
            "title": case.title,
            "section": case.section,
            "shows": case.shows,
            "tags": list(case.tags),
            "length": case.length,
            "methods": {
                m.name: {str(level): list(ns) for level, ns in m.resolutions.items()}
                for m in case.methods
            },
            "quantities": dict(case.quantities),
            "primary": case.primary,
            "checks": len(case.checks),
        }
        for case in cases
    ]


def print_verdicts(screen: Console, summary: Sequence[CaseResult]) -> None:
    """One line a case with its tightest bound, every failure, and the sum of it all.

    Quiet leaves out the lines of cases, verbose has a line for every check.
    """
    if manner().verbose:
        _print_checks(screen, summary)
    elif not manner().quiet:
        rows: list[list[str | Text]] = []
        for result in summary:
            good = sum(v.passed for v in result.checks)
            row = ["", "", ""]
            if near := result.tightest:
                where = f"{near.quantity}, {near.method}, {near.where}"
                row = [f"{near.value:.3g}", tidy(near.asked), where]
            share = f"{good}/{len(result.checks)}"
            rows.append([mark(result.passed), result.case.name, share, *row])
        names = ("", "case", "checks", "measured", "must hold", "tightest bound")
        right, prose = ("checks", "measured"), ("tightest bound",)
        show(screen, columns(*names, right=right, prose=prose), rows, keys=2)
    for v in (v for result in summary for v in result.verdicts if not v.passed):
        said = "" if v.kind in INCIDENTS else f"{v.value:.4g}, must hold {tidy(v.asked)}. "
        line = Text("✗ FAIL ", style="red").append(
            f"{v.case}: {v.method}, {v.quantity}, {v.where}: {said}{v.message}", style="default"
        )
        screen.print(line, soft_wrap=True)
    print_missing(screen, summary)
    counts = tally(summary)
    screen.print(counts.sentence, style="bold green" if counts.passed else "bold red")


def _print_checks(screen: Console, summary: Sequence[CaseResult]) -> None:
    rows = [
        (mark(v.passed), v.case, v.method, v.quantity, v.where, f"{v.value:.3g}", tidy(v.asked))
        for result in summary
        for v in result.checks
    ]
    names = ("", "case", "method", "quantity", "at", "measured", "must hold")
    show(screen, columns(*names, right=("measured",), prose=("method", "quantity")), rows, keys=2)


#: Missing measurements that are told by name; a run that has just begun lacks hundreds.
NAMED = 12


def print_missing(screen: Console, summary: Sequence[CaseResult]) -> None:
    """What belongs to the run and has no usable record, if anything."""
    missing = [task for result in summary for task in result.missing]
    if missing:
        are = "measurement is" if len(missing) == 1 else "measurements are"
        line = Text(f"{len(missing)} {are} missing: ", style="bold red")
        more = len(missing) - NAMED
        named = ", ".join(missing[:NAMED]) + (f" and {more} more" if more > 0 else "")
        screen.print(line.append(named, style="default"), soft_wrap=True)


#: Longest line of the order tables.
ORDER_WIDTH = 120


def order_lines(summary: Sequence[CaseResult]) -> list[str]:
    """The order table of every case as plain text, a line a measurement, none above 120 columns.

    A case with more quantities than fit has several tables, one below the other.
    """
    lines = []
    for result in summary:
        case = result.case
        rows = table(result)
        names = [q for q in case.quantities if any(q in row.quantities for row in rows)]
        lines.append(f"{case.name}: {case.title}"[:ORDER_WIDTH])
        first = max([16, *(len(row.method) + 2 for row in rows)])
        place_width = max([12, *(len(f"{case.length}/{r.resolution}") + 2 for r in rows)])
        head = 2 + first + place_width
        counts = {c.quantity for c in case.checks if c.equals}
        cells = {q: [_cell(row, q, q in counts) for row in rows] for q in names}
        widths = {q: 2 + max(map(len, [q, *cells[q]])) for q in names}
        blocks = _fitting(widths, ORDER_WIDTH - head - 20, ORDER_WIDTH - head)
        for place, block in enumerate(blocks):
            cost = "" if place else f"{'unknowns':>10}{'seconds':>10}"
            title = "".join(f"{q[: widths[q] - 1]:>{widths[q]}}" for q in block)
            lines.append(f"  {'method':<{first}}{'spacing':>{place_width}}{cost}{title}")
            for i, row in enumerate(rows):
                start = f"  {row.method:<{first}}{f'{case.length}/{row.resolution}':>{place_width}}"
                if row.failure:
                    if not place:
                        said = f"{start}  {row.failure.error}: {row.failure.message}"
                        lines += wrap(said, ORDER_WIDTH, subsequent_indent="    ")
                    continue
                if place and all(cells[q][i] == "–" for q in block):
                    continue
                cost = "" if place else f"{row.unknowns:>10}{row.total:>10.3f}"
                lines.append(start + cost + "".join(f"{cells[q][i]:>{widths[q]}}" for q in block))
    return lines


def _fitting(widths: dict[str, int], first: int, room: int) -> list[list[str]]:
    """Quantities of each table, in their order; the first has less room."""
    blocks: list[list[str]] = [[]]
    used, left = 0, first
    for name, width in widths.items():
        widths[name] = width = min(width, room)
        if (blocks[-1] and used + width > left) or (not blocks[-1] and width > left):
            blocks.append([])
            used, left = 0, room
        blocks[-1].append(name)
        used += width
    return blocks


def _cell(row: Row, name: str, counted: bool) -> str:
    if name not in row.quantities:
        return "–"
    value = row.quantities[name]
    if counted and value == round(value):
        return f"{value:.0f}"
    order = row.orders.get(name, math.nan)
    note = "" if math.isnan(order) else f" ({order:.2f})"
    return f"{value:.2e}{note}"


def print_precision(screen: Console, result: CaseResult, quantity: str | None = None) -> None:
    """Work against precision of one case; methods on the front are starred."""
    case = result.case
    found = precision.points(case, result.outcomes, quantity)
    best = precision.front([p for p in found if p.seconds > 0])
    rows = []
    for p in found:
        series = [q for q in found if q.method == p.method]
        order = precision.order_of(case, series) if p is series[-1] else math.nan
        rows.append(
            (p.method, f"{case.length}/{p.resolution}", str(p.unknowns), f"{p.seconds:.3f}",
             f"{p.error:.2e}", "" if math.isnan(order) else f"{order:.2f}",
             "★" if p in best else "")
        )  # fmt: skip
    right = ("spacing", "unknowns", "seconds", "error", "order")
    title = f"{case.name}: {case.quantities[quantity or case.primary]}"
    show(screen, columns("method", *right, "", right=right), rows, title=title)


def print_study(screen: Console, points: Sequence[study.Point]) -> None:
    """Work against precision with its spread, case by case."""
    right = ("at", "error", "median (s)", "quartiles (s)", "unknowns", "memory (MB)")
    head = columns("method", *right, "", right=right)
    for case, problem in dict.fromkeys((p.case, p.problem) for p in points):
        rows = [
            (p.method, str(p.resolution), f"{p.error:.2e}", f"{p.seconds:.4f}",
             f"{p.fast:.4f} … {p.slow:.4f}", str(p.unknowns), f"{p.memory / 1e6:.1f}",
             {"front": "★", "perhaps": "☆", "beaten": ""}[p.standing])
            for p in points
            if (p.case, p.problem) == (case, problem)
        ]  # fmt: skip
        show(screen, head, rows, title=f"{case}, {problem}" if problem else case)
        screen.print()
