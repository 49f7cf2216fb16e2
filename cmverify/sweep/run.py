"""A sweep on this machine's processes or on a Dask cluster; finished points are kept at once."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from cmverify.sweep import work
from cmverify.sweep.grid import Point, points

Listen = Callable[[Point, str], None]


def _silent(point: Point, state: str) -> None:
    """Nobody listens."""


@dataclass(frozen=True)
class Sweep:
    """What a sweep found.

    Attributes
    ----------
    rows : list of dict
        One a finished point, in the grid's order: settings, ``refused``, figures, ``seconds``.
    missing : list of (Point, reason)
        Points whose worker died or that no worker could do.
    paths : tuple of Path
        The table: CSV, and Parquet where pyarrow is installed.
    """

    rows: list[dict[str, Any]]
    missing: list[tuple[Point, str]]
    paths: tuple[Path, ...]


def sweep(
    scene: str | os.PathLike[str],
    grid: Mapping[str, Any],
    out: str | os.PathLike[str],
    *,
    jobs: int = 1,
    dask: str | None = None,
    listen: Listen = _silent,
) -> Sweep:
    """Solve a scene file at every point of a grid; what stands in `out` already is not done again.

    Parameters
    ----------
    scene : path
    grid : mapping
        As [grid] of a sweep's file (`cmverify.sweep.grid`).
    out : path
        Folder of the records and the table.
    jobs : int
        Processes on this machine.
    dask : str, optional
        Address of a Dask scheduler that does the work instead.
    listen : callable
        Told of every point and what became of it: "reused", "done", "refused" or "failed".

    Raises
    ------
    SceneFileError, GridError
        If a point asks for what does not exist, before anything is solved.
    ClusterError
        If Dask is asked for and not installed, or no scheduler answers.
    """
    return run(points(Path(scene), grid), Path(out), jobs=jobs, dask=dask, listen=listen)


def run(
    found: Sequence[Point],
    folder: Path,
    *,
    jobs: int = 1,
    dask: str | None = None,
    listen: Listen = _silent,
) -> Sweep:
    """Do what is not done yet, and write the table. Parameters as in `sweep`."""
    from cmverify.run.folder import claimed, keep

    if jobs < 1:
        raise ValueError(f"at least one process is needed, not {jobs}")
    if not (folder / "points").is_dir():
        # Tables of an earlier sweep are made anew; those of others are not its own.
        keep([folder / "sweep.csv", folder / "sweep.parquet"], False, "choose another --out")
    with claimed(folder):
        (folder / "points").mkdir(exist_ok=True)
        records = {p.key: r for p in found if (r := work.load(folder, p.key)) is not None}
        for point in found:
            if point.key in records:
                listen(point, "reused")
        todo = [point for point in found if point.key not in records]
        missing = []
        done = on_cluster(todo, folder, dask) if dask else on_processes(todo, folder, jobs)
        for point, answer in done:
            if isinstance(answer, str):
                missing.append((point, answer))
                listen(point, "failed")
                continue
            if work.load(folder, point.key) is None:  # from a machine with other disks
                work.save(folder, answer)
            records[point.key] = answer
            listen(point, "refused" if answer["refused"] else "done")
        rows = [_row(point, records[point.key]) for point in found if point.key in records]
        return Sweep(rows, missing, write_table(rows, folder))


Done = Iterator[tuple[Point, dict[str, Any] | str]]


def on_processes(todo: Sequence[Point], folder: Path, jobs: int) -> Done:
    """Points with their records, or why there is none, as they are finished.

    When a process dies its pool is lost. What it had begun is then tried alone, so that only a
    point that kills its process is given up, and the others go on together.
    """
    left = {point.key: point for point in todo}
    alone: set[str] = set()
    while left:
        together = [point for point in left.values() if point.key not in alone]
        chosen = together or [next(iter(left.values()))]
        broken = False
        for point, answer in _pool(chosen, folder, min(jobs, len(chosen)), jobs):
            if answer is None:
                broken = True
                continue
            del left[point.key]
            yield point, answer
        if not broken:
            continue
        if not together:
            del left[chosen[0].key]
            yield chosen[0], "its process died"
        begun = work.begun(folder) & left.keys()
        # Nothing begun: the processes cannot even start.
        alone |= begun or set(left)


def _pool(
    todo: Sequence[Point], folder: Path, processes: int, jobs: int
) -> Iterator[tuple[Point, dict[str, Any] | str | None]]:
    """Points with their records, or an error; None for what was lost with a process."""
    from cmverify.run.lifeline import workers
    from cmverify.run.threads import child_environment, thread_environment, threads_per_worker

    threads = thread_environment(threads_per_worker(jobs))
    with child_environment(threads), workers(processes) as pool:
        tasks = {pool.submit(work.solve, point, str(folder)): point for point in todo}
        for task in as_completed(tasks):
            try:
                yield tasks[task], task.result()
            except BrokenProcessPool:
                yield tasks[task], None
            except Exception as error:
                yield tasks[task], f"{type(error).__name__}: {error}"


def on_cluster(todo: Sequence[Point], folder: Path, address: str) -> Done:
    """The same, on the workers of a Dask scheduler."""
    from cmverify.run.cluster import connected, done_on, marked

    if not todo:
        return
    points = {point.key: point for point in todo}
    with connected(address) as client, marked(folder) as mark:
        given = {point.key: (point, str(folder.resolve()), mark) for point in todo}
        for key, record, reason in done_on(client, work.solve, given):
            yield points[key], record if reason is None else reason


def _row(point: Point, record: dict[str, Any]) -> dict[str, Any]:
    return {
        **point.labels,
        "refused": record["refused"],
        **{k: v for k, v in record["values"].items() if k not in point.labels},
        "seconds": record["seconds"],
    }


def write_table(rows: Sequence[dict[str, Any]], folder: Path) -> tuple[Path, ...]:
    """sweep.csv, and sweep.parquet where pyarrow is installed."""
    from cmverify.run.results import write_text

    columns = list(dict.fromkeys(name for row in rows for name in row))
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    path = folder / "sweep.csv"
    write_text(path, text.getvalue())
    if find_spec("pyarrow") is None or not rows:
        return (path,)
    import pyarrow
    from pyarrow import parquet

    from solver.result import replacing

    data = {name: _column([row.get(name) for row in rows]) for name in columns}
    target = folder / "sweep.parquet"
    with replacing(target) as partial:
        parquet.write_table(pyarrow.table(data), partial)
    return path, target


def _column(values: list[Any]) -> list[Any]:
    """Of one kind: words where some are words."""
    if any(isinstance(value, str) for value in values):
        return [None if value is None else str(value) for value in values]
    return [None if value is None else float(value) for value in values]
