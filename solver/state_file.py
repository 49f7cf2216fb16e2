"""The state of a run on disk: whole or not at all, its own and nobody else's.

A run that is killed goes on from its last state with the same results to the last bit. So the file
holds a fingerprint of everything that decides the results besides the state, the code included,
and a digest that tells damage from content.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np

from .errors import SceneError
from .result import replacing


@cache
def code() -> str:
    """Hash of this package's sources and of the versions of the libraries that round for it.

    Other code would go on from the same state and end in other bits, and nobody would know
    which part of the run was made by which.
    """
    package = Path(__file__).parent
    found = hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
        found.update(path.relative_to(package).as_posix().encode())
        found.update(path.read_bytes())
    for library in ("numpy", "scipy", "numba"):
        try:
            found.update(f"{library}={version(library)}".encode())
        except PackageNotFoundError:  # a copy that no installer knows
            found.update(library.encode())
    return found.hexdigest()


def digest(parts: Mapping[str, Any]) -> str:
    """Hash of names and values, arrays by their bytes."""
    found = hashlib.sha256()
    for name in sorted(parts):
        part = parts[name]
        found.update(name.encode())
        if isinstance(part, np.ndarray):
            found.update(f"{part.dtype}{part.shape}".encode())
            found.update(np.ascontiguousarray(part).tobytes())
        else:
            found.update(repr(part).encode())
    return found.hexdigest()


def fingerprint(**parts: Any) -> str:
    """Hash of what decides a run's results, with this code."""
    return digest({"code": code(), **parts})


class StateFile:
    """The last state of a run, and whether it belongs to the run that asks for it.

    Parameters
    ----------
    path : path, optional
        None: nothing is kept.
    mark : str
        Fingerprint of everything that decides the run's results, see `fingerprint`.

    Raises
    ------
    SceneError
        If the path could not be written, before any work.
    """

    def __init__(self, path: str | os.PathLike[str] | None, mark: str) -> None:
        self.path, self.mark = None if path is None else Path(path), mark
        if self.path is not None:
            check(self.path)

    def save(self, state: Mapping[str, Any]) -> None:
        """Write a state; a kill at any moment leaves the old file or the new one.

        Raises
        ------
        SceneError
            If the file cannot be written (no permission, no space).
        """
        if self.path is None:
            return
        arrays: dict[str, Any] = {name: np.asarray(value) for name, value in state.items()}
        arrays["fingerprint"] = np.asarray(self.mark)
        arrays["digest"] = np.asarray(digest(arrays))
        try:
            with replacing(self.path) as partial, open(partial, "wb") as file:
                np.savez(file, **arrays)
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:
            raise SceneError(
                f"the checkpoint {self.path} cannot be written: {error.strerror or error}"
            ) from error

    def load(self) -> dict[str, Any] | None:
        """The saved state, None if there is none.

        Raises
        ------
        SceneError
            If the file is damaged, or belongs to another run.
        """
        if self.path is None or not self.path.exists():
            return None
        try:
            with np.load(self.path, allow_pickle=False) as file:
                found = {name: file[name] for name in file.files}
        except Exception as error:
            # Whatever damaged bytes make zipfile, zlib and NumPy raise: a dozen kinds.
            said = " ".join(str(error).split()) or type(error).__name__
            raise SceneError(f"{self.path} is no checkpoint: {said}") from error
        told = str(found.pop("digest", ""))
        if told != digest(found):
            raise SceneError(f"{self.path} is no checkpoint, or a damaged one: remove it")
        if str(found.pop("fingerprint")) != self.mark:
            raise SceneError(
                f"the checkpoint {self.path} belongs to another scene or way to run it, or was "
                f"made by other code: remove it or name another file"
            )
        return found


def check(path: str | os.PathLike[str], what: str = "checkpoint") -> None:
    """Refuse a path that could not be written, before any work.

    Raises
    ------
    SceneError
        If its folder does not exist or takes no files, or it is a folder itself.
    """
    target = Path(path)
    if not target.name:
        raise SceneError(f"the {what} {path} names no file")
    try:
        if target.is_dir():
            raise SceneError(f"the {what} {path} cannot be written: it is a folder")
        if not target.parent.is_dir():
            raise SceneError(
                f"the {what} {path} cannot be written: there is no folder {target.parent}"
            )
        trial = target.with_name(f".{target.name}.{os.getpid()}.trial")
        trial.touch()
        trial.unlink()
    except OSError as error:
        raise SceneError(f"the {what} {path} cannot be written: {error.strerror}") from error
