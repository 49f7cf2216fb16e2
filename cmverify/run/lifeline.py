"""Processes that end with the one that started them, and signals that end a run in good order."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager, suppress
from multiprocessing import resource_tracker
from types import FrameType
from typing import Any, ParamSpec, TypeVar

_P = ParamSpec("_P")
_T = TypeVar("_T")

#: What ends a run in good order besides Ctrl-C, where the system has it.
_SIGNALS = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))
_DEATH_SIGNAL = 1  # PR_SET_PDEATHSIG


def hold(parent: int) -> None:
    """Tie this process to its parent, whose process number is given.

    Ctrl-C reaches every process of a terminal, but what becomes of a run is for the parent to say:
    it is ignored here. The process leads a group of its own, so that the parent can end it with
    all that it has started, and it ends itself when the parent has died, whatever killed it.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):  # blocked by `sheltered` until this line
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    if hasattr(os, "setsid"):
        with suppress(OSError):  # it leads a group already
            os.setsid()
    if sys.platform == "linux":
        # From the system, which needs no turn of this process: a thread has to wait for one while
        # a library is busy.
        import ctypes

        with suppress(OSError, AttributeError):
            ctypes.CDLL(None).prctl(_DEATH_SIGNAL, int(signal.SIGKILL))
    if os.getppid() != parent:
        os._exit(1)  # it died before this line
    threading.Thread(target=_watch, daemon=True).start()


@contextmanager
def sheltered() -> Iterator[None]:
    """Processes that are started within the block hear no Ctrl-C until `hold` says what it means.

    A process that is started afresh imports for a second or more before it comes to `hold`; Ctrl-C
    in that time, which the terminal sends to it too, would end it with a traceback. What is blocked
    here is inherited by it. This process gets its Ctrl-C when the block ends.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield  # a system without masks: a new process there leaves the group of the terminal itself
        return
    # Started by the first process otherwise, and it unblocks the signal when it has done so.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class _Pool(ProcessPoolExecutor):
    """Its processes start with the first task."""

    def submit(self, fn: Callable[_P, _T], /, *args: _P.args, **kwargs: _P.kwargs) -> Future[_T]:
        with sheltered():
            return super().submit(fn, *args, **kwargs)


@contextmanager
def workers(jobs: int) -> Iterator[ProcessPoolExecutor]:
    """Processes started afresh that end with this one.

    Afresh, because this one may have threads and the limits of threads are read at import. If the
    block ends by an error or by Ctrl-C, they are killed, and nobody waits for what they are at.
    """
    given: dict[str, Any] = {"initializer": hold, "initargs": (os.getpid(),)}
    pool = _Pool(jobs, multiprocessing.get_context("spawn"), **given)
    try:
        yield pool
    except BaseException:
        for child in multiprocessing.active_children():
            if child.pid is not None:
                end_group(child.pid)
            child.kill()
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _watch() -> None:
    from multiprocessing import parent_process

    parent = parent_process()
    if parent is not None:
        parent.join()
        end_group(os.getpid())
        os._exit(1)


def end_group(leader: int) -> None:
    """Kill a process that leads its group, and all of the group, at once."""
    with suppress(OSError):  # gone already, or not yet a leader
        if hasattr(os, "killpg") and os.getpgid(leader) == leader:
            os.killpg(leader, signal.SIGKILL)


@contextmanager
def in_good_order() -> Iterator[None]:
    """SIGTERM and SIGHUP raise KeyboardInterrupt within the block, as Ctrl-C does."""
    if threading.current_thread() is not threading.main_thread():
        yield  # only the main thread may set handlers
        return
    before = {}
    for number in _SIGNALS:
        if signal.getsignal(number) is signal.SIG_DFL:
            before[number] = signal.signal(number, _interrupt)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _interrupt(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt
