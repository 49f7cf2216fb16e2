"""The command line. Heavy libraries are imported inside the commands, so that --help is quick."""

from __future__ import annotations

import io
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer
from typer.core import TyperGroup

import cmverify
from cmverify.case import Level
from cmverify.console import console, interrupted, manner, refuse, speak
from cmverify.exchange.command import new, schema
from cmverify.exchange.compare_command import compare, export
from cmverify.exchange.solve_command import solve
from cmverify.faults.command import faults
from cmverify.studies.anisotropy.command import material
from cmverify.studies.history_command import history
from cmverify.studies.speed.command import speed
from cmverify.studies.stability.command import stability
from cmverify.sweep.command import sweep

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.console import Console

    from cmverify.case import Case
    from cmverify.report.summary import CaseResult, RunInfo

#: What the parser raises, whichever library typer builds on.
UsageError: Any = typer.BadParameter.__mro__[1]


class _Commands(TyperGroup):
    """Commands that end with exit code 3 and one line when they are interrupted."""

    def invoke(self, ctx: Any) -> Any:
        from cmverify.run.lifeline import in_good_order

        for name in cmverify.SIBLINGS:
            if (other := cmverify.foreign(name)) and "doctor" not in sys.argv[1:2]:
                refuse(
                    f"another package called {name} was imported first, from {other}: start "
                    f"cmverify without it (cmverify doctor says more)"
                )
        try:
            with in_good_order():
                return super().invoke(ctx)
        except KeyboardInterrupt:
            interrupted("nothing is left half-written; the same command starts anew")
        except (typer.Exit, typer.Abort, UsageError):
            raise
        except MemoryError:
            interrupted("there is not enough memory for it")
        except Exception as error:
            if manner().verbose:
                raise
            said = " ".join(str(error).split())[:300]
            interrupted(
                f"this should not have happened, {type(error).__name__}: {said} "
                f"(cmverify --verbose … shows where)"
            )


app = typer.Typer(
    cls=_Commands,
    no_args_is_help=True,
    # Click's own help: a markup would swallow the brackets of [fracture] and 'cmverify[fenicsx]'.
    rich_markup_mode=None,
    help="Verify and time continuum-molecular models of anisotropic solids.",
)


def _complete(incomplete: str) -> list[str]:
    """Cases and tags that begin so, for the shell."""
    from cmverify.cases import registry

    cases = registry.all_cases()
    known = {case.name for case in cases} | {tag for case in cases for tag in case.tags}
    return sorted(name for name in known if name.startswith(incomplete))


Names = Annotated[
    list[str] | None,
    typer.Argument(metavar="[CASE]...", help="Cases or tags.", autocompletion=_complete),
]
Folder = Annotated[Path, typer.Option("--out", help="Folder of the run and its report.")]


def _show_version(wanted: bool) -> None:
    if wanted:
        from cmverify.run import environment

        here = environment.describe()
        commit = f" (commit {here.commit})" if here.commit else ""
        typer.echo(f"cmverify {here.versions['cmverify']}{commit}, {here.python}")
        raise typer.Exit(0)


@app.callback()
def _manners(
    quiet: Annotated[
        bool, typer.Option("-q", "--quiet", help="No progress, and only what fails.")
    ] = False,
    verbose: Annotated[
        bool, typer.Option("-v", "--verbose", help="Every check, and what the solver remarks.")
    ] = False,
    version: Annotated[
        bool,
        typer.Option("--version", help="Show version and commit.", callback=_show_version,
                     is_eager=True),
    ] = False,
) -> None:  # fmt: skip
    if quiet and verbose:
        refuse("--quiet and --verbose: one of them")
    speak(quiet, verbose)


app.command()(compare)
app.command()(export)
app.command()(faults)
app.command()(history)
app.command()(new)
app.command()(schema)
app.command()(solve)
app.command()(speed)
app.command()(stability)
app.command()(material)
app.command()(sweep)


@app.command("list")
def list_cases(
    names: Names = None,
    json: Annotated[bool, typer.Option("--json", help="Print them as JSON.")] = False,
) -> None:
    """List cases with their tags and the spacings (a/n) of each level."""
    from cmverify.report import terminal

    cases = _select(names)
    if json:
        from json import dumps

        typer.echo(dumps(terminal.cases_as_data(cases), indent=1, ensure_ascii=False))
    else:
        terminal.print_cases(console(), cases)


