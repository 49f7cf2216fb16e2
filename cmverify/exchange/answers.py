"""What another program answers, read from .npz, .csv, .vtu or a ParaView series (.pvd)."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from cmverify.exchange.layers import APART, LayerError, Layers, layers_of
from cmverify.exchange.statement import Array, Target


class AnswerError(ValueError):
    """A file that is no answer to the problem, in one line."""


@dataclass(frozen=True)
class Answer:
    """Values by key, and where they are.

    Attributes
    ----------
    name : str
        What tables call it.
    values : mapping from a target's key to an array
        A field (N,), (N, c), with times (T, N) or (T, N, c); or numbers (k,).
    points : (N, 2) array, optional
    triangles : (M, 3) int array, optional
        Between the points: values are interpolated on them.
    times : (T,) array, optional
    seconds, unknowns : number, optional
        What it took.
    known : tuple of str
        Everything that the file holds.
    notes : tuple of str
        What was made of it that a reader should know.
    """

    name: str
    values: dict[str, Array]
    points: Array | None = None
    triangles: NDArray[np.int64] | None = None
    times: Array | None = None
    seconds: float | None = None
    unknowns: int | None = None
    known: tuple[str, ...] = field(default=())
    notes: tuple[str, ...] = ()


def read(path: Path, targets: Sequence[Target]) -> Answer:
    """Read a file, whatever of the targets it holds.

    Raises
    ------
    AnswerError
        If it cannot be read, lacks a target that is needed, or holds what is no number.
    """
    readers = {".npz": _npz, ".csv": _csv, ".vtu": _vtu, ".vtk": _vtu, ".pvd": _pvd, ".json": _json}
    suffix = path.suffix.lower()
    if suffix not in readers:
        raise AnswerError(f"{path}: an answer is a .npz, .csv, .vtu, .pvd or .json file")
    if not path.is_file():
        raise AnswerError(f"{path}: there is no such file")
    try:
        answer = readers[suffix](path, targets)
    except AnswerError:
        raise
    except LayerError as error:
        raise AnswerError(f"{path}: {error}") from error
    except Exception as error:
        # Damaged files make zipfile, meshio, csv and NumPy raise a dozen kinds of errors.
        said = " ".join(str(error).split()) or type(error).__name__
        raise AnswerError(f"{path} cannot be read: {said}") from error
    _check(path, answer, targets)
    return answer


def _check(path: Path, answer: Answer, targets: Sequence[Target]) -> None:
    missing = [t for t in targets if t.needed and t.key not in answer.values]
    if missing:
        wanted = "; ".join(f"{t.key} (in columns: {', '.join(t.names)})" for t in missing)
        raise AnswerError(f"{path} lacks {wanted}; it holds {', '.join(answer.known) or 'nothing'}")
    for target in targets:
        values = answer.values.get(target.key)
        if values is None:
            continue
        if not np.issubdtype(values.dtype, np.number) or np.iscomplexobj(values):
            raise AnswerError(f"{path}: {target.key} is not made of real numbers")
        if target.points is None:
            if not target.line and values.shape != target.reference.shape:
                raise AnswerError(
                    f"{path}: {target.key} needs {len(target.reference)} numbers, "
                    f"not shape {values.shape}"
                )
            if not np.isfinite(values).all():
                raise AnswerError(f"{path}: {target.key} holds what is no finite number")
            continue
        if answer.points is None:
            raise AnswerError(f"{path} has no points for {target.key}: points (N, 2), or x and y")
        if target.times is not None and answer.times is None:
            raise AnswerError(f"{path} has no times for {target.key}: times (T,), or a .pvd series")
        timed = target.times is not None
        head = (
            (len(answer.times), len(answer.points))
            if timed and answer.times is not None
            else (len(answer.points),)
        )
        components = target.reference.shape[len(head) :]
        if values.shape != (*head, *components):
            raise AnswerError(
                f"{path}: {target.key} needs the shape {(*head, *components)} at "
                f"{len(answer.points)} points, not {values.shape}"
            )


def _number(value: Any) -> float | None:
    if value is None:
        return None
    found = float(np.asarray(value).reshape(()))
    if not (np.isfinite(found) and found >= 0.0):
        raise AnswerError(f"seconds and unknowns are positive numbers, not {found}")
    return found


def _answer(name: str, held: dict[str, Any], targets: Sequence[Target], **more: Any) -> Answer:
    """From named arrays: a key of its own, or columns that make it up."""
    values: dict[str, Array] = {}
    for target in targets:
        if target.key in held:
            values[target.key] = _flat(np.asarray(held[target.key]), target)
        elif all(column in held for column in target.names):
            parts = [np.asarray(held[column]) for column in target.names]
            values[target.key] = parts[0] if len(parts) == 1 else np.stack(parts, axis=-1)
    # What is read from a crack's path: given as such, or as nothing but points in their order.
    path = held.get("path", None if values else more.get("points"))
    for target in targets:
        if target.read is not None and path is not None and (target.line or target.key not in held):
            values[target.key] = target.read(_places(name, path)[:, :2])
    notes: tuple[str, ...] = ()
    if (points := more.get("points")) is not None:
        layers = layers_of(points) if points.shape[1] == 3 else None
        more["points"] = points[:, :2] if layers is None else layers.points
        if layers is not None:
            if more.get("triangles") is not None:
                more["triangles"] = layers.place[more["triangles"]]
            timed = {target.key for target in targets if target.times is not None}
            values, notes = _over_layers(layers, values, timed)
    unknowns = _number(held.get("unknowns"))
    return Answer(
        name,
        values,
        seconds=_number(held.get("seconds")),
        unknowns=None if unknowns is None else int(unknowns),
        known=tuple(sorted(map(str, held))),
        notes=notes,
        **more,
    )


def _over_layers(
    layers: Layers, values: dict[str, Array], timed: set[str]
) -> tuple[dict[str, Array], tuple[str, ...]]:
    """Means over the layers of a slab, and a word about them; numbers stay as they are."""
    found, worst = dict(values), 0.0
    for key, given in values.items():
        axis = 1 if key in timed else 0
        if given.ndim <= axis or given.shape[axis] != layers.members.size:
            continue
        mean, apart = layers.mean(np.moveaxis(given, axis, 0))
        if apart > APART:
            raise LayerError(
                f"the layers z of its {key} differ from their mean by {apart:.1%} of the largest "
                f"value: that is no plane problem; give one plane"
            )
        found[key], worst = np.moveaxis(mean, 0, axis), max(worst, apart)
    said = (
        f"the mean over {len(layers.members)} layers in z is judged; they differ from it by "
        f"{worst:.1e} of the largest value at most"
    )
    return found, (said,)


def _flat(values: Any, target: Target) -> Any:
    """Vectors of three components less the third, where the plane has two; columns as rows."""
    components = len(target.names)
    if values.ndim > 1 and components == 2 and values.shape[-1] == 3:
        return values[..., :2]
    if values.ndim > 1 and components == 1 and values.shape[-1] == 1:
        return values[..., 0]
    return values


def _places(path: Path | str, points: Any) -> Array:
    found = np.asarray(points, dtype=float)
    if found.ndim != 2 or found.shape[1] not in (2, 3) or not len(found):
        raise AnswerError(f"{path}: points need the shape (N, 2), not {found.shape}")
    if not np.isfinite(found).all():
        raise AnswerError(f"{path}: a point is not finite")
    return found


def _npz(path: Path, targets: Sequence[Target]) -> Answer:
    with np.load(path, allow_pickle=False) as archive:
        held = {key: archive[key] for key in archive.files}
    places: dict[str, Any] = {}
    if "points" in held:
        places["points"] = _places(path, held["points"])
    if "triangles" in held:
        places["triangles"] = _corners(path, held["triangles"], len(held.get("points", ())))
    if "times" in held:
        places["times"] = _times(path, held["times"])
    return _answer(path.stem, held, targets, **places)


def _corners(path: Path, triangles: Any, count: int) -> NDArray[np.int64]:
    found = np.asarray(triangles)
    whole = np.issubdtype(found.dtype, np.integer)
    if not whole or found.ndim != 2 or found.shape[1] != 3 or not len(found):
        raise AnswerError(f"{path}: triangles are numbers of points, shape (M, 3)")
    if found.min() < 0 or found.max() >= count:
        raise AnswerError(f"{path}: a triangle names a point that there is not")
    return found.astype(np.int64)


def _times(path: Path, times: Any) -> Array:
    found = np.asarray(times, dtype=float).ravel()
    if len(found) < 2 or not np.isfinite(found).all() or np.any(np.diff(found) <= 0):
        raise AnswerError(f"{path}: times are two or more ascending numbers")
    return found


def _json(path: Path, targets: Sequence[Target]) -> Answer:
    held = json.loads(_text(path), object_pairs_hook=_once)
    if not isinstance(held, dict):
        raise AnswerError(f"{path}: an answer in JSON is an object of named lists of numbers")
    arrays = {key: np.asarray(value) for key, value in held.items() if not isinstance(value, str)}
    places: dict[str, Any] = {}
    if "points" in arrays:
        places["points"] = _places(path, arrays["points"])
    if "times" in arrays:
        places["times"] = _times(path, arrays["times"])
    return _answer(path.stem, arrays, targets, **places)


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A JSON object whose names are all different."""
    names = [name for name, _ in pairs]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise ValueError(f"it says {twice[0]!r} twice")
    return dict(pairs)


