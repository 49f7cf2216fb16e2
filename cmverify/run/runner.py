"""Run cases in parallel worker processes, with live progress, losing nothing when killed.

Workers are started afresh (not forked), because the thread limits of Numba and BLAS are read at
import. Each worker takes one task after another over a pipe and writes every record to disk
before it answers. A worker that dies (a crash in a compiled library, the kernel's out-of-memory
killer) costs its task a FAIL and is replaced. Workers end with this process, however it ends.
"""

from __future__ import annotations

import multiprocessing
import os
import time
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

from cmverify.case import Case, Failed, Level
from cmverify.run import results, unfinished
from cmverify.run.lifeline import end_group, sheltered
from cmverify.run.threads import child_environment, thread_environment, threads_per_worker
from cmverify.run.worker import measured, serve

Task = tuple[str, str, int]

# Longest wait for an answer (s) before looking round.
_LOOK_ROUND = 3600.0


class UnwritableError(OSError):
    """A record could not be written (a full disk): the run stops, what is finished stays."""


@dataclass(frozen=True)
class Event:
    """Something happened to a task: "started", "finished", "failed" or "reused"."""

    kind: str
    task: Task
    seconds: float = 0.0
    message: str | None = None


@dataclass
class _Worker:
    process: multiprocessing.process.BaseProcess
    pipe: Connection
    task: Task | None = None
    since: float = 0.0


def run(
    cases: Sequence[Case],
    level: Level,
    folder: Path,
    *,
    jobs: int = 1,
    resume: bool = False,
    timeout: float = 3600.0,
    listen: Callable[[Event], None] = lambda event: None,
    registry: str = "cmverify.cases.registry",
    dask: str | None = None,
) -> list[results.Record]:
    """Run every (method, resolution) of a level and return the records, case by case.

    Parameters
    ----------
    folder : Path
        Where records are written, one at a time, as they finish.
    jobs : int
        Worker processes; the cores are divided among them.
    resume : bool
        Reuse records in `folder` that the same code measured with the same number of threads, and
        go on with measurements that it has left unfinished and kept the state of.
    timeout : float
        Seconds after which a single measurement is given up and fails.
    listen : callable
        Told of every `Event`, in this process.
    registry : str
        Module in which workers look cases up by name.
    dask : str, optional
        Address of a Dask scheduler whose workers measure instead, all with as many threads as each
        of them has; there `timeout` ends nothing.

    Raises
    ------
    UnwritableError
        If a record cannot be written.
    ClusterError
        If no scheduler answers.
    """
    if dask is None:
        return _run(cases, level, folder, resume, listen, threads_per_worker(jobs),
                    partial(_drain, folder=folder, jobs=jobs, timeout=timeout, listen=listen,
                            registry=registry))  # fmt: skip
    from cmverify.run.cluster import connected, threads_of

    with connected(dask) as client:
        return _run(cases, level, folder, resume, listen, threads_of(client),
                    partial(_on_cluster, client=client, folder=folder, listen=listen,
                            registry=registry))  # fmt: skip


def _run(
    cases: Sequence[Case],
    level: Level,
    folder: Path,
    resume: bool,
    listen: Callable[[Event], None],
    threads: int,
    measure: Callable[..., None],
) -> list[results.Record]:
    """As `run`; `measure` does, with so many threads, what there is no record of."""
    tasks = plan(cases, level)
    todo: deque[Task] = deque()
    current = results.source_fingerprint()
    for task in tasks:
        if resume and _reusable(folder, task, threads, current):
            listen(Event("reused", task))
        else:
            stem = results.stem(folder, *task)
            stem.with_suffix(".json").unlink(missing_ok=True)
            # What a killed run has left is taken up by the same code, if it is asked to.
            unfinished.discard(stem, unfinished.folder(stem, current) if resume else None)
            todo.append(task)
    # The longest tasks first, so that none of them is left running alone at the end: cracks that
    # grow take hundreds of solves at any resolution.
    growing = {c.name for c in cases if "fracture" in c.tags}
    todo = deque(sorted(todo, key=lambda task: (task[0] not in growing, -task[2])))
    measure(todo, threads=threads)
    return [results.load(results.stem(folder, *task).with_suffix(".json")) for task in tasks]


def _on_cluster(
    todo: Iterable[Task],
    folder: Path,
    client: Any,
    threads: int,
    listen: Callable[[Event], None],
    registry: str,
) -> None:
    """Have everything measured by the workers of a Dask scheduler."""
    from cmverify.run.cluster import done_on, marked

    tasks = {results.stem(folder, *task).relative_to(folder).as_posix(): task for task in todo}
    place, current = str(folder.resolve()), results.source_fingerprint()
    with marked(folder) as mark:
        given = {
            key: (registry, *task, place, mark, threads, current) for key, task in tasks.items()
        }
        for key, record, reason in done_on(client, measured, given):
            task = tasks[key]
            if reason is not None:
                _fail(task, Failed("WorkerDied", reason), folder, threads, 0.0, listen)
                continue
            if not results.stem(folder, *task).with_suffix(".json").is_file():
                _save(record, folder)  # from a machine with other disks
            said = record.outcome.message if isinstance(record.outcome, Failed) else None
            listen(Event("failed" if said else "finished", task, record.wall_seconds, said))


