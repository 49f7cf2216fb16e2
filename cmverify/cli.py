"""The command line. Heavy libraries are imported inside the commands, so that --help is quick."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cmverify.case import Level
from cmverify.faults.command import faults
from cmverify.studies.speed.command import speed
from cmverify.studies.stability.command import stability

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    help="Verify and time continuum-molecular models of anisotropic solids.",
)

Names = Annotated[list[str] | None, typer.Argument(metavar="[CASE]...", help="Cases or tags.")]
Folder = Annotated[Path, typer.Option("--out", help="Folder of the run and its report.")]


app.command()(faults)
app.command()(speed)
app.command()(stability)


@app.command("list")
def list_cases(names: Names = None) -> None:
    """List cases with their tags and the spacings (a/n) of each level."""
    from rich.console import Console

    from cmverify.report import terminal

    Console().print(terminal.cases_table(_select(names)))


@app.command()
def run(
    names: Names = None,
    level: Annotated[Level, typer.Option(help="How fine, how long.")] = Level.QUICK,
    jobs: Annotated[int, typer.Option(help="Worker processes; 0 for one a core.")] = 0,
    out: Folder = Path("report"),
    resume: Annotated[bool, typer.Option("--resume", help="Keep finished measurements.")] = False,
    timeout: Annotated[float, typer.Option(help="Seconds for a single measurement.")] = 3600.0,
    json: Annotated[Path | None, typer.Option(help="Write all numbers to this file.")] = None,
) -> None:
    """Run cases, judge them and write the report. Exit code 0 only if every check holds."""
    import datetime
    import time

    from rich.console import Console

    from cmverify.report import summary, terminal
    from cmverify.run import environment, runner
    from cmverify.run.progress import LiveProgress
    from cmverify.run.threads import available_cores, threads_per_worker

    cases = _select(names)
    jobs = jobs or available_cores()
    if jobs < 0:
        _refuse(f"--jobs {jobs}: at least one worker is needed")
    console = Console()
    started, clock = datetime.datetime.now().astimezone(), time.perf_counter()
    total = sum(1 for case in cases for _ in case.plan(level))
    with LiveProgress(console, total) as live:
        records = runner.run(
            cases, level, out, jobs=jobs, resume=resume, timeout=timeout, listen=live.listen
        )
    wall = time.perf_counter() - clock
    info = summary.RunInfo(
        level=str(level),
        jobs=jobs,
        threads=threads_per_worker(jobs),
        command=_command(names, level, jobs, out),
        started=started.isoformat(timespec="seconds"),
        wall_seconds=wall,
        environment=environment.describe().as_dict(),
        measured=[[r.case, r.method, r.resolution] for r in records],
    )
    summary.save_info(info, out)
    judged = summary.summarise(cases, records)
    terminal.print_verdicts(console, judged)
    _write(judged, info, out, json, console)
    raise typer.Exit(0 if summary.all_passed(judged) else 1)


@app.command()
def report(
    out: Folder = Path("report"),
    json: Annotated[Path | None, typer.Option(help="Write all numbers to this file.")] = None,
) -> None:
    """Render the report of a finished run again."""
    from rich.console import Console

    from cmverify.report import summary

    judged, info = _finished(out)
    _write(judged, info, out, json, Console())
    raise typer.Exit(0 if summary.all_passed(judged) else 1)


@app.command()
def precision(
    names: Names = None,
    quantity: Annotated[str | None, typer.Option(help="Instead of each case's own.")] = None,
    out: Folder = Path("report"),
) -> None:
    """Show error against time of a finished run; ★ marks what nothing else beats."""
    from rich.console import Console

    from cmverify.report import terminal

    judged, info = _finished(out)
    wanted = {case.name for case in _select(names)}
    console = Console()
    shown = 0
    for result in judged:
        timed = quantity is None or quantity in result.case.quantities
        if result.case.name in wanted and timed and result.case.timed:
            console.print(terminal.precision_table(result, quantity), "")
            shown += 1
    if not shown:
        _refuse(f"{out} has no timed case of that name or quantity")
    console.print(f"Level {info.level}, {info.jobs} × {info.threads} threads. {info.command}")


@app.command()
def errata(
    every: Annotated[bool, typer.Option("--all", help="Show confirmed equations too.")] = False,
) -> None:
    """List the printed equations that do not hold, and prove each correction."""
    from rich.console import Console

    from cmverify.errata import print_errata

    raise typer.Exit(0 if print_errata(Console(), not every) else 1)


@app.command()
def doctor() -> None:
    """Say whether everything that a run needs is here. Exit code 1 if something is missing."""
    from rich.console import Console
    from rich.table import Table

    from cmverify.doctor import examine

    view = Table(box=None, show_header=False, pad_edge=False)
    states = set()
    marks = {"ok": "[green]ok[/]", "note": "[yellow]note[/]", "problem": "[red]problem[/]"}
    for finding in examine():
        states.add(finding.state)
        view.add_row(marks[finding.state], finding.subject, finding.detail)
    Console().print(view)
    raise typer.Exit(1 if "problem" in states else 0)


@app.command()
def solve(
    scene: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="Scene to solve.")],
    out: Annotated[
        Path | None, typer.Option(help="Path of the fields without suffix; the scene's name.")
    ] = None,
) -> None:
    """Solve a scene file, or let its cracks grow, and write its fields as .vtu and .npz."""
    from rich.console import Console

    from cmverify.exchange import fracture_table, scene_file
    from cmverify.exchange.export import write_arrays

    base = out or scene.with_suffix("")
    paths: tuple[Path, ...]
    try:
        described, options = scene_file.read(scene)
        plan = scene_file.read_fracture(scene)
        if plan is None:
            solution = described.solve(**options)
            said = solution.statistics.as_dict()
            paths = write_arrays(solution.points, scene_file.fields(solution), base)
        else:
            run = plan.run(described)
            said = fracture_table.summary(run)
            paths = fracture_table.write(run, scene_file.fields(run.solution), base)
    except (ValueError, RuntimeError) as error:
        _refuse(str(error))
    console = Console()
    for name, value in said.items():
        console.print(
            f"{name.replace('_', ' '):<16}{value:.4g}"
            if isinstance(value, float)
            else f"{name.replace('_', ' '):<16}{value}"
        )
    console.print("wrote", *map(str, paths))


def main() -> None:
    """Entry point of the `cmverify` script."""
    app()


def _select(names: list[str] | None):  # type: ignore[no-untyped-def]
    from cmverify.cases import registry

    try:
        return registry.select(names or [])
    except ValueError as error:
        _refuse(str(error))


def _finished(out: Path):  # type: ignore[no-untyped-def]
    """Verdicts and info of the run in a folder, judged anew by the checks as they are now."""
    from cmverify.cases import registry
    from cmverify.report import summary
    from cmverify.run import results

    try:
        info = summary.load_info(out)
        own = {tuple(task) for task in info.measured}
        known = results.load_all(out)
        records = [r for r in known if (r.case, r.method, r.resolution) in own]
        return summary.summarise(registry.all_cases(), records), info
    except ValueError as error:
        _refuse(str(error))


def _write(judged, info, out: Path, json: Path | None, console) -> None:  # type: ignore[no-untyped-def]
    from cmverify.report import summary
    from cmverify.report.build import build
    from cmverify.run import results

    numbers = summary.as_json(judged, info)
    for path in {out / "results.json", json or out / "results.json"}:
        results.write_text(path, numbers)
    page = build(judged, info, out)
    console.print(f"Report: {page}  (numbers: {out / 'results.json'}, fields: {out / 'fields'})")


def _command(names: list[str] | None, level: Level, jobs: int, out: Path) -> str:
    parts = ["cmverify run", *(names or []), f"--level {level} --jobs {jobs} --out {out}"]
    return " ".join(parts)


def _refuse(message: str) -> None:
    """Print an error and leave with code 2."""
    typer.secho(f"error: {message}", fg=typer.colors.RED, err=True)
    raise typer.Exit(2)
