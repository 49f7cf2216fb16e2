"""One point of a sweep, done where it is sent: in this process, a worker's or a cluster's."""

from __future__ import annotations

import json
import math
import time
from pathlib import Path
from typing import Any

import numpy as np

from cmverify.run import cluster
from cmverify.run.cluster import ALONE
from cmverify.sweep.grid import Point


def record_path(folder: Path, key: str) -> Path:
    """Of a point's record."""
    return folder / "points" / f"{key}.json"


def load(folder: Path, key: str) -> dict[str, Any] | None:
    """The record of a finished point; None if there is none that can be used."""
    try:
        found = json.loads(record_path(folder, key).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) and found.get("key") == key else None


def save(folder: Path, record: dict[str, Any]) -> None:
    """Write a record, whole or not at all."""
    from cmverify.run.results import write_text

    write_text(record_path(folder, record["key"]), json.dumps(record, indent=1))


def solve(point: Point, folder: str, mark: str | None = None) -> dict[str, Any]:
    """Solve a point and write its record, unless that stands there already.

    A worker that dies after it has written costs nothing: who is sent the point again reads the
    record. Where the folder is not this machine's (on a cluster its mark is not there), the record
    goes back as it is returned.
    """
    place = Path(folder)
    here = mark is None or cluster.is_shared(place, mark)
    with ALONE:
        if here and (known := load(place, point.key)) is not None:
            return known
        if here:
            journal(place, "started", point.key)
        record = _record(point)
        if here:
            save(place, record)
            journal(place, "finished", point.key)
        return record


def journal(folder: Path, what: str, key: str) -> None:
    """A line about a point and the process that works on it, in sweep.log; lines stay whole."""
    cluster.journal(folder / "sweep.log", what, key)


def begun(folder: Path) -> set[str]:
    """Points that were begun and not finished, by the journal."""
    found: set[str] = set()
    for line in (folder / "sweep.log").read_text(encoding="utf-8").splitlines():
        what, key, _ = line.split(" ", 2)
        (found.add if what == "started" else found.discard)(key)
    return found


def _record(point: Point) -> dict[str, Any]:
    from cmverify.exchange import comparison, scene_file
    from cmverify.exchange.beforehand import CostError

    begun = time.perf_counter()
    refused, values = "", {}
    try:
        # How long it may take is for those to say who ask for many.
        request = scene_file.request_of(point.source(), seconds=math.inf)
        result = request.run()
        values = quantities(result)
        if request.file.compare is not None:
            for item in comparison.compare(request, result).differences:
                values[f"{item.quantity} off finite elements"] = item.l2
    except CostError:
        raise  # what another machine could do
    except ValueError as error:
        if isinstance(error.__cause__, MemoryError):
            raise
        # What a model cannot answer is an answer about the model.
        refused = " ".join(str(error).split())
    return {
        "key": point.key,
        "labels": point.labels,
        "refused": refused,
        "values": values,
        "seconds": time.perf_counter() - begun,
    }


def quantities(result: Any) -> dict[str, float | int | str]:
    """Plain figures of a result: its summary, extremes of its fields, ends of its tables."""
    found: dict[str, float | int | str] = {}
    for name, value in result.summary().items():
        if name == "warnings":
            found["warnings"] = len(value)
        elif isinstance(value, list | tuple | np.ndarray):
            found |= {f"{name}_{i + 1}": _plain(item) for i, item in enumerate(value)}
        elif value is not None:
            found[name] = _plain(value)
    for name, values in result.fields().items():
        if name == "prescribed":
            continue
        size = np.abs(values) if values.ndim == 1 else np.linalg.norm(values, axis=-1)
        if np.isfinite(size).any():
            found[f"largest {name}"] = float(np.nanmax(size))
    for name, table in result.tables().items():
        if len(table.values):
            last = table.values[-1]
            found |= {
                f"last {name} {c}": float(v) for c, v in zip(table.columns, last, strict=True)
            }
    return {k: v for k, v in found.items() if not (isinstance(v, float) and math.isnan(v))}


def _plain(value: Any) -> float | int | str:
    if isinstance(value, np.generic):
        value = value.item()
    return value if isinstance(value, int | float | str) else str(value)
