"""Meshes of other programs, read by meshio: what it cannot read is an error like any other."""

from __future__ import annotations

import io
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any


def read(path: Path) -> Any:
    """A `meshio.Mesh`.

    Raises
    ------
    ValueError
        If it cannot be read.
    """
    import meshio

    try:
        # What meshio cannot read it tells a terminal, and leaves the program.
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            return meshio.read(path)
    except SystemExit as error:
        raise ValueError(f"{path.name} cannot be read as a mesh by meshio") from error
    except Exception as error:
        said = " ".join(str(error).split()) or type(error).__name__
        raise ValueError(f"{path.name} cannot be read as a mesh: {said}") from error
