"""``cmverify solve``: do what a scene file asks for."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from cmverify.console import console, interrupted, manner, refuse


class Compared(StrEnum):
    """What a scene is solved with beside the lattice."""

    FEM = "fem"


def solve(
    scene: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="Scene to solve.")],
    out: Annotated[
        Path | None, typer.Option(help="Path of the fields without suffix; the scene's name.")
    ] = None,
    max_memory: Annotated[
        float | None, typer.Option(min=0.0, help="GiB it may take; most of what is free.")
    ] = None,
    max_minutes: Annotated[
        float, typer.Option(min=0.0, help="Estimated minutes that a solve may take.")
    ] = 15.0,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace files of an earlier run.")
    ] = False,
    compare: Annotated[
        Compared | None, typer.Option(help="Solve the scene by finite elements, too.")
    ] = None,
) -> None:
    """Do what a scene file asks for, and write its fields as .vtu and .npz."""
    from rich.text import Text

    from cmverify.exchange import comparison, scene_file
    from cmverify.exchange.export import check_writable
    from cmverify.exchange.output import existing, existing_series
    from cmverify.exchange.told import lines
    from cmverify.run.progress import share_done

    screen = console()
    if not scene.name or scene.is_dir():
        refuse(f"{scene} is a folder, and a scene is a file")
    base = out or scene.with_suffix("")
    try:
        if out is not None and out.is_dir():
            refuse(f"--out names files without their suffix, and {out} is a folder")
        if not overwrite and (there := existing(base)):
            names = ", ".join(path.name for path in there)
            refuse(f"{base.parent} has {names} already: choose another --out, or --overwrite")
        request = scene_file.request(
            scene,
            None if max_memory is None else max_memory * 2**30,
            max_minutes * 60,
        )
        if not overwrite and (there := existing_series(request.options)):
            more = f" and {len(there) - 1} more" if len(there) > 1 else ""
            refuse(f"the series {there[0]}{more} exists already: name another, or --overwrite")
        comparing = compare is not None or request.file.compare is not None
        if comparing:
            comparison.check(request)
        check_writable(base)
        if request.cost.told and not manner().quiet:
            screen.print(request.cost.told, soft_wrap=True)
        with share_done(screen, request.analysis) as tell:
            result = request.run(tell)
        said, paths = result.summary(), result.write(base)
        beside = None
        if comparing:
            try:
                beside = comparison.compare(request, result)
            except ValueError as error:
                refuse(f"{error}; the scene's own result is in {', '.join(map(str, paths))}")
            paths = (*paths, *beside.write(base))
    except ValueError as error:
        refuse(str(error))
    except OSError as error:
        refuse(f"{base} cannot be written: {error.strerror or error}")
    except KeyboardInterrupt:
        interrupted(
            "no result was written; a run whose table names a checkpoint goes on from there with "
            "the same command"
        )
    for text in lines(said, request.scene.thickness is not None):
        screen.print(text, soft_wrap=True)
    for warning in said.get("warnings", ()):
        line = Text("warning         ", style="yellow").append(warning, style="default")
        screen.print(line, soft_wrap=True)
    if beside is not None:
        from cmverify.report import terminal

        terminal.print_differences(screen, beside)
    screen.print("wrote", *map(str, paths), soft_wrap=True)
