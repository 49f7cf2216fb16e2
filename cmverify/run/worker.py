"""One measurement: warm up, run, record. The same function serves workers, pytest and asv."""

from __future__ import annotations

import logging
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from multiprocessing.connection import Connection
from pathlib import Path
from weakref import WeakSet

from cmverify.case import Case, Failed, Measurement, Method, Outcome, Setting
from cmverify.run import results, unfinished
from cmverify.run.cluster import ALONE, is_shared, journal, threads_here
from cmverify.run.lifeline import hold

#: What the workers of a cluster began and finished, beside the records.
LOG = "cluster.log"
_warm: WeakSet[Callable[[], None]] = WeakSet()


def warm_up(method: Method) -> None:
    """Let a method compile what it needs, once a process."""
    if method.warm_up not in _warm:
        method.warm_up()
        _warm.add(method.warm_up)


def measure(method: Method, resolution: int) -> Measurement:
    """Run a method with its compiled code warm; raises what the method raises."""
    warm_up(method)
    with cautions() as said, settings() as solved:
        measurement = method.run(resolution)
    if not isinstance(measurement, Measurement):
        raise TypeError(f"{method.name} returned {type(measurement).__name__}, not a Measurement")
    return replace(
        measurement,
        warnings=tuple(dict.fromkeys((*measurement.warnings, *said))),
        scenes=tuple(dict.fromkeys((*measurement.scenes, *solved))),
    )


class _Listener(logging.Handler):
    """Keeps what it hears."""

    def __init__(self) -> None:
        super().__init__(logging.INFO)
        self.heard: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.heard.append(record.getMessage())


@contextmanager
def cautions() -> Iterator[list[str]]:
    """What the solver says of the scenes that it is asked within the block."""
    logger, listener = logging.getLogger("solver"), _Listener()
    level = logger.level
    logger.addHandler(listener)
    logger.setLevel(logging.INFO)
    try:
        yield listener.heard
    finally:
        logger.setLevel(level)
        logger.removeHandler(listener)


class _Scenes(logging.Handler):
    """Keeps with what the scenes that it hears of are solved."""

    def __init__(self) -> None:
        super().__init__(logging.DEBUG)
        self.heard: list[Setting] = []

    def emit(self, record: logging.LogRecord) -> None:
        if isinstance(record.args, tuple):
            physics, calibration, surface, m, influence = record.args
            self.heard.append(
                Setting(str(physics), str(calibration), str(surface), float(str(m)), str(influence))
            )


@contextmanager
def settings() -> Iterator[list[Setting]]:
    """With what the solver's scenes are solved within the block."""
    logger, listener = logging.getLogger("solver.scenes"), _Scenes()
    level, propagate = logger.level, logger.propagate
    logger.addHandler(listener)
    logger.setLevel(logging.DEBUG)
    logger.propagate = False  # nobody else has asked for it
    try:
        yield listener.heard
    finally:
        logger.setLevel(level)
        logger.propagate = propagate
        logger.removeHandler(listener)


def attempt(method: Method, resolution: int) -> Outcome:
    """Like `measure`, but an exception becomes a `Failed` outcome."""
    try:
        return measure(method, resolution)
    except Exception as error:
        text = str(error) or "(no message)"
        return Failed(type(error).__name__, text, traceback.format_exc(limit=-6))


def record(
    case: Case, method: Method, resolution: int, threads: int, fingerprint: str
) -> results.Record:
    """Measure and wrap with what the record keeps; see `results.Record`."""
    start = time.perf_counter()
    outcome = attempt(method, resolution)
    wall = time.perf_counter() - start
    return results.Record(case.name, method.name, resolution, outcome, threads, wall, fingerprint)


def measured(
    registry: str,
    name: str,
    method: str,
    resolution: int,
    folder: str,
    mark: str,
    threads: int,
    fingerprint: str,
) -> results.Record:
    """Measure on a worker of a cluster, unless the record stands there already.

    Where the run's folder is on this machine's disks (its mark is there), the record is written
    there and a long measurement goes on from what a worker that died has left. No more than
    `threads` are used, so that all times of a run are taken with as many.

    Raises
    ------
    RuntimeError
        If this worker has other code than the run.
    """
    from contextlib import nullcontext
    from importlib import import_module

    if results.source_fingerprint() != fingerprint:
        raise RuntimeError("the cluster's workers have another version of cmverify than the run")
    place = Path(folder)
    here = is_shared(place, mark)
    stem = results.stem(place, name, method, resolution)
    with ALONE:
        if here and (known := _finished(stem, fingerprint, threads)) is not None:
            return known
        if here:
            journal(place / LOG, "started", stem.relative_to(place).as_posix())
        case = import_module(registry).get(name)
        keep = unfinished.kept_in(unfinished.folder(stem, fingerprint)) if here else nullcontext()
        with keep, at_most(threads) as used:
            done = record(case, case.method(method), resolution, used, fingerprint)
        if here:
            results.save(done, place)
            journal(place / LOG, "finished", stem.relative_to(place).as_posix())
        return done


def _finished(stem: Path, fingerprint: str, threads: int) -> results.Record | None:
    """The record that this very code has written with so many threads, or None."""
    try:
        found = results.load(stem.with_suffix(".json"))
    except (OSError, ValueError):
        return None
    return found if (found.fingerprint, found.threads) == (fingerprint, threads) else None


@contextmanager
def at_most(threads: int) -> Iterator[int]:
    """Kernels with no more than so many threads; how many they have."""
    import numba

    before = threads_here()
    numba.set_num_threads(min(threads, before))
    try:
        yield threads_here()
    finally:
        numba.set_num_threads(before)


def serve(
    connection: Connection, registry: str, folder: Path, threads: int, parent: int | None = None
) -> None:
    """Body of a worker process: take (case, method, n), save the record, answer, repeat.

    `registry` is the dotted name of a module with `get(name) -> Case`; cases hold functions and
    are looked up here instead of being sent. `parent` is the process number of the run, which the
    worker does not outlive. The answer is (task, seconds, message of a failure or None, what the
    system said if the record could not be written or None).
    """
    from importlib import import_module

    if parent is not None:
        hold(parent)
    fingerprint = results.source_fingerprint()
    lookup = import_module(registry).get
    try:
        while (task := connection.recv()) is not None:
            name, method_name, resolution = task
            case = lookup(name)
            stem = results.stem(folder, name, method_name, resolution)
            with unfinished.kept_in(unfinished.folder(stem, fingerprint)):
                done = record(case, case.method(method_name), resolution, threads, fingerprint)
            summary = done.outcome.message if isinstance(done.outcome, Failed) else None
            unwritten = None
            try:
                results.save(done, folder)
            except OSError as error:
                unwritten = error.strerror or str(error)
            connection.send((task, done.wall_seconds, summary, unwritten))
    except (EOFError, BrokenPipeError):
        pass  # the run has ended without a word: there is nobody to tell