def plan(cases: Iterable[Case], level: Level) -> list[Task]:
    """Everything that a level measures, case by case."""
    return [(c.name, m.name, n) for c in cases for m, n in c.plan(level)]


def _reusable(folder: Path, task: Task, threads: int, fingerprint: str) -> bool:
    path = results.stem(folder, *task).with_suffix(".json")
    if not path.exists():
        return False
    try:
        record = results.load(path)
    except ValueError:
        return False
    same_code = record.fingerprint == fingerprint
    return same_code and threads == record.threads and not record.failed


def _drain(
    todo: deque[Task],
    folder: Path,
    jobs: int,
    threads: int,
    timeout: float,
    listen: Callable[[Event], None],
    registry: str,
) -> None:
    workers: list[_Worker] = []
    jobs = min(jobs, len(todo))
    try:
        while todo or any(worker.task for worker in workers):
            while todo and len(workers) < jobs:
                workers.append(_start(folder, threads, registry))
            for worker in workers:
                if worker.task is None and todo:
                    _assign(worker, todo.popleft(), listen)
            busy = [worker for worker in workers if worker.task]
            patience = min(worker.since for worker in busy) + timeout - time.perf_counter()
            patience = min(max(patience, 0.0), _LOOK_ROUND)
            ready = wait([worker.pipe for worker in busy], patience)
            for worker in busy:
                late = time.perf_counter() - worker.since > timeout
                if worker.pipe in ready:
                    alive = _collect(worker, folder, threads, listen)
                else:
                    alive = not late
                    if late:
                        _give_up(worker, folder, threads, timeout, listen)
                if not alive:
                    workers.remove(worker)
    except BaseException:
        for worker in workers:
            _end(worker)
        raise
    for worker in workers:
        _stop(worker)


def _start(folder: Path, threads: int, registry: str) -> _Worker:
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    with child_environment(thread_environment(threads)):
        given = (there, registry, folder, threads, os.getpid())
        process = context.Process(target=serve, args=given)
        process.daemon = True
        with sheltered():
            process.start()
    there.close()
    return _Worker(process, here)


def _assign(worker: _Worker, task: Task, listen: Callable[[Event], None]) -> None:
    worker.task, worker.since = task, time.perf_counter()
    with suppress(BrokenPipeError):  # it died before its task: `_collect` will find out
        worker.pipe.send(task)
    listen(Event("started", task))


def _collect(worker: _Worker, folder: Path, threads: int, listen: Callable[[Event], None]) -> bool:
    """Take a worker's answer; False if it died instead of answering."""
    task = worker.task
    assert task is not None
    worker.task = None
    try:
        _, seconds, failure, unwritten = worker.pipe.recv()
    except (EOFError, ConnectionResetError):
        worker.process.join(timeout=10)
        seconds = time.perf_counter() - worker.since
        failure = f"the worker process died with exit code {worker.process.exitcode}"
        _fail(task, Failed("WorkerDied", failure), folder, threads, seconds, listen)
        return False
    if unwritten is not None:
        raise UnwritableError(f"the result of {task[0]} {task[1]} cannot be written: {unwritten}")
    listen(Event("failed" if failure else "finished", task, seconds, failure))
    return True


def _give_up(
    worker: _Worker, folder: Path, threads: int, timeout: float, listen: Callable[[Event], None]
) -> None:
    """End a worker whose task takes too long."""
    task = worker.task
    assert task is not None
    _end(worker)
    failure = f"no result after {timeout:g} s"
    _fail(task, Failed("TimeoutError", failure), folder, threads, timeout, listen)


def _fail(
    task: Task,
    outcome: Failed,
    folder: Path,
    threads: int,
    seconds: float,
    listen: Callable[[Event], None],
) -> None:
    """Record a failure on behalf of a worker that cannot."""
    fingerprint = results.source_fingerprint()
    _save(results.Record(*task, outcome, threads, seconds, fingerprint), folder)
    listen(Event("failed", task, seconds, outcome.message))


def _save(record: results.Record, folder: Path) -> None:
    try:
        results.save(record, folder)
    except OSError as error:
        said = error.strerror or str(error)
        raise UnwritableError(
            f"the result of {record.case} {record.method} cannot be written: {said}"
        ) from error


def _stop(worker: _Worker) -> None:
    """Let an idle worker go; end one that is at work, with all that it has started."""
    if worker.task is None:
        with suppress(BrokenPipeError, OSError):
            worker.pipe.send(None)
            worker.process.join(timeout=5)
    _end(worker)


def _end(worker: _Worker) -> None:
    if worker.process.is_alive():
        if worker.process.pid is not None:
            end_group(worker.process.pid)
        worker.process.kill()
        worker.process.join(timeout=10)
    worker.pipe.close()
