"""``cmverify history``: asv's result files as a page of the report."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cmverify.console import console, refuse


def history(
    results: Annotated[Path, typer.Option(help="Folder of asv's results.")] = Path(".asv/results"),
    out: Annotated[Path, typer.Option("--out", help="Folder of the report.")] = Path("report"),
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a page.")] = False,
) -> None:
    """Draw what asv has measured over the commits as a page beside the report."""
    from cmverify.report import history as page
    from cmverify.run import folder

    try:
        folder.keep([out / page.NAME], overwrite)
        series = page.read(results)
        folder.check_file(out / page.NAME)
    except (folder.FolderError, ValueError) as error:
        refuse(str(error))
    path = page.write(series, f"cmverify history --results {results} --out {out} --overwrite", out)
    console().print(f"Page: {path}  ({len(series)} series)", soft_wrap=True)