def _text(path: Path) -> str:
    raw = path.read_bytes()
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw[: error.start].count(b"\n") + 1
        raise AnswerError(f"{path}:{line}: the file is not UTF-8") from error


def _csv(path: Path, targets: Sequence[Target]) -> Answer:
    """A header of names; x, y and columns of fields, or one column of numbers a key."""
    lines = [row for row in _text(path).splitlines() if row.strip()]
    if len(lines) < 2:
        raise AnswerError(f"{path}: a header of names and rows of numbers are needed")
    names = [name.strip().strip('"') for name in lines[0].lstrip("# ").split(",")]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise AnswerError(f"{path} has two columns {twice[0]!r}: which is it?")
    if len(names) == 1 and (other := next((c for c in ";\t " if c in names[0]), None)):
        raise AnswerError(f"{path}: columns are parted by commas, not by {other!r}")
    table = np.genfromtxt(lines[1:], delimiter=",", dtype=float, ndmin=2)
    if table.shape[1] != len(names):
        raise AnswerError(f"{path}: {len(names)} names and {table.shape[1]} columns")
    held: dict[str, Any] = dict(zip(names, table.T, strict=True))
    places: dict[str, Any] = {}
    x, y = (next((n for n in choice if n in held), None) for choice in (("x", "x1"), ("y", "x2")))
    if x is not None and y is not None:
        across = [held[z] for z in ("z", "x3") if z in held][:1]
        places["points"] = _places(path, np.column_stack([held[x], held[y], *across]))
        numbers: dict[str, Any] = {}
        if any(target.times is not None for target in targets) and "t" in held:
            return _series(path, held, held["t"], places["points"], targets)
    else:
        numbers = {key: column[~np.isnan(column)] for key, column in held.items()}
    return _answer(path.stem, {**held, **numbers}, targets, **places)


