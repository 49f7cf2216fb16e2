"""`cmverify precision --measure`: errors, and apart and alone times, of the cases tagged for it."""

from __future__ import annotations

import datetime
import os
from collections.abc import Sequence
from pathlib import Path

from cmverify.case import Case, Level
from cmverify.console import console, manner, refuse


def measured(
    cases: Sequence[Case],
    level: Level,
    repeats: int,
    only: list[str],
    resolution: int | None,
    out: Path,
    overwrite: bool = False,
) -> None:
    """Take errors and times of some cases, print them, and write the report's chapter.

    Parameters
    ----------
    cases : sequence of Case
    level : Level
    repeats : int
        Most repetitions of a time.
    only : list of str
        Names of methods; all of them if empty.
    resolution : int, optional
        One, not those of the level.
    out : Path
        Folder of the report.
    overwrite : bool
        Whether the study takes the place of the one that stands there.
    """

    from cmverify.report import precision_chapter, terminal
    from cmverify.run import environment, folder
    from cmverify.run.threads import available_cores
    from cmverify.studies import precision as study
    from references.fenicsx import bridge

    known = {method.name for case in cases for method in study.methods_of(case)}
    if strange := sorted(set(only) - known):
        refuse(f"no method is called {', '.join(strange)}; known: {', '.join(sorted(known))}")
    try:
        if not (only or resolution):
            names = (precision_chapter.NAME, precision_chapter.TABLE)
            folder.keep([out / name for name in names], overwrite, folder.OTHER_OUT)
        folder.check(out)
    except folder.FolderError as error:
        refuse(str(error))
    screen = console()
    started = datetime.datetime.now().astimezone().isoformat(timespec="seconds")
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0
    tell = (lambda text: None) if manner().quiet else (lambda text: screen.print(f"{text} …"))
    try:
        points, refused = study.measure(cases, level, repeats, only, resolution, tell)
        second = bridge.find()
    except bridge.FenicsxError as error:
        refuse(str(error))
    import numba

    versions = environment.describe().as_dict()
    if second is not None:
        versions["fenicsx"] = ", ".join(f"{name} {v}" for name, v in second.versions.items())

    found = precision_chapter.Study(
        points, refused, str(level), numba.get_num_threads(), available_cores(), load, started,
        versions,
    )  # fmt: skip
    terminal.print_study(screen, points)
    for said in refused:
        screen.print(f"not measured: {said}", soft_wrap=True)
    if found.busy:
        screen.print(
            f"The machine was busy (load {load:.1f}): these times say little.", style="red"
        )
    if only or resolution:
        return  # a point measured again, not a study
    precision_chapter.write(found, out)
    screen.print(f"Points: {out / 'precision.csv'}; the chapter: cmverify report --out {out}",
                 soft_wrap=True)  # fmt: skip
