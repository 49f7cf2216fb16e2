"""`cmverify new` and `cmverify schema`: files to start from, and what they may say."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cmverify.console import refuse


def new(
    kind: Annotated[
        str | None, typer.Argument(metavar="[KIND]", help="Without one, the kinds are listed.")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="File to write; KIND.toml.")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the file.")] = False,
) -> None:
    """Write a commented scene file to start from."""
    import difflib

    from cmverify.exchange import start_file
    from cmverify.run import folder, results

    if kind is None:
        width = max(map(len, start_file.KINDS))
        for name, (says, _) in start_file.KINDS.items():
            typer.echo(f"{name:<{width}}  {says}")
        return
    if kind not in start_file.KINDS:
        near = difflib.get_close_matches(kind, start_file.KINDS, n=1)
        hint = f"did you mean {near[0]}?" if near else f"known: {', '.join(start_file.KINDS)}"
        refuse(f"there is no kind {kind!r}; {hint}")
    path = out or Path(f"{kind}.toml")
    try:
        folder.keep([path], overwrite, folder.OTHER_OUT)
        results.write_text(path, start_file.text(kind))
    except folder.FolderError as error:
        refuse(str(error))
    except OSError as error:
        refuse(f"{path} cannot be written: {error.strerror or error}")
    typer.echo(f"wrote {path}; solve it with: cmverify solve {path}")


def schema(
    out: Annotated[Path | None, typer.Option(help="File to write; the terminal.")] = None,
    folder: Annotated[
        Path | None, typer.Option(help="Write scene.schema.json and scene-files.md there.")
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace these files.")] = False,
) -> None:
    """Give the JSON schema of scene files, for editors, and their reference page."""
    from cmverify.exchange import reference_page
    from cmverify.exchange import schema as declared
    from cmverify.run import results
    from cmverify.run.folder import FolderError, keep

    wanted = {}
    if folder is not None:
        wanted[folder / "scene.schema.json"] = declared.as_text()
        wanted[folder / "scene-files.md"] = reference_page.page()
    if out is not None:
        wanted[out] = declared.as_text()
    if not wanted:
        typer.echo(declared.as_text(), nl=False)
    try:
        keep(wanted, overwrite)
    except FolderError as error:
        refuse(str(error))
    for path, text in wanted.items():
        try:
            results.write_text(path, text)
        except OSError as error:
            refuse(f"{path} cannot be written: {error.strerror or error}")
        typer.echo(f"wrote {path}")
