"""Finished measurements on disk: one JSON and one .npz for each (case, method, resolution).

Files are written beside their final place and renamed, the .npz first: a record whose .json
exists is complete, whatever killed the run.
"""

from __future__ import annotations

import hashlib
import io
import json
import math
import os
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import asdict, dataclass
from dataclasses import fields as fields_of
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from cmverify.case import (
    Curve,
    Failed,
    Field,
    FieldSet,
    LinePlot,
    Measurement,
    Outcome,
    Setting,
    Stage,
    Stages,
)

FORMAT = 2
# Files that decide what is measured: code and stored references.
_MEASURES = {".py", ".npz", ".json"}
CURVE = ("abscissa", "computed", "reference", "reference_abscissa")


@dataclass(frozen=True)
class Record:
    """An outcome with what one must know to trust or repeat it.

    Attributes
    ----------
    threads : worker's thread limit
    wall_seconds : whole time of the task, compilation and post-processing included
    fingerprint : `source_fingerprint` of the code that measured
    """

    case: str
    method: str
    resolution: int
    outcome: Outcome
    threads: int
    wall_seconds: float
    fingerprint: str

    @property
    def failed(self) -> bool:
        """Whether the method raised instead of measuring."""
        return isinstance(self.outcome, Failed)


@cache
def source_fingerprint() -> str:
    """Hash of the three packages' sources and stored references, and of the libraries' versions.

    A result measured by other code must not be taken for a result of this code: `--resume` reuses
    a record only if the fingerprints agree.
    """
    from importlib.metadata import PackageNotFoundError, version
    from importlib.util import find_spec

    digest = hashlib.sha256()
    for package in ("solver", "references", "cmverify"):
        spec = find_spec(package)
        for place in (spec.submodule_search_locations or []) if spec else []:
            for path in sorted(Path(place).rglob("*")):
                if path.suffix in _MEASURES and path.is_file():
                    digest.update(path.relative_to(place).as_posix().encode())
                    digest.update(path.read_bytes())
    for library in ("numpy", "scipy", "numba", "scikit-fem", "gmsh"):
        try:
            found = version(library)
        except PackageNotFoundError:  # a copy that no installer knows
            found = "?"
        digest.update(f"{library}={found}".encode())
    return digest.hexdigest()[:16]


def stem(folder: Path, case: str, method: str, resolution: int) -> Path:
    """Path of a record without its suffix."""
    return folder / "results" / case / method.replace("/", "-") / f"{resolution:04d}"


def save(record: Record, folder: Path) -> Path:
    """Write a record atomically; returns the path of its .json."""
    base = stem(folder, record.case, record.method, record.resolution)
    base.parent.mkdir(parents=True, exist_ok=True)
    arrays: dict[str, Any] = {}
    head = {f: getattr(record, f) for f in ("case", "method", "resolution", "threads")}
    data: dict[str, Any] = {
        "format": FORMAT,
        **head,
        "wall_seconds": record.wall_seconds,
        "fingerprint": record.fingerprint,
    }
    if isinstance(record.outcome, Failed):
        data["failed"] = asdict(record.outcome)
    else:
        data["measurement"] = _describe(record.outcome, arrays)
    if arrays:
        archive = io.BytesIO()
        np.savez_compressed(archive, **arrays)
        data["arrays_sha256"] = _sha256(archive.getvalue())
        _replace(base.with_suffix(".npz"), lambda stream: stream.write(archive.getvalue()))
    data["record_sha256"] = _record_sha256(data)
    text = json.dumps(_plain(data), indent=1, allow_nan=False)
    _replace(base.with_suffix(".json"), lambda stream: stream.write(text.encode()))
    return base.with_suffix(".json")


def load(path: Path) -> Record:
    """Read a record back from its .json.

    Raises
    ------
    ValueError
        If the file is not a record of this format.
    """
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        if data["format"] != FORMAT:
            raise ValueError(f"format {data['format']}, not {FORMAT}")
        if data["record_sha256"] != _record_sha256(data):
            raise ValueError("it was altered")
        outcome: Outcome
        if "failed" in data:
            outcome = Failed(**data["failed"])
        else:
            outcome = _restore(data["measurement"], _arrays(path, data))
        keys = ("case", "method", "resolution", "threads", "wall_seconds", "fingerprint")
        return Record(outcome=outcome, **{key: data[key] for key in keys})
    except Exception as error:
        # Damaged files make json, zipfile, zlib and NumPy raise a dozen kinds of errors.
        said = " ".join(str(error).split()) or type(error).__name__
        raise ValueError(f"{path} is not a usable result record: {said}") from error


