"""Stored references with their provenance: what made them, with which versions, how exact they are.

Each reference is a pair of files, ``name.npz`` with the numbers and ``name.json`` with the record:
generator and arguments, versions, meshes (size, hash), element order, estimated error, citation,
and the SHA-256 of the numbers and of the record itself. Whatever does not match is refused.
"""

import hashlib
import importlib.metadata
import io
import json
import platform
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from references.fem.mesh import Mesh
from references.fem.mesh_record import MeshRecord

DATA = Path(__file__).with_name("data")
_PACKAGES = ("numpy", "scipy", "scikit-fem", "gmsh")
# same mesh, same code: what other rounding can do to a solution
_ROUNDING = 1e-7
# what a record holds; only the arguments and the meshes may be empty
_RECORD: dict[str, Any] = {
    "name": str,
    "title": str,
    "citation": str,
    "generator": str,
    "arguments": dict,
    "versions": dict,
    "element_order": int | None,
    "meshes": list,
    "estimated_error": dict,
    "bytes": int,
    "sha256": str,
    "record_sha256": str,
}


class DamagedReferenceError(ValueError):
    """A stored reference is missing, truncated, altered or incomplete; the message names it."""


@dataclass(frozen=True)
class Generated:
    """What a generator returns.

    Attributes
    ----------
    arrays : dict of str to array
    errors : dict of str to float
        Estimated error of each array over its largest magnitude, by self-convergence; 0 for
        arguments such as angles or points.
    meshes : tuple of Mesh or MeshRecord
        Their sizes and hashes go into the record; none for what needs no mesh.
    order : int or None
        Of the elements; None without meshes.
    """

    arrays: Mapping[str, NDArray]
    errors: Mapping[str, float]
    meshes: tuple[Mesh | MeshRecord, ...] = ()
    order: int | None = None

    def __post_init__(self) -> None:
        if set(self.arrays) != set(self.errors):
            raise ValueError("every array of a reference needs an estimated error")
        if not all(np.isfinite(e) and e >= 0 for e in self.errors.values()):
            raise ValueError("an estimated error is a finite number that is not negative")
        if (self.order is None) != (not self.meshes):
            raise ValueError(
                "finite elements have an order and meshes to be recorded: both or none"
            )
        for name, array in self.arrays.items():
            if not np.isfinite(array).all():
                raise ValueError(f"the array {name!r} of a reference is not finite")


@dataclass(frozen=True)
class Reference:
    """One entry of the catalogue.

    Attributes
    ----------
    name : str
        Also the name of its files.
    title, citation : str
    generator : callable
        ``generator(**arguments)`` -> Generated.
    arguments : dict
        Plain numbers, strings and lists, written into the record.
    spot : dict
        Arguments that replace some of ``arguments`` when ``check`` regenerates: a small part of
        an expensive reference. Empty: all of it is regenerated.
    axis : str or None
        Array whose entries number the rows of all the others: tells which rows a spot check has.
    """

    name: str
    title: str
    citation: str
    generator: Callable[..., Generated]
    arguments: Mapping[str, Any]
    spot: Mapping[str, Any] = field(default_factory=dict)
    axis: str | None = None

    @property
    def generator_name(self) -> str:
        """Module and name of the generator."""
        return f"{self.generator.__module__}.{self.generator.__qualname__}"


@dataclass(frozen=True)
class Stored:
    """A reference as loaded: ``arrays`` and the ``record`` of how they came about."""

    name: str
    arrays: Mapping[str, NDArray]
    record: Mapping[str, Any]

    def __getitem__(self, name: str) -> NDArray:
        return self.arrays[name]

    def error(self, name: str) -> float:
        """Estimated error of an array over its largest magnitude."""
        return float(self.record["estimated_error"][name])


def _sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _record_hash(record: Mapping[str, Any]) -> str:
    rest = {k: v for k, v in record.items() if k != "record_sha256"}
    return _sha256(json.dumps(rest, sort_keys=True, ensure_ascii=False).encode())