@app.command()
def run(
    names: Names = None,
    level: Annotated[Level, typer.Option(help="How fine, how long.")] = Level.QUICK,
    jobs: Annotated[int, typer.Option(help="Worker processes; 0 for one a core.")] = 0,
    out: Folder = Path("report"),
    resume: Annotated[bool, typer.Option("--resume", help="Keep finished measurements.")] = False,
    timeout: Annotated[
        float | None, typer.Option(help="Seconds for a single measurement; 3600 by default.")
    ] = None,
    json: Annotated[Path | None, typer.Option(help="Write all numbers to this file.")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace that file.")] = False,
    cross_check: Annotated[
        bool, typer.Option("--cross-check", help="Have FEniCSx solve the finite elements too.")
    ] = False,
    dask: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Dask scheduler whose workers measure instead."),
    ] = None,
) -> None:
    """Run cases, judge them and write the report. Exit code 0 only if every check holds."""
    from cmverify.run import folder
    from cmverify.run.cluster import ClusterError, connected

    cases = _select(names)
    if jobs < 0:
        refuse(f"--jobs {jobs}: at least one worker is needed")
    if dask is not None and (jobs or timeout is not None):
        option = "--jobs" if jobs else "--timeout"
        refuse(f"{option}: a cluster's workers are as many as they are, and end no measurement")
    timeout = 3600.0 if timeout is None else timeout
    if not timeout > 0:
        refuse(f"--timeout {timeout:g}: a measurement needs some time")
    try:
        if json is not None:
            folder.keep([json], overwrite)
            folder.check_file(json)
        folder.require_own(out)
        if dask is not None:
            connected(dask).close()
        with folder.claimed(out):
            _run(cases, names, level, jobs, out, resume, timeout, json, cross_check, dask)
    except (folder.FolderError, ClusterError) as error:
        refuse(str(error))


def _run(
    cases: Sequence[Case],
    names: list[str] | None,
    level: Level,
    jobs: int,
    out: Path,
    resume: bool,
    timeout: float,
    json: Path | None,
    cross_check: bool,
    dask: str | None,
) -> NoReturn:
    """Measure, judge and report, in a folder that is this run's own."""
    import datetime
    import time
    from dataclasses import replace

    from cmverify.report import previous, summary, terminal
    from cmverify.run import environment, runner
    from cmverify.run.progress import LiveProgress
    from cmverify.run.threads import available_cores, threads_per_worker
    from cmverify.studies import crosscheck_command

    fenicsx = crosscheck_command.found() if cross_check else None
    jobs = jobs or available_cores()
    screen = console()
    # Runs are told apart by when they began.
    started, clock = datetime.datetime.now().astimezone(), time.perf_counter()
    plan = runner.plan(cases, level)
    earlier = _earlier(out)
    info = summary.RunInfo(
        level=str(level),
        jobs=jobs,
        threads=threads_per_worker(jobs),
        command=_command(names, level, jobs, out, dask),
        started=started.isoformat(timespec="milliseconds"),
        wall_seconds=0.0,
        environment=environment.describe().as_dict(),
        measured=[list(task) for task in plan],
        finished=False,
    )
    if earlier is not None:
        info = info.keeping(earlier)
    go_on = f"go on with: {info.command} --resume"
    try:
        # Before anything is measured: what a killed run has finished can be reported.
        summary.save_info(info, out)
        if not resume:
            previous.set_aside(out)
        with LiveProgress(screen, len(plan), {c.name: c.length for c in cases}) as live:
            records = runner.run(
                cases, level, out, jobs=jobs, resume=resume, timeout=timeout, listen=live.listen,
                dask=dask,
            )  # fmt: skip
        info = replace(info, wall_seconds=time.perf_counter() - clock, finished=True)
        if dask is not None:
            info = replace(info, threads=max(record.threads for record in records))
        summary.save_info(info, out)
    except KeyboardInterrupt:
        done = sum(1 for task in plan if _recorded(out, task))
        interrupted(f"{done} of {len(plan)} measurements are finished and kept; {go_on}")
    except OSError as error:
        interrupted(f"{error.strerror or error}; what is finished is kept; {go_on}")
    judged = summary.summarise(cases, records, info)
    terminal.print_verdicts(screen, judged)
    agreed = True
    if cross_check:
        try:
            other = crosscheck_command.crosschecked(cases, level, out, fenicsx, screen)
        except KeyboardInterrupt:
            interrupted(f"the results are kept; render them with: cmverify report --out {out}")
        agreed = not other.failed
    _write(_beside(judged, info, out, screen), info, out, json, screen)
    raise typer.Exit(0 if summary.all_passed(judged) and agreed else 1)