def _series(
    path: Path, held: dict[str, Any], when: Array, places: Array, targets: Sequence[Target]
) -> Answer:
    """Rows (t, x, y, values), sorted into times and points."""
    times, step = np.unique(when, return_inverse=True)
    points, site = np.unique(places, axis=0, return_inverse=True)
    if len(times) * len(points) != len(when):
        raise AnswerError(f"{path}: every time needs every point once")
    sorted_: dict[str, Any] = {}
    for name, column in held.items():
        grid = np.full((len(times), len(points)), np.nan)
        grid[step.ravel(), site.ravel()] = column
        sorted_[name] = grid
    return _answer(path.stem, sorted_, targets, points=points, times=_times(path, times))


def _vtu(path: Path, targets: Sequence[Target]) -> Answer:
    points, triangles, held = _mesh(path, targets)
    return _answer(path.stem, held, targets, points=points, triangles=triangles)


def _mesh(
    path: Path, targets: Sequence[Target]
) -> tuple[Array, NDArray[np.int64] | None, dict[str, Any]]:
    """Points, triangles and data of a file; data of cells at their middles, if that is all."""
    from cmverify.exchange import mesh_file

    try:
        mesh = mesh_file.read(path)
    except ValueError as error:
        raise AnswerError(str(error).replace(path.name, str(path), 1)) from error
    points = _places(path, mesh.points)
    wanted = {name for t in targets for name in (t.key, *t.names)}
    if wanted & set(mesh.point_data) or not wanted & set(mesh.cell_data):
        corners = [_split(block.type, block.data) for block in mesh.cells]
        found = [c for c in corners if c is not None]
        triangles = np.concatenate(found).astype(np.int64) if found else None
        held = {**mesh.point_data}
        for name, data in mesh.field_data.items() if hasattr(mesh, "field_data") else ():
            held.setdefault(name, data)
        return points, triangles, held
    middles = np.concatenate([points[block.data].mean(axis=1) for block in mesh.cells])
    return middles, None, {k: np.concatenate(list(v)) for k, v in mesh.cell_data.items()}


def _split(kind: str, cells: Any) -> Any:
    """Triangles of a block of cells, mid-side nodes left out; None for other cells."""
    if kind.startswith("triangle"):
        return cells[:, :3]
    if kind.startswith("quad"):
        return np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    return None


def _pvd(path: Path, targets: Sequence[Target]) -> Answer:
    """A ParaView series: all steps for what is judged in time, else the last one."""
    root = ElementTree.parse(path).getroot()
    listed = [
        (float(item.get("timestep", "nan")), path.parent / str(item.get("file")))
        for item in root.iter("DataSet")
        if item.get("part", "0") == "0"
    ]
    if not listed:
        raise AnswerError(f"{path} lists no DataSet")
    listed.sort(key=lambda step: step[0])
    if all(target.times is None for target in targets):
        listed = listed[-1:]
    for _, file in listed:
        if not file.is_file():
            raise AnswerError(f"{path} lists {file.name}, which is not there")
    steps = [_mesh(file, targets) for _, file in listed]
    points, triangles, held = steps[-1]
    if len(listed) == 1:
        return _answer(path.stem, held, targets, points=points, triangles=triangles)
    if any(len(other) != len(points) or not np.allclose(other, points) for other, _, _ in steps):
        raise AnswerError(f"{path}: the points move from step to step; give them as they were")
    shared = set.intersection(*(set(data) for _, _, data in steps))
    stacked = {name: np.stack([data[name] for _, _, data in steps]) for name in sorted(shared)}
    times = _times(path, [time for time, _ in listed])
    return _answer(path.stem, stacked, targets, points=points, triangles=triangles, times=times)
