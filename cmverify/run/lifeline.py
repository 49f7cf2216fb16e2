"""Processes that end with the one that started them, and signals that end a run in good order."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType

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
