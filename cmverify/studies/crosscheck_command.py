"""`cmverify run --cross-check`: finds FEniCSx, asks it, and says what came of it."""

from __future__ import annotations

import datetime
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from cmverify.case import Case, Level
from cmverify.console import columns, manner, refuse, show

if TYPE_CHECKING:
    from rich.console import Console

    from cmverify.report.crosscheck_chapter import CrossCheck
    from references.fenicsx.bridge import Fenicsx


def found() -> Fenicsx | None:
    """The FEniCSx that will be asked; a setting that names one in vain is refused."""
    from references.fenicsx import bridge

    try:
        return bridge.find()
    except bridge.FenicsxError as error:
        refuse(str(error))


def crosschecked(
    cases: Sequence[Case], level: Level, out: Path, fenicsx: Fenicsx | None, screen: Console
) -> CrossCheck:
    """Cross-check some cases, print it and write it into the report's folder."""
    from cmverify.report import crosscheck_chapter as chapter
    from cmverify.studies import crosscheck
    from references.fenicsx import bridge

    started = datetime.datetime.now().astimezone().isoformat(timespec="seconds")
    if fenicsx is None:
        screen.print(f"The cross-check is skipped. {bridge.INSTALL}", soft_wrap=True)
        new = chapter.CrossCheck([], "", bridge.INSTALL, started)
    else:
        quiet = manner().quiet
        tell = (lambda text: None) if quiet else (lambda text: screen.print(f"FEniCSx: {text} …"))
        rows = crosscheck.rows(cases, level, tell)
        new = chapter.CrossCheck(rows, str(fenicsx), "", started)
        print_rows(screen, new)
    chapter.write(chapter.keeping(new, out, [case.name for case in cases]), out)
    return new


def print_rows(screen: Console, given: CrossCheck) -> None:
    """One line a problem, and the sum of them."""
    lines = [
        (
            "agrees" if row.passed else "FAILS", row.case, row.problem,
            row.failure or f"{row.difference:.1e}", "" if row.failure else f"{row.change:.1e}",
        )
        for row in given.rows
    ]  # fmt: skip
    names = ("FEniCSx", "case", "problem", "same mesh", "finer mesh")
    if lines:
        prose = ("problem", "same mesh")
        show(screen, columns(*names, right=("finer mesh",), prose=prose), lines, keys=3)
    good = len(given.rows) - len(given.failed)
    said = f"{good} of {len(given.rows)} problems agree" if lines else "no finite elements here"
    screen.print(f"Cross-check by {given.fenicsx}: {said}.", soft_wrap=True)
