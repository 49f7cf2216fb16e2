"""``cmverify run``: measure, have it judged, and have the report written."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from cmverify.case import Level
from cmverify.cases.command import Names, chosen
from cmverify.console import console, interrupted, refuse
from cmverify.report.command import Folder, beside, written

if TYPE_CHECKING:
    from collections.abc import Sequence

    from cmverify.case import Case
    from cmverify.report.summary import RunInfo


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

    cases = chosen(names)
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
    written(beside(judged, info, out, screen), info, out, json, screen)
    raise typer.Exit(0 if summary.all_passed(judged) and agreed else 1)


def _earlier(out: Path) -> RunInfo | None:
    """Info of the run that a folder holds already, or None."""
    from cmverify.report import summary

    try:
        return summary.load_info(out)
    except ValueError:
        return None


def _command(names: list[str] | None, level: Level, jobs: int, out: Path, dask: str | None) -> str:
    parts = ["cmverify run", *(names or []), f"--level {level} --jobs {jobs} --out {out}"]
    if dask is not None:
        parts.append(f"--dask {dask}")
    return " ".join(parts)


def _recorded(out: Path, task: tuple[str, str, int]) -> bool:
    """Whether there is a record of a measurement."""
    from cmverify.run import results

    return results.stem(out, *task).with_suffix(".json").is_file()
