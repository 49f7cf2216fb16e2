"""``cmverify speed``: measure, judge, draw."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from cmverify.case import Level
from cmverify.console import refuse

_RESOLUTION = {Level.QUICK: 60, Level.STANDARD: 120, Level.PAPER: 120}
#: Cells along the side of the square whose modes are sought.
_MODES = {Level.QUICK: 28, Level.STANDARD: 112, Level.PAPER: 112}
#: Errors to which a calibrated tip and a graded mesh are timed.
_TIP_ERRORS = {
    Level.QUICK: (4e-4,),
    Level.STANDARD: (4e-4, 1e-4),
    Level.PAPER: (4e-4, 1e-4),
}
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
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace these files.")] = False,
) -> None:
    """Measure the bond solver beside sparse matrices and their solvers, as ratios in one run.

    Ratios are judged from level standard on (a/120) and want a quiet machine; exit code 1 if a
    bound is missed.
    """
    from cmverify.console import console
    from cmverify.judge.verdict import Verdict
    from cmverify.run import folder
    from cmverify.run.environment import describe
    from cmverify.run.results import write_text
    from cmverify.studies.speed import accuracy, measure, modes, page, verdicts

    screen = console()
    try:
        earlier = (out / "speed.json", out / "speed.png", out / page.NAME)
        folder.keep(earlier, overwrite, folder.OTHER_OUT)
        folder.check_file(out / "speed.json")
    except folder.FolderError as error:
        refuse(str(error))
    resolution = _RESOLUTION[level]
    tables: dict[str, list[Any]] = {}
    found: list[Verdict] = []
    # Ratios are promised at a/120; smaller bodies are measured but not judged.
    judged = level != Level.QUICK
    studies: tuple[tuple[str, Any, Any], ...] = (
        # First, because peak memory only grows.
        ("Growth", lambda: measure.growth(_LADDER[level]), verdicts.of_growth),
        ("Static scenes", lambda: measure.scenes(resolution), verdicts.of_scenes),
        (
            "V-cycle",
            lambda: measure.preconditioner(resolution),
            lambda rows: verdicts.of_preconditioner(rows, ratios=judged),
        ),
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
            "Whole solve, heat",
            lambda: measure.heat(resolution),
            verdicts.of_heat if judged else None,
        ),
        (
            "To an error of 1e-6, smooth field in the disc",
            accuracy.to_an_error,
            verdicts.of_accuracy if judged else None,
        ),
        (
            "To an error at a crack tip, tips calibrated before",
            lambda: accuracy.at_a_tip(_TIP_ERRORS[level]),
            None,
        ),
        (
            "Natural modes",
            lambda: modes.compare(_MODES[level]),
            verdicts.of_modes if judged else None,
        ),
    )
    for title, run, judge in studies:
        # No spinner: its thread would take its share of what is measured.
        screen.print(f"{title} …")
        rows = run()
        _show(screen, title, rows)
        tables[title] = [row.as_dict() for row in rows]
        found += judge(rows) if judge else []
    _show_verdicts(screen, found)
    document = {
        "machine": describe().as_dict(),
        "level": str(level),
        "command": f"cmverify speed --level {level} --out {out}",
        "tables": tables,
        "verdicts": [v.as_dict() for v in found],
    }
    text = json.dumps(document, indent=1, ensure_ascii=False) + "\n"
    write_text(out / "speed.json", text)
    from cmverify.studies.speed.figure import draw

    draw(tables, out / "speed.png")
    written = page.write(document, found, out / "speed.png")
    screen.print(f"Page: {written}  (numbers: {out / 'speed.json'})", soft_wrap=True)
    raise typer.Exit(0 if all(v.passed for v in found) else 1)


def _show(screen: Any, title: str, rows: list[Any]) -> None:
    """One study: a line a row, columns in the order in which the rows name them."""
    from cmverify.console import columns, show

    names = list(dict.fromkeys(name for row in rows for name in row.values))
    lines = []
    for row in rows:
        cells = [row.values.get(name, "") for name in names]
        lines.append([row.name, *(f"{c:.3g}" if isinstance(c, float) else str(c) for c in cells)])
    show(screen, columns("", *names, right=names), lines, title=title)


def _show_verdicts(screen: Any, found: list[Any]) -> None:
    from cmverify.console import columns, mark, show

    rows = [(mark(v.passed), f"{v.method}: {v.quantity}", f"{v.value:.3g}", v.asked) for v in found]
    head = columns("", "what", "measured", "asked", right=("measured",), prose=("what",))
    show(screen, head, rows, keys=2)
