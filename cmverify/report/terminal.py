"""Tables for the terminal: verdicts, orders, work against precision."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cmverify.case import Case, Level
from cmverify.judge import precision
from cmverify.report.summary import CaseResult, table, tally


def cases_table(cases: Sequence[Case]) -> Table:
    """What there is to run, with the spacings of each level."""
    view = Table(box=None, header_style="bold", pad_edge=False)
    for column in ("case", "paper", "tags", *Level, "title"):
        view.add_column(column)
    for case in cases:
        ladders = []
        for level in Level:
            sizes = sorted({n for _, n in case.plan(level)})
            ladders.append(" ".join(map(str, sizes)))
        view.add_row(case.name, case.section, " ".join(case.tags), *ladders, case.title)
    return view


def print_verdicts(console: Console, summary: Sequence[CaseResult]) -> None:
    """One line a case with its tightest bound, every failure, and the sum of it all."""
    view = Table(box=None, header_style="bold", pad_edge=False)
    for column in ("", "case", "checks", "tightest bound", "measured", "must hold"):
        view.add_column(column, justify="right" if column in ("checks", "measured") else "left")
    for result in summary:
        good = sum(v.passed for v in result.checks)
        row = ["", "", ""]
        if near := result.tightest:
            row = [f"{near.quantity}, {near.method}, {near.where}", f"{near.value:.3g}", near.asked]
        mark = "[green]✓[/]" if result.passed else "[red]✗[/]"
        view.add_row(mark, result.case.name, f"{good}/{len(result.checks)}", *row)
    console.print(view)
    verdicts = [v for result in summary for v in result.verdicts]
    failed = [v for v in verdicts if not v.passed]
    for v in failed:
        console.print(
            "[red]✗ FAIL[/] "
            + escape(
                f"{v.case}: {v.method}, {v.quantity}, {v.where}: "
                f"{v.value:.4g}, must hold {v.asked}. {v.message}"
            ),
            highlight=False,
        )
    print_missing(console, summary)
    counts = tally(summary)
    style = "bold green" if counts.passed else "bold red"
    console.print(f"[{style}]{escape(counts.sentence)}[/]", highlight=False)


def print_missing(console: Console, summary: Sequence[CaseResult]) -> None:
    """What belongs to the run and has no usable record, if anything."""
    missing = [task for result in summary for task in result.missing]
    if missing:
        are = "measurement is" if len(missing) == 1 else "measurements are"
        console.print(
            f"[bold red]{len(missing)} {are} missing:[/] {escape(', '.join(missing))}",
            highlight=False,
        )


def order_lines(summary: Sequence[CaseResult]) -> list[str]:
    """The order table of every case as plain text, one line a measurement."""
    lines = []
    for result in summary:
        case = result.case
        rows = table(result)
        names = [q for q in case.quantities if any(q in row.quantities for row in rows)]
        lines.append(f"{case.name}: {case.title}")
        lines.append(
            f"  {'method':<16}{'spacing':>9}{'unknowns':>10}{'seconds':>9}"
            + "".join(f"{name:>22}" for name in names)
        )
        for row in rows:
            head = f"  {row.method:<16}{f'{case.length}/{row.resolution}':>9}"
            if row.failure:
                lines.append(f"{head}  {row.failure.error}: {row.failure.message}")
                continue
            cells = "".join(f"{_cell(row.quantities, row.orders, name):>22}" for name in names)
            lines.append(f"{head}{row.unknowns:>10}{row.total:>9.3f}{cells}")
    return lines


def _cell(quantities: dict[str, float], orders: dict[str, float], name: str) -> str:
    if name not in quantities:
        return "–"
    order = orders.get(name, math.nan)
    note = "" if math.isnan(order) else f" (order {order:.2f})"
    return f"{quantities[name]:.2e}{note}"


def precision_table(result: CaseResult, quantity: str | None = None) -> Table:
    """Work against precision of one case; methods on the front are starred."""
    case = result.case
    found = precision.points(case, result.outcomes, quantity)
    best = precision.front([p for p in found if p.seconds > 0])
    view = Table(
        title=f"{case.name}: {case.quantities[quantity or case.primary]}",
        title_justify="left",
        box=None,
        header_style="bold",
        pad_edge=False,
    )
    for column in ("method", "spacing", "unknowns", "seconds", "error", "order", ""):
        view.add_column(column, justify="left" if column in ("method", "") else "right")
    for p in found:
        series = [q for q in found if q.method == p.method]
        order = precision.order_of(case, series) if p is series[-1] else math.nan
        view.add_row(
            p.method, f"{case.length}/{p.resolution}", str(p.unknowns), f"{p.seconds:.3f}",
            f"{p.error:.2e}", "" if math.isnan(order) else f"{order:.2f}",
            "★" if p in best else "",
        )  # fmt: skip
    return view
