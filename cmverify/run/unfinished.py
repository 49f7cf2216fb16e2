"""Where a measurement may keep its state, so that a run that is killed goes on from there.

The worker names a folder for each measurement; a long one (`cmverify.cases.experiments.running`)
keeps checkpoints in it, a short one knows nothing of it. The folder's name tells the code that
measures: a state is never taken up by other code.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

SUFFIX = ".unfinished"
_folder: ContextVar[Path | None] = ContextVar("folder of the measurement", default=None)


def folder(stem: Path, fingerprint: str) -> Path:
    """Of the measurement whose record has this path without a suffix, by this code."""
    return stem.with_name(f"{stem.name}.{fingerprint[:12]}{SUFFIX}")


def discard(stem: Path, but: Path | None = None) -> None:
    """Remove what unfinished measurements with this stem have kept, `but` one of them."""
    for found in stem.parent.glob(f"{stem.name}.*{SUFFIX}"):
        if found != but:
            shutil.rmtree(found, ignore_errors=True)


@contextmanager
def kept_in(place: Path) -> Iterator[None]:
    """Name the folder for what is measured inside the block; it goes when the block ends."""
    before = _folder.set(place)
    try:
        yield
    finally:
        _folder.reset(before)
    shutil.rmtree(place, ignore_errors=True)


def place() -> Path | None:
    """The folder of this measurement, made if need be; None where nothing is to be kept."""
    found = _folder.get()
    if found is not None:
        found.mkdir(parents=True, exist_ok=True)
    return found
