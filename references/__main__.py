"""``python -m references list | build | check``: the stored references and their provenance."""

import time
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Table

from references.catalogue import catalogue
from references.provenance import (
    DATA,
    DamagedReferenceError,
    Reference,
    build,
    compare_with_catalogue,
    load,
    regenerate_and_compare,
)

app = typer.Typer(add_completion=False, no_args_is_help=True, help=__doc__)
console = Console()
Names = Annotated[list[str] | None, typer.Argument(help="names; all of them if none is given")]


def _chosen(names: list[str] | None) -> list[Reference]:
    known = catalogue()
    for name in names or []:
        if name not in known:
            console.print(f"[red]no reference {name!r}[/]; known: {', '.join(known)}")
            raise typer.Exit(2)
    return [known[name] for name in names or known]


def _progress() -> Progress:
    columns = (SpinnerColumn(), TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    return Progress(*columns, console=console)


@app.command("list")
def list_() -> None:
    """What is stored, how exact, how large."""
    table = Table("name", "what", "estimated error", "kB", "stored")
    for reference in _chosen(None):
        try:
            stored = load(reference.name)
        except DamagedReferenceError as error:
            table.add_row(reference.name, reference.title, "", "", f"[red]{error}")
            continue
        worst = max(stored.record["estimated_error"].values())
        size = f"{stored.record['bytes'] / 1024:.1f}"
        table.add_row(reference.name, reference.title, f"{worst:.1e}", size, "yes")
    console.print(table)


@app.command("build")
def build_(names: Names = None) -> None:
    """Generate references anew and store them with their records."""
    chosen = _chosen(names)
    with _progress() as progress:
        task = progress.add_task("", total=len(chosen))
        for reference in chosen:
            progress.update(task, description=reference.name)
            start = time.perf_counter()
            stored = build(reference)
            worst = max(stored.record["estimated_error"].values())
            progress.console.print(
                f"{reference.name}: {time.perf_counter() - start:.1f} s,"
                f" {stored.record['bytes'] / 1024:.1f} kB, estimated error {worst:.1e}"
            )
            progress.advance(task)


@app.command()
def check(names: Names = None) -> None:
    """Verify checksums and records, make a part of each reference again (all of some) and compare.

    Some minutes for all; the paths of the compact tension take more than two of them.

    The exit code is 1 if anything is wrong.
    """
    chosen = _chosen(names)
    wrong = 0
    with _progress() as progress:
        task = progress.add_task("", total=len(chosen))
        for reference in chosen:
            progress.update(task, description=reference.name)
            start = time.perf_counter()
            try:
                stored = load(reference.name)
                compare_with_catalogue(reference, stored)
                part = "a part" if reference.spot else "all"
                difference = regenerate_and_compare(reference, stored)
                verdict = f"{part} regenerated, largest difference {difference:.1e}"
                seconds = time.perf_counter() - start
                progress.console.print(
                    f"[green]ok[/] {reference.name}: {verdict} ({seconds:.1f} s)", soft_wrap=True
                )
            except DamagedReferenceError as error:
                wrong += 1
                progress.console.print(f"[red]wrong[/] {error}")
            progress.advance(task)
    known = catalogue()
    for path in sorted(DATA.glob("*.npz")) if names is None else []:
        if path.stem not in known:
            wrong += 1
            console.print(f"[red]wrong[/] {path}: no entry of the catalogue makes this file")
    console.print(f"{len(chosen)} references, {wrong} wrong")
    if wrong:
        raise typer.Exit(1)


if __name__ == "__main__":
    app(prog_name="python -m references")
