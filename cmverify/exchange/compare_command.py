"""``cmverify export`` and ``cmverify compare``: cases for other programs, and their answers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from cmverify.case import Level
from cmverify.console import refuse

Problem = Annotated[
    str | None, typer.Option(help="Which of a case's problems; the first by default.")
]
Chosen = Annotated[Level, typer.Option(help="The finest spacing of this level.")]
Resolution = Annotated[
    int | None, typer.Option(help="n of a spacing length/n, instead of a level.")
]


def export(
    name: Annotated[
        str | None, typer.Argument(metavar="[CASE]", help="Without one: what can be exported.")
    ] = None,
    problem: Problem = None,
    level: Chosen = Level.QUICK,
    resolution: Resolution = None,
    out: Annotated[Path | None, typer.Option(help="Folder of the files; the case's name.")] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace files of an earlier export.")
    ] = False,
) -> None:
    """Write a case as plain files for another program: body, solid, supports, loads, references.

    case.json says what each file holds. Solve it with what you have, then: cmverify compare.
    """
    from cmverify.cases import registry
    from cmverify.console import columns, console, show
    from cmverify.exchange.case_export import files_in, pose_of, write_case
    from cmverify.exchange.compare import resolution_of
    from cmverify.run import folder

    screen = console()
    if name is None:
        rows = [
            (case.name, ", ".join(p.name for p in case.poses if p.name), case.title)
            for case in registry.all_cases()
            if case.poses
        ]
        show(screen, columns("case", "problems", "title", prose=("problems", "title")), rows)
        return
    try:
        case = registry.get(name)
        pose = pose_of(case, problem)
        n = resolution_of(case, pose, level, resolution)
        place = out or Path(case.name)
        folder.keep(files_in(place), overwrite, folder.OTHER_OUT)
        folder.check_file(place / "case.json")
        paths = write_case(case, pose, n, place)
    except ValueError as error:
        refuse(str(error))
    except OSError as error:
        refuse(f"{out or name} cannot be written: {error.strerror or error}")
    screen.print("wrote", *map(str, paths), soft_wrap=True)


def compare(
    name: Annotated[str, typer.Argument(metavar="CASE", help="The case that was exported.")],
    answers: Annotated[
        list[str],
        typer.Argument(
            metavar="[NAME=]FILE...", help="Results: .npz, .csv, .json, .vtu or a .pvd series."
        ),
    ],
    problem: Problem = None,
    level: Chosen = Level.QUICK,
    resolution: Resolution = None,
    held_to: Annotated[
        str | None, typer.Option("--bounds-of", help="Our method whose bounds must hold.")
    ] = None,
    run: Annotated[
        Path | None, typer.Option(help="Take our result from this run's folder if it is there.")
    ] = None,
    out: Annotated[Path, typer.Option("--out", help="Folder of the page.")] = Path("comparison"),
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace an earlier comparison.")
    ] = False,
) -> None:
    """Judge results of other programs as ours are, and write the report with both side by side.

    Exit code 0 only if every bound holds.
    """
    from cmverify.cases import registry
    from cmverify.console import console
    from cmverify.exchange import answers as reading
    from cmverify.exchange import compare as judging
    from cmverify.exchange.case_export import pose_of
    from cmverify.report import summary, terminal
    from cmverify.run import folder

    try:
        earlier = (out / "index.html", out / "results.json")
        folder.keep(earlier, overwrite, folder.OTHER_OUT)
        case = registry.get(name)
        pose = pose_of(case, problem)
        n = judging.resolution_of(case, pose, level, resolution)
        targets = pose.state(n).targets
        read = [_read(given, targets, reading) for given in answers]
        folder.check(out)
        ours = judging.our_record(case, pose, n, run)
        found = judging.compare(case, pose, n, read, ours, held_to)
    except ValueError as error:
        refuse(str(error))
    judged = summary.summarise([found.case], found.records)
    screen = console()
    terminal.print_verdicts(screen, judged)
    for line in terminal.order_lines(judged):
        screen.print(line, soft_wrap=True)
    for one in read:
        for note in one.notes:
            screen.print(f"{one.name}: {note}", soft_wrap=True)
    for answer, quantities in found.absent.items():
        if quantities:
            screen.print(f"{answer} says nothing about: {', '.join(quantities)}", soft_wrap=True)
    try:
        page = _report(judged, _info(case.name, answers, problem, level, n, ours, out), out)
    except OSError as error:
        refuse(f"the page cannot be written to {out}: {error.strerror or error}")
    screen.print(f"Page: {page}  (numbers: {out / 'results.json'})", soft_wrap=True)
    raise typer.Exit(0 if summary.all_passed(judged) else 1)


def _read(given: str, targets: Any, reading: Any) -> Any:
    """An answer from FILE or NAME=FILE."""
    from dataclasses import replace

    name, equals, rest = given.partition("=")
    if equals and not Path(given).exists():
        return replace(reading.read(Path(rest), targets), name=name)
    return reading.read(Path(given), targets)


def _report(judged: Any, info: Any, out: Path) -> Path:
    from cmverify.report import summary
    from cmverify.report.build import build
    from cmverify.run import results

    results.write_text(out / "results.json", summary.as_json(judged, info))
    return build(judged, info, out)


def _info(
    name: str, answers: list[str], problem: str | None, level: Level, n: int, ours: Any, out: Path
) -> Any:
    import datetime

    from cmverify.report import summary
    from cmverify.run import environment

    parts = ["cmverify compare", name, *answers, f"--resolution {n} --out {out}"]
    if problem is not None:
        parts.append(f'--problem "{problem}"')
    return summary.RunInfo(
        level=str(level),
        jobs=1,
        threads=ours.threads,
        command=" ".join(parts),
        started=datetime.datetime.now().astimezone().isoformat(timespec="seconds"),
        wall_seconds=ours.wall_seconds,
        environment=environment.describe().as_dict(),
    )
