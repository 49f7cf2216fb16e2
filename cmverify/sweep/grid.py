"""What a sweep is: a scene file, and the settings that are changed in it.

```toml
scene = "plate.toml"

[grid]
spacing = [0.05, 0.025]
surface = ["volume", "extrapolated"]
angle = [0, 30, 60]
"load.0.value" = [[1.0, 0.0], [0.0, 1.0]]

[grid.material]              # whole materials, by names of their own
bone = { kind = "orthotropic", E1 = 2e10, E2 = 1e10, G12 = 4e9, nu12 = 0.3 }
steel = { kind = "isotropic", E = 210e9, nu = 0.3 }
```

Short names are keys of [discretisation], and `angle` is material.angle_degrees; any other key is
named by its place, tables and indices joined by dots. A material comes before what is changed in
it.
"""

from __future__ import annotations

import copy
import functools
import hashlib
import itertools
import json
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from cmverify.exchange import scene_file
from cmverify.exchange.refusal import SceneFileError, Source

_SHORT: dict[str, str] = {
    **{
        name: f"discretisation.{name}"
        for name in (
            "spacing", "m", "calibration", "area_rule", "influence", "surface", "law", "exponent",
        )
    },
    "angle": "material.angle_degrees",
}  # fmt: skip
_MOST = 100_000


@dataclass(frozen=True)
class Point:
    """One point of a grid.

    Attributes
    ----------
    key : str
        Of scene, drawings, settings and code: another of any of them is another point.
    labels : dict
        What the table says of it, by the names of the grid.
    path, text : str
        The scene file that is changed.
    changes : tuple of (str, value)
        Places and what is put there, in turn.
    """

    key: str
    labels: dict[str, Any]
    path: str
    text: str
    changes: tuple[tuple[str, Any], ...]

    def source(self) -> Source:
        """The scene file with its changes.

        Raises
        ------
        SceneFileError
            If a place is none of the file's.
        """
        data: dict[str, Any] = copy.deepcopy(tomllib.loads(self.text))
        for place, value in self.changes:
            put(data, place, copy.deepcopy(value))
        return Source(Path(self.path), self.text, data)


def put(data: dict[str, Any], place: str, value: Any) -> None:
    """Set what stands at a place such as "load.0.value".

    Raises
    ------
    SceneFileError
        If a table or an index on the way is not there.
    """
    here: Any = data
    *way, last = place.split(".")
    for part in way:
        index: Any = int(part) if isinstance(here, list) and part.isdigit() else part
        try:
            here = here[index]
        except (KeyError, IndexError, TypeError) as error:
            raise SceneFileError(f"the grid's {place}: the scene has no {part!r} there") from error
    if isinstance(here, list) and last.isdigit() and int(last) < len(here):
        here[int(last)] = value
    elif isinstance(here, dict):
        here[last] = value
    else:
        raise SceneFileError(f"the grid's {place}: the scene has no {last!r} there")


def read(path: Path) -> list[Point]:
    """The points of a sweep's file, each checked as a scene file is before anything is built.

    Raises
    ------
    SceneFileError
        With file, line and key.
    """
    source = scene_file.source_of(path)
    strange = set(source.data) - {"scene", "grid", "title"}
    if strange:
        name = sorted(strange)[0]
        raise source.error((name,), f"a sweep has scene and [grid], and no {name!r}")
    scene, grid = source.data.get("scene"), source.data.get("grid")
    if not isinstance(scene, str):
        raise SceneFileError(f'{path}: name the scene that is changed: scene = "plate.toml"')
    if not isinstance(grid, dict) or not grid:
        raise SceneFileError(f"{path}: a sweep needs a [grid] of lists, such as m = [3, 5]")
    try:
        return points(path.parent / scene, grid)
    except GridError as error:
        raise source.error(("grid", error.name), str(error)) from error


class GridError(ValueError):
    """A setting of a grid that is no list of values; `name` is its name."""

    def __init__(self, name: str, message: str) -> None:
        super().__init__(message)
        self.name = name


def points(scene: Path, grid: Mapping[str, Any]) -> list[Point]:
    """Every combination of a grid's values in a scene file, the last setting running fastest.

    Parameters
    ----------
    scene : Path
    grid : mapping from a name or a place to a list of values, or to a mapping of named tables

    Raises
    ------
    GridError, SceneFileError
    """
    from cmverify.run.results import source_fingerprint

    base = scene_file.source_of(scene)
    text = scene.read_text(encoding="utf-8-sig")
    axes = {name: _values(name, given) for name, given in grid.items()}
    total = 1
    for values in axes.values():
        total *= len(values)
    if total > _MOST:
        raise SceneFileError(f"the grid has {total} points, more than {_MOST}")
    # A whole table first: what is changed in it comes after.
    places: dict[str, str] = {name: _SHORT.get(name, name) for name in axes}
    order = sorted(axes, key=lambda name: places[name].count("."))
    found, seen = [], set()
    drawn = functools.cache(_contents)
    for chosen in itertools.product(*axes.values()):
        labels = {name: label for name, (label, _) in zip(axes, chosen, strict=True)}
        given = {name: value for name, (_, value) in zip(axes, chosen, strict=True)}
        changes = tuple((places[name], given[name]) for name in order)
        point = Point("", labels, str(base.path), text, changes)
        source = point.source()
        file = scene_file.declared(source)
        _require_own_files(file, source)
        files = [drawn(base.path.parent / path) for path in _files(source.data)]
        said = json.dumps([text, changes, files, source_fingerprint()], sort_keys=True, default=str)
        key = hashlib.sha256(said.encode()).hexdigest()[:20]
        if key in seen:
            raise SceneFileError(f"the grid has {labels} twice")
        seen.add(key)
        found.append(replace(point, key=key))
    return found


def _require_own_files(file: Any, source: Source) -> None:
    """Points that go on from one file, or write to one, would take each other's states."""
    for name in type(file).model_fields:
        for key in ("checkpoint", "series"):
            if getattr(getattr(file, name), key, None) is not None:
                raise source.error(
                    (name, key), f"the points of a sweep would share a {key}: leave it out"
                )


def _files(data: Any) -> Iterator[str]:
    """Paths of the drawings that a scene names."""
    if isinstance(data, Mapping):
        if data.get("shape") == "file":
            yield str(data["path"])
        data = list(data.values())
    if isinstance(data, list):
        for item in data:
            yield from _files(item)


def _contents(path: Path) -> str:
    """Hash of a file; that it cannot be read is said when the body is built."""
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError:
        return ""


def _values(name: str, given: Any) -> list[tuple[Any, Any]]:
    """Labels and values of one setting."""
    if isinstance(given, Mapping):
        found: list[tuple[Any, Any]] = [(str(label), value) for label, value in given.items()]
    elif isinstance(given, Sequence) and not isinstance(given, str):
        found = [(_label(value), value) for value in given]
    else:
        raise GridError(name, f"a list of values is needed, not {given!r}")
    if not found:
        raise GridError(name, "the list is empty")
    return found


def _label(value: Any) -> Any:
    return value if isinstance(value, str | int | float | bool) else json.dumps(value, default=str)