@app.command()
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

    judged, info = _finished(out)
    screen = console()
    judged = _beside(judged, info, out, screen)
    try:
        folder.check_file(out / "results.json")
        if json is not None:
            folder.keep([json], overwrite)
            folder.check_file(json)
    except folder.FolderError as error:
        refuse(str(error))
    terminal.print_missing(screen, judged)
    _write(judged, info, out, json, screen)
    raise typer.Exit(0 if summary.all_passed(judged) else 1)


@app.command()
def precision(
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

    if measure:
        cases = _select(names or ["work-precision"])
        measured(cases, level, repeats, method or [], resolution, out, overwrite)
        return
    judged, info = _finished(out)
    wanted = {case.name for case in _select(names)}
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


@app.command()
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

    judged, info = _finished(out)
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


@app.command()
def errata(
    number: Annotated[
        str | None, typer.Argument(metavar="[EQUATION]", help="Show one, such as 79, in full.")
    ] = None,
    every: Annotated[bool, typer.Option("--all", help="Show what is right too.")] = False,
    json: Annotated[bool, typer.Option("--json", help="Print everything as JSON.")] = False,
    page: Annotated[Path | None, typer.Option(help="Write everything as an HTML page.")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace that page.")] = False,
) -> None:
    """Judge the paper's equations and numbers, and prove each judgement."""
    from cmverify import errata as audit
    from cmverify.run import folder

    try:
        if page is not None:
            folder.keep([page], overwrite)
    except folder.FolderError as error:
        refuse(str(error))
    from references import errata as paper

    try:
        chosen = [paper.entry(number)] if number is not None else paper.entries()
        if page is not None:
            folder.check_file(page)
    except KeyError as error:
        refuse(error.args[0])
    except folder.FolderError as error:
        refuse(str(error))
    if json:
        judged = [audit.judge(entry) for entry in chosen]
        typer.echo(audit.as_json(judged))
        raise typer.Exit(1 if any(item.failed for item in judged) else 0)
    if page is not None:
        from cmverify.report.errata_page import write_page

        failed = write_page([audit.judge(entry) for entry in chosen], page)
        typer.echo(f"{page}")
        raise typer.Exit(1 if failed else 0)
    if number is not None:
        raise typer.Exit(0 if audit.print_one(console(), number) else 1)
    raise typer.Exit(0 if audit.print_errata(console(), not every) else 1)


@app.command()
def doctor() -> None:
    """Say whether everything that a run needs is here. Exit code 1 if something is missing."""
    from rich.text import Text

    from cmverify.console import columns, show
    from cmverify.doctor import examine

    colours = {"ok": "green", "note": "yellow", "problem": "red"}
    found = list(examine())
    rows = [(Text(f.state, style=colours[f.state]), f.subject, f.detail) for f in found]
    show(console(), columns("state", "of", "what was found", prose=("what was found",)), rows)
    states = {finding.state for finding in found}
    raise typer.Exit(1 if "problem" in states else 0)


def main() -> None:
    """Entry point of the `cmverify` script."""
    for stream in (sys.stdout, sys.stderr):
        # A terminal that cannot show a sign shows another one.
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    app()


def _select(names: list[str] | None) -> tuple[Case, ...]:
    from cmverify.cases import registry

    try:
        return registry.select(names or [])
    except ValueError as error:
        refuse(str(error))


def _finished(out: Path) -> tuple[list[CaseResult], RunInfo]:
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


def _earlier(out: Path) -> RunInfo | None:
    """Info of the run that a folder holds already, or None."""
    from cmverify.report import summary

    try:
        return summary.load_info(out)
    except ValueError:
        return None


def _beside(own: list[CaseResult], info: RunInfo, out: Path, screen: Console) -> list[CaseResult]:
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


def _write(
    judged: list[CaseResult], info: RunInfo, out: Path, json: Path | None, screen: Console
) -> None:
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


def _command(names: list[str] | None, level: Level, jobs: int, out: Path, dask: str | None) -> str:
    parts = ["cmverify run", *(names or []), f"--level {level} --jobs {jobs} --out {out}"]
    if dask is not None:
        parts.append(f"--dask {dask}")
    return " ".join(parts)


def _recorded(out: Path, task: tuple[str, str, int]) -> bool:
    """Whether there is a record of a measurement."""
    from cmverify.run import results

    return results.stem(out, *task).with_suffix(".json").is_file()