def versions() -> dict[str, str]:
    """Of Python and the packages that a reference depends on."""
    return {
        "python": platform.python_version(),
        **{name: importlib.metadata.version(name) for name in _PACKAGES},
    }


def build(reference: Reference, folder: Path = DATA) -> Stored:
    """Generate a reference and store it, numbers first, each file replaced as a whole."""
    made = reference.generator(**reference.arguments)
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **{k: np.asarray(v) for k, v in made.arrays.items()})  # type: ignore[arg-type]
    content = buffer.getvalue()
    record: dict[str, Any] = {
        "name": reference.name,
        "title": reference.title,
        "citation": reference.citation,
        "generator": reference.generator_name,
        "arguments": json.loads(json.dumps(reference.arguments)),
        "versions": versions(),
        "element_order": made.order,
        "meshes": [MeshRecord.of(mesh).as_json() for mesh in made.meshes],
        "estimated_error": {k: float(f"{v:.3g}") for k, v in made.errors.items()},
        "bytes": len(content),
        "sha256": _sha256(content),
    }
    record["record_sha256"] = _record_hash(record)
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps(record, indent=1, ensure_ascii=False) + "\n"
    for suffix, data in ((".npz", content), (".json", text.encode())):
        unfinished = folder / (reference.name + suffix + ".part")
        unfinished.write_bytes(data)
        unfinished.replace(folder / (reference.name + suffix))
    return load(reference.name, folder)


def load(name: str, folder: Path = DATA) -> Stored:
    """Read a stored reference and verify it.

    Raises
    ------
    DamagedReferenceError
        If a file is missing, truncated or altered, or the record incomplete; names the file.
    """
    numbers, about = folder / f"{name}.npz", folder / f"{name}.json"
    rebuild = f"restore it or run: python -m references build {name}"
    for path in (about, numbers):
        if not path.is_file():
            raise DamagedReferenceError(f"{path}: the file is missing; {rebuild}")
    try:
        record = json.loads(about.read_text(encoding="utf-8"))
        _require_complete(record, name)
    except (ValueError, KeyError, TypeError, OSError, RecursionError) as error:
        raise DamagedReferenceError(
            f"{about}: not a complete record ({error}); {rebuild}"
        ) from error
    if _record_hash(record) != record["record_sha256"]:
        raise DamagedReferenceError(f"{about}: the record was altered; {rebuild}")
    try:
        content = numbers.read_bytes()
    except OSError as error:
        raise DamagedReferenceError(f"{numbers}: {error.strerror}; {rebuild}") from error
    if len(content) < record["bytes"]:
        raise DamagedReferenceError(
            f"{numbers}: truncated, {len(content)} of {record['bytes']} bytes; {rebuild}"
        )
    if _sha256(content) != record["sha256"]:
        raise DamagedReferenceError(
            f"{numbers}: altered, its SHA-256 is not the one in {about.name}; {rebuild}"
        )
    try:
        with np.load(io.BytesIO(content), allow_pickle=False) as archive:
            arrays = {key: archive[key] for key in archive.files}
    except Exception as error:
        # A record that was made of damaged numbers: zipfile, zlib and NumPy raise a dozen kinds.
        said = " ".join(str(error).split()) or type(error).__name__
        raise DamagedReferenceError(f"{numbers}: not an archive ({said}); {rebuild}") from error
    if set(arrays) != set(record["estimated_error"]):
        raise DamagedReferenceError(
            f"{about}: not a complete record (estimated errors of"
            f" {', '.join(record['estimated_error'])} for arrays {', '.join(arrays)}); {rebuild}"
        )
    return Stored(name, arrays, record)


