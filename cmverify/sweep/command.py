"""``cmverify sweep``: a scene file over a grid of settings."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Annotated

import typer

from cmverify.console import console, interrupted, refuse


def sweep(
    file: Annotated[Path, typer.Argument(metavar="SWEEP.toml", help="Scene and grid.")],
    out: Annotated[
        Path | None, typer.Option(help="Folder of records and table; the file's name.")
    ] = None,
    jobs: Annotated[int, typer.Option(help="Processes here; 0 for one a core.")] = 1,
    dask: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Dask scheduler that does the work instead."),
    ] = None,
) -> None:
    """Solve a scene at every point of a grid: spacing, m, calibration, surface, angle, material …

    Writes one row a point into sweep.csv (and sweep.parquet where pyarrow is installed). The same
    command goes on where a sweep was stopped. Exit code 0 if every point was solved, or refused by
    the model.
    """
    from cmverify.run.folder import FolderError
    from cmverify.run.threads import available_cores
    from cmverify.sweep import grid, run

    screen = console()
    folder = out or file.with_suffix("")
    try:
        points = grid.read(file)
        number = itertools.count(1)
        found = run.run(
            points,
            folder,
            jobs=jobs or available_cores(),
            dask=dask,
            listen=lambda point, state: screen.print(
                f"{state:<8} {next(number)}/{len(points)}: {_said(point.labels)}"
            ),
        )
    except (ValueError, FolderError) as error:
        refuse(str(error))
    except OSError as error:
        refuse(str(error.strerror or error))
    except KeyboardInterrupt:
        interrupted("finished points are kept; the same command goes on")
    refused = sum(bool(row["refused"]) for row in found.rows)
    screen.print(f"{len(found.rows)} of {len(points)} points are done, {refused} of them refused")
    for point, why in found.missing:
        screen.print(f"failed   {_said(point.labels)}: {why}")
    screen.print("wrote", *map(str, found.paths))
    raise typer.Exit(1 if found.missing else 0)


def _said(labels: dict[str, object]) -> str:
    return ", ".join(f"{name} = {value}" for name, value in labels.items())
