"""The command line. Heavy libraries are imported inside the commands, so that --help is quick."""

from __future__ import annotations

import io
import sys
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

import cmverify
from cmverify.cases.command import list_cases
from cmverify.console import console, interrupted, manner, refuse, speak
from cmverify.exchange.command import new, schema
from cmverify.exchange.compare_command import compare, export
from cmverify.exchange.solve_command import solve
from cmverify.faults.command import faults
from cmverify.report.command import precision, report, validity
from cmverify.run.command import run
from cmverify.studies.anisotropy.command import material
from cmverify.studies.history_command import history
from cmverify.studies.speed.command import speed
from cmverify.studies.stability.command import stability
from cmverify.sweep.command import sweep

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
app.command("list")(list_cases)
app.command()(run)
app.command()(report)
app.command()(precision)
app.command()(validity)


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
