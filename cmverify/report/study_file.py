"""What studies leave in a folder for the report: JSON with a format number."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from cmverify.run.results import write_text

T = TypeVar("T")


def write(path: Path, version: int, data: dict[str, Any]) -> None:
    """Write it with the number of its format."""
    text = json.dumps({"format": version, **data}, indent=1, ensure_ascii=False)
    write_text(path, text)


def read(path: Path, version: int, what: str, made: Callable[[dict[str, Any]], T]) -> T | None:
    """What a study has left; None if there is nothing.

    Parameters
    ----------
    path : Path
    version : int
        The format that is known here.
    what : str
        What the file should be, for the message.
    made : callable
        Makes it of the file's data.

    Raises
    ------
    ValueError
        If it cannot be read.
    """
    if not path.is_file():
        return None
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        if data.pop("format") != version:
            raise ValueError(f"it is not of format {version}")
        return made(data)
    except (AttributeError, KeyError, TypeError, ValueError, OSError) as error:
        raise ValueError(f"{path} is no {what}: {error}") from error
