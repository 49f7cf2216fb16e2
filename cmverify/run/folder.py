"""The folder of a run: can it be written, and does another run write to it already?"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

#: The file that a run holds locked; it holds the process number.
LOCK = ".lock"
#: What to do where a file is there already.
OTHER_NAME, OTHER_OUT = (f"choose another {what}, or --overwrite" for what in ("name", "--out"))
#: What a run writes at the top of its folder, and what tells that a folder is a run's.
OWN, MARK = ("index.html", "results.json", "previous.json"), "run.json"


class FolderError(ValueError):
    """A folder to which a run cannot be written, in one line."""


def check(folder: Path) -> None:
    """Make the folder, and refuse it if nothing can be written there.

    Raises
    ------
    FolderError
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for inner in (folder, folder / "results"):
            inner.mkdir(exist_ok=True)
            trial = inner / f".trial.{os.getpid()}"
            try:
                trial.write_bytes(b"x" * 4096)
            finally:
                with suppress(OSError):
                    trial.unlink()
    except (OSError, ValueError) as error:
        said = getattr(error, "strerror", None) or str(error)
        raise FolderError(f"nothing can be written to the folder {folder}: {said}") from error


def check_file(path: Path) -> None:
    """Refuse a file that could not be written.

    Raises
    ------
    FolderError
    """
    check_parent = path.parent
    try:
        check_parent.mkdir(parents=True, exist_ok=True)
        if path.is_dir():
            raise FolderError(f"{path} is a folder, not a file")
        trial = path.with_name(f".{path.name}.{os.getpid()}")
        trial.touch()
        trial.unlink()
    except OSError as error:
        raise FolderError(f"{path} cannot be written: {error.strerror}") from error


def keep(paths: Iterable[Path], overwrite: bool, instead: str = OTHER_NAME) -> None:
    """Refuse to take the place of files that are there, unless that was asked for.

    Raises
    ------
    FolderError
        Naming them.
    """
    there = [str(path) for path in paths if os.path.lexists(path)]
    if there and not overwrite:
        verb = "exists" if len(there) == 1 else "exist"
        raise FolderError(f"{', '.join(there)} {verb} already: {instead}")


def require_own(folder: Path) -> None:
    """Refuse a folder in which a run would take the place of files that no run has written.

    It may take the place of an earlier run, whose numbers it sets aside.

    Raises
    ------
    FolderError
        Naming them.
    """
    if (folder / MARK).is_file():
        return
    if there := [name for name in OWN if (folder / name).exists()]:
        verb = "is" if len(there) == 1 else "are"
        raise FolderError(
            f"{folder} is not the folder of a run, and {', '.join(there)} {verb} there: "
            f"choose another --out"
        )


@contextmanager
def claimed(folder: Path) -> Iterator[None]:
    """Hold a folder for this run; the system lets go of it however the process ends.

    Raises
    ------
    FolderError
        If the folder cannot be written, or another run holds it.
    """
    check(folder)
    path = folder / LOCK
    try:
        stream = open(path, "a+", encoding="utf-8")  # noqa: SIM115
    except OSError as error:
        raise FolderError(
            f"nothing can be written to the folder {folder}: {error.strerror}"
        ) from error
    with stream:
        if not _lock(stream):
            stream.seek(0)
            other = stream.read(40).strip()
            named = f" (process {other})" if other.isdigit() else ""
            raise FolderError(
                f"another run{named} is writing to {folder}: wait for it, or choose another --out"
            )
        with suppress(OSError):
            stream.seek(0)
            stream.truncate()
            stream.write(f"{os.getpid()}\n")
            stream.flush()
        yield


def _lock(stream: IO[str]) -> bool:
    """Lock an open file without waiting; True too where the file system knows no locks."""
    try:
        import fcntl
    except ImportError:
        return _lock_elsewhere(stream)
    try:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True
    return True


def _lock_elsewhere(stream: IO[str]) -> bool:
    import importlib

    try:
        msvcrt = importlib.import_module("msvcrt")
    except ImportError:
        return True
    try:
        # A byte far beyond the content: what is locked cannot be read on Windows.
        stream.seek(1 << 20)
        msvcrt.locking(stream.fileno(), msvcrt.LK_NBLCK, 1)
    except OSError:
        return False
    return True