def _arrays(path: Path, data: dict[str, Any]) -> dict[str, Any]:
    if "arrays_sha256" not in data:
        return {}
    archive = path.with_suffix(".npz")
    content = archive.read_bytes()
    if _sha256(content) != data["arrays_sha256"]:
        raise ValueError(f"{archive.name} is damaged or of another run")
    with np.load(io.BytesIO(content), allow_pickle=False) as found:
        return {key: found[key] for key in found.files}


def _sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _record_sha256(data: dict[str, Any]) -> str:
    rest = {key: value for key, value in data.items() if key != "record_sha256"}
    return _sha256(json.dumps(_plain(rest), sort_keys=True).encode())


def load_all(folder: Path) -> Iterator[Record]:
    """Every usable record below a run's folder, in a fixed order."""
    for path in sorted((folder / "results").rglob("*.json")):
        with suppress(ValueError):
            yield load(path)


def write_text(path: Path, text: str) -> None:
    """Write a text file atomically, folders included."""
    path.parent.mkdir(parents=True, exist_ok=True)
    _replace(path, lambda stream: stream.write(text.encode()))


def _replace(path: Path, write: Any) -> None:
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "wb") as stream:
            write(stream)
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def _plain(value: Any) -> Any:
    """JSON data with NaN and infinities as strings, so that no reader chokes on them."""
    if isinstance(value, dict):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value


def _describe(m: Measurement, arrays: dict[str, np.ndarray]) -> dict[str, Any]:
    """Split a measurement into JSON data (returned) and arrays (filled in)."""
    data: dict[str, Any] = {
        "unknowns": m.unknowns,
        "quantities": dict(m.quantities),
        "seconds": dict(m.seconds),
        "statistics": dict(m.statistics),
        "warnings": list(m.warnings),
        "scenes": [list(setting) for setting in m.scenes],
    }
    if m.fields is not None:
        arrays["points"] = m.fields.points
        if m.fields.triangles is not None:
            arrays["triangles"] = m.fields.triangles
        data["fields"] = {"spacing": m.fields.spacing, "items": {}}
        for key, item in m.fields.items.items():
            data["fields"]["items"][key] = {"label": item.label, "unit": item.unit}
            arrays[f"{key}"], arrays[f"{key}_reference"] = item.computed, item.reference
    if m.stages is not None:
        arrays["stage_points"] = m.stages.points
        data["stages"] = {
            "quantity": m.stages.quantity,
            "spacing": m.stages.spacing,
            "labels": [stage.label for stage in m.stages.stages],
            "outlines": len(m.stages.outlines),
        }
        for k, outline in enumerate(m.stages.outlines):
            arrays[f"stage_outline{k}"] = outline
        for k, stage in enumerate(m.stages.stages):
            arrays[f"stage{k}_at"], arrays[f"stage{k}_values"] = stage.at, stage.values
    data["lines"] = []
    for i, line in enumerate(m.lines):
        entry = {f.name: getattr(line, f.name) for f in fields_of(line) if f.name != "curves"}
        data["lines"].append({**entry, "curves": [curve.label for curve in line.curves]})
        for j, curve in enumerate(line.curves):
            for name in CURVE:
                if getattr(curve, name) is not None:
                    arrays[f"line{i}_{j}_{name}"] = getattr(curve, name)
    return data


def _restore(data: dict[str, Any], arrays: dict[str, Any]) -> Measurement:
    fields = None
    if "fields" in data:
        items = {
            key: Field(item["label"], item["unit"], arrays[key], arrays[f"{key}_reference"])
            for key, item in data["fields"]["items"].items()
        }
        spacing, triangles = data["fields"]["spacing"], arrays.get("triangles")
        fields = FieldSet(arrays["points"], items, spacing, triangles)
    stages = None
    if "stages" in data:
        entry = data["stages"]
        stages = Stages(
            entry["quantity"],
            arrays["stage_points"],
            entry["spacing"],
            tuple(
                Stage(label, arrays[f"stage{k}_at"], arrays[f"stage{k}_values"])
                for k, label in enumerate(entry["labels"])
            ),
            tuple(arrays[f"stage_outline{k}"] for k in range(entry.get("outlines", 0))),
        )
    lines = []
    for i, entry in enumerate(data["lines"]):
        curves = []
        for j, label in enumerate(entry["curves"]):
            given: dict[str, Any] = {name: arrays.get(f"line{i}_{j}_{name}") for name in CURVE}
            curves.append(Curve(label, **given))
        lines.append(LinePlot(**{**entry, "curves": tuple(curves)}))
    return Measurement(
        unknowns=data["unknowns"],
        quantities={k: float(v) for k, v in data["quantities"].items()},
        seconds={k: float(v) for k, v in data["seconds"].items()},
        statistics=data["statistics"],
        fields=fields,
        lines=tuple(lines),
        stages=stages,
        warnings=tuple(data.get("warnings", ())),
        scenes=tuple(Setting(*entry) for entry in data.get("scenes", ())),
    )
