"""Tables for the terminal: verdicts, orders, work against precision."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rich.console import Console
from rich.table import Table

from cmverify import precision
from cmverify.case import Case, Level
from cmverify.summary import CaseResult, all_passed, table


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
    """The verdict table, failures marked, and the sum of it all."""
    view = Table(box=None, header_style="bold", pad_edge=False)
    for column in ("", "case", "method", "quantity", "at"):
        view.add_column(column)
    view.add_column("measured", justify="right")
    view.add_column("must hold")
    verdicts = [v for result in summary for v in result.verdicts]
    for v in verdicts:
        if v.kind == "ran" and v.passed:
            continue
        mark = "[green]✓[/]" if v.passed else "[red]✗ FAIL[/]"
        view.add_row(mark, v.case, v.method, v.quantity, v.where, f"{v.value:.3g}", v.asked)
        if v.message:
            view.add_row("", "", f"[red]{v.message}[/]")
    console.print(view)
    failed = sum(not v.passed for v in verdicts)
    if all_passed(summary):
        console.print(f"[bold green]All {len(verdicts)} checks hold.[/]")
    else:
        console.print(f"[bold red]{failed} of {len(verdicts)} checks fail.[/]")


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
