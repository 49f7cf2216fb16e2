"""``cmverify speed``: measure, judge, draw."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from cmverify.case import Level

_RESOLUTION = {Level.QUICK: 60, Level.STANDARD: 120, Level.PAPER: 120}
#: Cells along the side of the square whose modes are sought.
_MODES = {Level.QUICK: 28, Level.STANDARD: 112, Level.PAPER: 112}
_LADDER = {
    Level.QUICK: (30, 60, 120),
    Level.STANDARD: (30, 60, 120, 240),
    Level.PAPER: (30, 60, 120, 240, 480, 560),
}


def speed(
    level: Annotated[
        Level, typer.Option(help="quick: a/60; standard, paper: a/120.")
    ] = Level.QUICK,
    out: Annotated[Path, typer.Option("--out", help="Folder for the figure and numbers.")] = Path(
        "speed"
    ),
) -> None:
    """Measure the bond solver beside sparse matrices and their solvers, as ratios in one run.

    Ratios are judged from level standard on (a/120) and want a quiet machine; exit code 1 if a
    bound is missed.
    """
    from rich.console import Console

    from cmverify.judge.verdict import Verdict
    from cmverify.run.environment import describe
    from cmverify.studies.speed import measure, modes, verdicts

    console = Console()
    resolution = _RESOLUTION[level]
    tables: dict[str, list[Any]] = {}
    found: list[Verdict] = []
    # Ratios are promised at a/120; smaller bodies are measured but not judged.
    judged = level != Level.QUICK
    studies: tuple[tuple[str, Any, Any], ...] = (
        # First, because peak memory only grows.
        ("Growth", lambda: measure.growth(_LADDER[level]), verdicts.of_growth),
        ("Static scenes", lambda: measure.scenes(resolution), verdicts.of_scenes),
        ("V-cycle", lambda: measure.preconditioner(resolution), verdicts.of_preconditioner),
        ("Surface treatments", lambda: measure.surfaces(resolution), verdicts.of_surfaces),
        (
            "Product with the stiffness",
            lambda: measure.kernel(resolution),
            verdicts.of_kernel if judged else None,
        ),
        (
            "Whole solve",
            lambda: measure.solvers(resolution),
            verdicts.of_solvers if judged else None,
        ),
        (
            "Natural modes",
            lambda: modes.compare(_MODES[level]),
            verdicts.of_modes if judged else None,
        ),
    )
    for title, run, judge in studies:
        # No spinner: its thread would take its share of what is measured.
        console.print(f"{title} …")
        rows = run()
        console.print(_table(title, rows))
        tables[title] = [row.as_dict() for row in rows]
        found += judge(rows) if judge else []
    console.print(_verdict_table(found))
    out.mkdir(parents=True, exist_ok=True)
    document = {
        "machine": describe().as_dict(),
        "level": str(level),
        "tables": tables,
        "verdicts": [v.as_dict() for v in found],
    }
    text = json.dumps(document, indent=1, ensure_ascii=False) + "\n"
    (out / "speed.json").write_text(text, encoding="utf-8")
    from cmverify.studies.speed.figure import draw

    draw(tables, out / "speed.png")
    console.print(f"Figure: {out / 'speed.png'}  (numbers: {out / 'speed.json'})")
    raise typer.Exit(0 if all(v.passed for v in found) else 1)


def _table(title: str, rows: list[Any]) -> Any:
    from rich.table import Table

    view = Table(title=title, box=None, header_style="bold", title_justify="left")
    view.add_column("")
    columns = list(rows[0].values)
    for row in rows[1:]:
        columns += [name for name in row.values if name not in columns]
    for name in columns:
        view.add_column(name, justify="right")
    for row in rows:
        cells = [row.values.get(name, "") for name in columns]
        view.add_row(row.name, *(f"{c:.3g}" if isinstance(c, float) else str(c) for c in cells))
    return view


def _verdict_table(found: list[Any]) -> Any:
    from rich.table import Table

    view = Table(box=None, header_style="bold")
    for column in ("", "what", "measured", "asked"):
        view.add_column(column, justify="right" if column == "measured" else "left")
    for v in found:
        mark = "[green]✓[/]" if v.passed else "[red]✗[/]"
        view.add_row(mark, f"{v.method}: {v.quantity}", f"{v.value:.3g}", v.asked)
    return view
