"""``cmverify report``, ``precision`` and ``validity``: what a finished run shows."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cmverify.case import Level
from cmverify.cases.command import Names, chosen
from cmverify.console import console, interrupted, manner, refuse

if TYPE_CHECKING:
    from rich.console import Console

    from cmverify.report.summary import CaseResult, RunInfo

Folder = Annotated[Path, typer.Option("--out", help="Folder of the run and its report.")]


def report(
    out: Folder = Path("report"),
    json: Annotated[Path | None, typer.Option(help="Write all numbers to this file.")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace that file.")] = False,
    schema: Annotated[
        bool, typer.Option("--schema", help="Print the JSON schema of results.json, and stop.")
    ] = False,
) -> None:
    """Render the report of a finished run again."""
    if schema:
        from json import dumps

        from cmverify.report import numbers

        typer.echo(dumps(numbers.schema(), indent=1))
        raise typer.Exit(0)
    from cmverify.report import summary, terminal
    from cmverify.run import folder

    judged, info = finished(out)
    screen = console()
    judged = beside(judged, info, out, screen)
    try:
        folder.check_file(out / "results.json")
        if json is not None:
            folder.keep([json], overwrite)
            folder.check_file(json)
    except folder.FolderError as error:
        refuse(str(error))
    terminal.print_missing(screen, judged)
    written(judged, info, out, json, screen)
    raise typer.Exit(0 if summary.all_passed(judged) else 1)


#: Options of `precision` that mean something with ``--measure``, or only without it.
_MEASURED = ("level", "repeats", "method", "resolution", "overwrite")
_FINISHED = ("quantity",)


def precision(
    context: typer.Context,
    names: Names = None,
    quantity: Annotated[str | None, typer.Option(help="Instead of each case's own.")] = None,
    out: Folder = Path("report"),
    measure: Annotated[
        bool, typer.Option("--measure", help="Take errors and, apart and alone, times.")
    ] = False,
    level: Annotated[Level, typer.Option(help="With --measure: how fine.")] = Level.QUICK,
    repeats: Annotated[int, typer.Option(min=3, help="Most repetitions of a time.")] = 5,
    method: Annotated[list[str] | None, typer.Option(help="With --measure: only these.")] = None,
    resolution: Annotated[int | None, typer.Option(min=1, help="One, not the level's.")] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="With --measure: replace an earlier study.")
    ] = False,
) -> None:
    """Show error against time; ★ marks what nothing else beats.

    Of a finished run, or measured anew: without names, the cases tagged work-precision. The
    machine should have nothing else to do. Then `cmverify report` has a chapter of it.
    """
    from cmverify.report import terminal
    from cmverify.studies.precision_command import measured

    for name in _FINISHED if measure else _MEASURED:
        # What would not be heard is not taken.
        source = context.get_parameter_source(name)
        if source is not None and source.name == "COMMANDLINE":
            which = "of a finished run, without" if measure else "of a new study, with"
            refuse(f"--{name} is {which} --measure")
    if measure:
        cases = chosen(names or ["work-precision"])
        measured(cases, level, repeats, method or [], resolution, out, overwrite)
        return
    judged, info = finished(out)
    wanted = {case.name for case in chosen(names)}
    screen = console()
    shown = 0
    for result in judged:
        timed = quantity is None or quantity in result.case.quantities
        if result.case.name in wanted and timed and result.case.timed:
            terminal.print_precision(screen, result, quantity)
            screen.print()
            shown += 1
    if not shown:
        refuse(f"{out} has no timed case of that name or quantity")
    made = f"Level {info.level}, {info.jobs} × {info.threads} threads. {info.command}"
    screen.print(made, soft_wrap=True)


def validity(
    out: Folder = Path("report"),
    json: Annotated[bool, typer.Option("--json", help="Print it as JSON.")] = False,
    gaps: Annotated[bool, typer.Option("--gaps", help="Only what nothing covers.")] = False,
) -> None:
    """Show which physics, calibration, treatment and m the checks of a finished run cover."""
    from cmverify.cases import registry
    from cmverify.console import columns, show
    from cmverify.report import summary
    from cmverify.report import validity as coverage

    judged, info = finished(out)
    found = coverage.matrix(summary.beside(registry.all_cases(), judged, info, out))
    if json:
        from json import dumps

        data = [place for place in coverage.as_data(found) if not gaps or place["held"] == "0"]
        typer.echo(dumps(data, indent=1, ensure_ascii=False))
        return
    lines = [line for line in coverage.lines(found) if not gaps or line[4] == "0"]
    names = ("physics", "calibration", "treatment", "m", "checks", "cases", "narrowest bound")
    prose = ("cases", "narrowest bound")
    screen = console()
    show(screen, columns(*names, right=("m", "checks"), prose=prose), lines, keys=2)
    screen.print(f"{found.covered} of {found.places} places are covered.")


def finished(out: Path) -> tuple[list[CaseResult], RunInfo]:
    """Verdicts and info of the run in a folder, judged anew by the checks as they are now."""
    from cmverify.cases import registry
    from cmverify.report import summary

    try:
        info = summary.load_info(out)
        cases = registry.all_cases()
        known = {(case.name, method.name) for case in cases for method in case.methods}
        for case, method, _ in info.measured:
            if (case, method) not in known:
                refuse(
                    f"the run in {out} measured {case} with {method}, which this version does not "
                    f"know: run it anew"
                )
        return summary.summarise(cases, summary.complete(info, out), info), info
    except ValueError as error:
        refuse(str(error))


def beside(own: list[CaseResult], info: RunInfo, out: Path, screen: Console) -> list[CaseResult]:
    """A run's results with those that its folder keeps of earlier ones; says how they stand."""
    from cmverify.cases import registry
    from cmverify.report import summary
    from cmverify.report.wording import counted

    cases = registry.all_cases()
    if lost := summary.forgotten(cases, info):
        screen.print(f"Not known any more, and left out: {', '.join(lost)}", soft_wrap=True)
    judged = summary.beside(cases, own, info, out)
    kept = len(judged) - len(own)
    if kept:
        bad = [r.case.name for r in judged if r.run is not info and not r.passed]
        state = f"of which fail: {', '.join(bad)}" if bad else "all of which hold"
        said = counted(kept, "case is", "cases are")
        screen.print(f"{said} kept from earlier runs in {out}, {state}.", soft_wrap=True)
    return judged


def written(
    judged: list[CaseResult], info: RunInfo, out: Path, json: Path | None, screen: Console
) -> None:
    """Write the numbers and the page, and say where they are."""
    from cmverify.report import summary
    from cmverify.report.build import build
    from cmverify.run import results

    again = f"the results are kept; render them with: cmverify report --out {out}"
    try:
        numbers = summary.as_json(judged, info)
        for path in {out / "results.json", json or out / "results.json"}:
            results.write_text(path, numbers)
        page = build(judged, info, out)
    except KeyboardInterrupt:
        interrupted(again)
    except OSError as error:
        interrupted(f"the report cannot be written ({error.strerror or error}): {again}")
    if not manner().quiet:
        screen.print(
            f"Report: {page}  (numbers: {out / 'results.json'}, fields: {out / 'fields'})",
            soft_wrap=True,
        )
