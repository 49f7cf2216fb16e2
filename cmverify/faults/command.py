"""``cmverify faults``: try every fault on the cases that can see it, and say who does."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cmverify.case import Level
from cmverify.console import refuse

if TYPE_CHECKING:
    from cmverify.faults.table import Result


def faults(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="[FAULT]...", help="Faults or their kinds.")
    ] = None,
    every: Annotated[
        bool,
        typer.Option("--all", help="Try all cases that call the function, not the known two."),
    ] = False,
    once: Annotated[
        bool, typer.Option("--once", help="One case a fault is enough: half the time.")
    ] = False,
    remember: Annotated[
        bool,
        typer.Option(
            "--remember",
            help="Look for a second case where none is known, and keep which cases catch what.",
        ),
    ] = False,
    seconds: Annotated[
        float, typer.Option(help="With --remember: for a second case, a fault.", min=0.0)
    ] = 30.0,
    level: Annotated[
        Level, typer.Option("--level", help="At which cases are measured; standard takes hours.")
    ] = Level.QUICK,
    jobs: Annotated[int, typer.Option(help="Worker processes; 0 for one a core.")] = 0,
    out: Annotated[Path, typer.Option("--out", help="Folder of the page.")] = Path("report"),
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the page.")] = False,
) -> None:
    """Put faults into solver, references and judges, and see which cases fail.

    Exit code 0 only if every fault is caught by a case, or argued to be harmless.
    """
    from cmverify.console import console
    from cmverify.faults import page, registry, table, trial
    from cmverify.run import folder
    from cmverify.run.threads import available_cores

    if every and once:
        refuse("--once asks for one case a fault, --all for all of them: give one")
    if remember and level is not Level.QUICK:
        refuse("--remember keeps what level quick catches: leave --level out")
    known = registry.all_faults()
    wanted = set(names or ())
    strange = wanted - {f.name for f in known} - {f.kind for f in known}
    if strange:
        refuse(
            f"no fault and no kind of faults is called {', '.join(sorted(strange))}; known "
            f"kinds: {', '.join(sorted({f.kind for f in known}))}"
        )
    chosen = [f for f in known if not wanted or f.name in wanted or f.kind in wanted]
    try:
        folder.keep([out / page.NAME], overwrite, folder.OTHER_OUT)
        folder.check_file(out / page.NAME)
    except folder.FolderError as error:
        refuse(str(error))
    screen = console()
    with screen.status("") as status:
        results = table.attempt(
            chosen,
            {} if every else table.read_map(),
            jobs or available_cores(),
            enough=10_000 if every else 1 if once else trial.ENOUGH,
            seconds=seconds if remember else 0.0,
            listen=lambda what, done, total: status.update(f"{done} of {total}: {what}"),
            level=level,
        )
    if remember:
        table.write_map(results)
    path = page.write(results, _command(names, every, once, level, out), out, once)
    _print(screen, results, once)
    screen.print(f"Page: {path}", soft_wrap=True)
    raise typer.Exit(0 if all(r.good for r in results) else 1)


def _print(screen, results: list[Result], once: bool) -> None:  # type: ignore[no-untyped-def]
    from cmverify.console import columns, mark, show
    from cmverify.faults import alone

    rows = [
        (mark(True if r.catching else None if r.good else False), r.fault.name, r.fault.kind,
         r.state, _who(r))
        for r in results
    ]  # fmt: skip
    head = columns("", "fault", "kind", "state", "caught by", prose=("fault", "caught by"))
    show(screen, head, rows, keys=2)
    tally = alone.Tally.of(results)
    if not once:
        for why, faults in tally.groups.items():
            names = "; ".join(f"{r.fault.name} ({r.cases[0]})" for r in faults)
            screen.print(f"Caught by one case: {why}.\n  {names}", soft_wrap=True, highlight=False)
    colour = "green" if all(r.good for r in results) else "red"
    screen.print(tally.sentence(once), style=f"bold {colour}", soft_wrap=True)


def _who(result: Result) -> str:
    more = len(result.cases) - 3
    return ", ".join(result.cases[:3]) + (f" and {more} more" if more > 0 else "")


def _command(names: list[str] | None, every: bool, once: bool, level: Level, out: Path) -> str:
    parts = ["cmverify faults", *(f'"{n}"' for n in names or [])]
    parts += ["--all"] if every else ["--once"] if once else []
    parts += [] if level is Level.QUICK else [f"--level {level.value}"]
    return " ".join([*parts, f"--out {out}"])
