"""Work on the workers of a Dask scheduler: cases of a run, points of a sweep.

A worker that dies takes nothing finished with it: what it has done is on disk, or has come back
already. What it was at is sent to another one, which looks first whether it is there. Whether a
folder is the head's own one and not another of the same name is proved by a mark in it.
"""

from __future__ import annotations

import os
import platform
import threading
import uuid
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any

#: Kernels are not for two threads of one process at once.
ALONE = threading.Lock()
#: Times that something is sent again after its worker has died or it has failed.
RETRIES = 2


class ClusterError(ValueError):
    """There is no Dask, or no scheduler at that address; in one line."""


def connected(address: str, timeout: float = 30.0) -> Any:
    """A `distributed.Client` of the scheduler at an address.

    Raises
    ------
    ClusterError
    """
    if find_spec("distributed") is None:
        raise ClusterError("a Dask cluster needs Dask: pip install 'cmverify[cluster]'")
    from distributed import Client

    try:
        return Client(address, timeout=timeout)
    except (OSError, ValueError, TypeError) as error:
        said = " ".join(str(error).split()) or type(error).__name__
        raise ClusterError(f"no Dask scheduler answers at {address}: {said[:150]}") from error


def done_on(
    client: Any, function: Callable[..., Any], todo: Mapping[str, tuple[Any, ...]]
) -> Iterator[tuple[str, Any, str | None]]:
    """Call a function for each key of `todo` with its arguments, on a cluster's workers.

    Yields
    ------
    key, result, reason
        As they are finished; the reason why there is no result, else None.
    """
    from distributed import as_completed as finished

    # Dask takes tasks of one name for one: those of another folder or run are others.
    mark = uuid.uuid4().hex
    tasks = {
        client.submit(function, *given, key=f"cmverify-{mark}-{key}", retries=RETRIES): key
        for key, given in todo.items()
    }
    for task in finished(list(tasks)):
        if task.status == "finished":
            yield tasks[task], task.result(), None
        else:
            reason = " ".join(str(task.exception()).split()) or task.status
            yield tasks[task], None, reason
        task.release()


def threads_of(client: Any) -> int:
    """Threads that all workers have for kernels: what they measure with, whoever measures.

    A scheduler without workers is waited for until it has one.
    """
    counts = client.run(threads_here) or {"": client.submit(threads_here, pure=False).result()}
    return min(counts.values())


def threads_here() -> int:
    """Threads that kernels may use in this process."""
    import numba

    return int(numba.get_num_threads())


@contextmanager
def marked(folder: Path) -> Iterator[str]:
    """A mark in a folder for the time of the block, by which `is_shared` knows it."""
    for left in folder.glob(".shared-*"):  # of a run that was killed
        left.unlink(missing_ok=True)
    mark = uuid.uuid4().hex
    path = _marker(folder, mark)
    path.write_text(mark, encoding="utf-8")
    try:
        yield mark
    finally:
        path.unlink(missing_ok=True)


def is_shared(folder: Path, mark: str) -> bool:
    """Whether a folder of this machine is the one that was marked: its name proves nothing."""
    try:
        return _marker(folder, mark).read_text(encoding="utf-8") == mark
    except (OSError, ValueError):
        return False


def _marker(folder: Path, mark: str) -> Path:
    return folder / f".shared-{mark}"


def journal(path: Path, what: str, key: str) -> None:
    """A line about a piece of work and the process that is at it; lines stay whole."""
    if path.parent.is_dir():
        line = f"{what} {key} {platform.node()}:{os.getpid()}\n"
        with open(path, "ab", buffering=0) as stream:
            stream.write(line.encode())