def _require_complete(record: Any, name: str) -> None:
    """Raise ValueError or KeyError unless a record says all that a record says."""
    if not isinstance(record, dict):
        raise ValueError("no JSON object")
    for key, kind in _RECORD.items():
        if not isinstance(record[key], kind):
            raise ValueError(f"{key} is not what it should be")
        if kind in (str, dict) and key != "arguments" and not record[key]:
            raise ValueError(f"{key} is empty")
    if record["name"] != name:
        raise ValueError(f"the record is that of {record['name']}")
    if (record["element_order"] is None) != (not record["meshes"]):
        raise ValueError("meshes and element order belong together")
    for mesh in record["meshes"]:
        if not {"size", "points", "sha256"} < set(mesh):
            raise ValueError("a mesh has no size, points or sha256")
    if not all(isinstance(e, float | int) and e >= 0 for e in record["estimated_error"].values()):
        raise ValueError("an estimated error is no number")


def compare_with_catalogue(reference: Reference, stored: Stored) -> None:
    """Check that the record is that of the catalogue's entry: generator, arguments, citation.

    Raises
    ------
    DamagedReferenceError
        If the entry was changed since the reference was built; says in what.
    """
    wanted = {
        "title": reference.title,
        "citation": reference.citation,
        "generator": reference.generator_name,
        "arguments": json.loads(json.dumps(reference.arguments)),
    }
    changed = [key for key, value in wanted.items() if stored.record[key] != value]
    if changed:
        raise DamagedReferenceError(
            f"{reference.name}: stored with another {', '.join(changed)} than the catalogue has;"
            f" run: python -m references build {reference.name}"
        )


def _same_meshes(made: Generated, stored: Stored) -> bool:
    """Whether all meshes are among the recorded ones; without any on both sides nothing differs."""
    known = {mesh["sha256"] for mesh in stored.record["meshes"]}
    if bool(known) != bool(made.meshes):
        raise DamagedReferenceError(
            f"{stored.name}: {len(known)} meshes recorded, {len(made.meshes)} used when"
            " regenerated: the record does not belong to this generator"
        )
    return all(mesh.sha256 in known for mesh in made.meshes)


def regenerate_and_compare(reference: Reference, stored: Stored) -> float:
    """Run the generator again (its spot check) and compare.

    Arrays must agree to rounding if the meshes are the same, bit for bit, or there are none; else
    (another gmsh) within three times the estimated error.

    Returns
    -------
    float
        Largest difference found, over the arrays' largest magnitudes.

    Raises
    ------
    DamagedReferenceError
        If an array is missing or differs by more than allowed.
    """
    made = reference.generator(**{**reference.arguments, **reference.spot})
    same_meshes = _same_meshes(made, stored)
    rows: Any = slice(None)
    if reference.axis and reference.spot:
        axis = stored.arrays[reference.axis].tolist()
        rows = [axis.index(value) for value in made.arrays[reference.axis].tolist()]
    worst = 0.0
    # A part may be of some arrays only.
    for name in stored.arrays if not reference.spot else ():
        if name not in made.arrays:
            raise DamagedReferenceError(f"{stored.name}: no array {name!r} is made any more")
    for name, array in made.arrays.items():
        if name not in stored.arrays:
            raise DamagedReferenceError(f"{stored.name}: the stored file has no array {name!r}")
        old = stored.arrays[name][rows]
        if old.shape != np.shape(array):
            raise DamagedReferenceError(
                f"{stored.name}: {name!r} has shape {old.shape}, regenerated {np.shape(array)}"
            )
        scale = np.abs(stored.arrays[name]).max(initial=0.0) or 1.0
        difference = float(np.abs(array - old).max(initial=0.0) / scale)
        allowed = _ROUNDING if same_meshes else max(_ROUNDING, 3 * stored.error(name))
        if not difference <= allowed:
            raise DamagedReferenceError(
                f"{stored.name}: {name!r} regenerates with a difference of {difference:.2e},"
                f" {allowed:.1e} allowed"
            )
        worst = max(worst, difference)
    return worst
