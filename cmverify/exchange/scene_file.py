"""Scenes in TOML: read, checked key by key, turned into a `solver.Scene`.

See examples/disc.toml for a complete one. A key that does not exist is refused with its line and
the nearest key that does.
"""

from __future__ import annotations

import difflib
import re
import tomllib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cmverify.exchange import fracture_table
from cmverify.exchange.expressions import Formula
from cmverify.exchange.fracture_table import Plan

if TYPE_CHECKING:
    from solver import Crack, Load, Region, Scene, Support

REGIONS = {
    "disc": {"radius", "centre"},
    "rectangle": {"width", "height", "centre"},
    "polygon": {"vertices"},
}
MATERIALS = {
    "conductivity": {"tensor", "angle_degrees"},
    "elastic": {"voigt", "angle_degrees"},
    "isotropic": {"E", "nu", "plane"},
    "orthotropic": {"E1", "E2", "G12", "nu12", "plane", "angle_degrees"},
}
DISCRETISATION = {"spacing", "m", "calibration", "area_rule", "influence", "surface", "law"}
LAWS = {"cosine", "two-harmonic", "fourfold", "uniform-shear"}
VALUES = {"displacement", "u1", "u2", "rotation", "temperature"}
LOADS = {
    "body_force": {"value", "where"},
    "couple": {"value", "where"},
    "source": {"value", "where"},
    "traction": {"value", "start", "end"},
    "stress": {"value", "where"},
    "flux": {"value", "where"},
}
SECTIONS = {"title", "discretisation", "region", "material", "support", "load", "crack", "solve"}
SECTIONS |= {"fracture"}


class SceneFileError(ValueError):
    """A scene file asks for something that does not exist or leaves out what is needed."""


class _Source:
    """The file's text, to find the line of a key: tomllib does not keep it."""

    def __init__(self, path: Path, text: str) -> None:
        self.path, self.lines = path, text.splitlines()

    def error(self, section: str, message: str, key: str | None = None) -> SceneFileError:
        line = self._line(section, key)
        place = f"{self.path}:{line}" if line else str(self.path)
        return SceneFileError(
            f"{place}: [{section}] {message}" if section else f"{place}: {message}"
        )

    def _line(self, section: str, key: str | None) -> int | None:
        name, _, index = section.partition(" ")
        occurrence = int(index.strip("#")) if index else 1
        start, seen = (0, occurrence) if not section else (None, 0)
        for number, line in enumerate(self.lines, 1):
            header = re.match(r"\s*\[+\s*([\w.-]+)\s*\]+", line)
            if header:
                if start is not None and section:
                    break
                seen += header[1] == name
                if header[1] == name and seen == occurrence:
                    start = number
            if (
                start is not None
                and key
                and re.match(rf"\s*[\"']?{re.escape(key)}[\"']?\s*=", line)
            ):
                return number
            if not section and key and header and header[1] == key:
                return number
        return start or None


def read(path: Path) -> tuple[Scene, dict[str, Any]]:
    """Read a scene and the keyword arguments of its `solve`.

    Raises
    ------
    SceneFileError
        If the file is missing, is not TOML, or has a key or value that does not exist.
    """
    try:
        text = path.read_text()
        data = tomllib.loads(text)
    except OSError as error:
        raise SceneFileError(f"{path} cannot be read: {error.strerror}") from error
    except tomllib.TOMLDecodeError as error:
        raise SceneFileError(f"{path} is not TOML: {error}") from error
    source = _Source(path, text)
    _known(source, "", data, SECTIONS)
    for section in ("discretisation", "region", "material"):
        if section not in data:
            raise source.error("", f"the section [{section}] is missing")
    from solver import Scene

    try:
        options = _discretisation(source, data["discretisation"])
        scene = Scene(
            region=_region(source, data["region"]),
            material=_material(source, data["material"]),
            supports=[
                _support(source, f"support #{i}", table)
                for i, table in enumerate(data.get("support", []), 1)
            ],
            loads=[
                _load(source, f"load #{i}", table)
                for i, table in enumerate(data.get("load", []), 1)
            ],
            cracks=[
                _crack(source, f"crack #{i}", table)
                for i, table in enumerate(data.get("crack", []), 1)
            ],
            **options,
        )
    except SceneFileError:
        raise
    except (ValueError, TypeError) as error:
        raise SceneFileError(f"{path}: {error}") from error
    solve = data.get("solve", {})
    _known(source, "solve", solve, {"tolerance"})
    return scene, solve


def read_fracture(path: Path) -> Plan | None:
    """The [fracture] table of a scene file, or None if it has none.

    Raises
    ------
    SceneFileError
        As `read`.
    """
    text = path.read_text()
    table = tomllib.loads(text).get("fracture")
    if table is None:
        return None
    source = _Source(path, text)
    _known(source, "fracture", table, fracture_table.KEYS)
    try:
        return fracture_table.plan(
            table, lambda key, value: _formula(source, "fracture", key, value)
        )
    except SceneFileError:
        raise
    except (ValueError, TypeError) as error:
        raise source.error("fracture", str(error)) from error


def _known(source: _Source, section: str, table: Mapping[str, Any], keys: set[str]) -> None:
    if not isinstance(table, Mapping):
        raise source.error(section, "must be a table of keys and values")
    for key in table:
        if key not in keys:
            near = difflib.get_close_matches(key, keys, n=1, cutoff=0.5)
            hint = f"did you mean {near[0]!r}?" if near else f"known: {', '.join(sorted(keys))}"
            raise source.error(section, f"unknown key {key!r}; {hint}", key)


def _need(source: _Source, section: str, table: Mapping[str, Any], key: str) -> Any:
    if key not in table:
        raise source.error(section, f"the key {key!r} is missing")
    return table[key]


def _kind(
    source: _Source, section: str, table: Mapping[str, Any], key: str, kinds: Mapping[str, set[str]]
) -> str:
    """The value of `key`, which decides what other keys there may be."""
    kind = _need(source, section, table, key)
    if kind not in kinds:
        raise source.error(section, f"{key} = {kind!r} is not one of {', '.join(kinds)}", key)
    _known(source, section, table, kinds[kind] | {key})
    return str(kind)


def _formula(source: _Source, section: str, key: str, value: Any) -> Any:
    """A number as it is, a formula as a function, a list of them as a vector function."""
    try:
        if isinstance(value, str):
            return Formula(value)
        if isinstance(value, list) and any(isinstance(part, str) for part in value):
            parts = [Formula(str(part)) for part in value]
            return _stack(parts)
    except ValueError as error:
        raise source.error(section, str(error), key) from error
    return value


def _stack(parts: list[Formula]) -> Callable[..., Any]:
    return lambda x, y: np.stack([part(x, y) for part in parts], axis=-1)


def _discretisation(source: _Source, table: Mapping[str, Any]) -> dict[str, Any]:
    section = "discretisation"
    _known(source, section, table, DISCRETISATION | {"exponent"})
    options = {k: v for k, v in table.items() if k not in ("law", "exponent")}
    _need(source, section, table, "spacing")
    if "exponent" in table and table.get("law") != "cosine":
        raise source.error(section, 'an exponent belongs to law = "cosine"', "exponent")
    if "law" in table:
        from solver import Cosine, Fourfold, TwoHarmonic, UniformShear

        laws: dict[str, Callable[[], Any]] = {
            "cosine": lambda: Cosine(table.get("exponent")),
            "two-harmonic": TwoHarmonic,
            "fourfold": Fourfold,
            "uniform-shear": UniformShear,
        }
        if table["law"] not in laws:
            message = f"law = {table['law']!r} is not one of {', '.join(laws)}"
            raise source.error(section, message, "law")
        options["law"] = laws[table["law"]]()
    return options


def _region(source: _Source, table: Mapping[str, Any]) -> Region:
    import solver

    shape = _kind(source, "region", table, "shape", REGIONS)
    values = {k: v for k, v in table.items() if k != "shape"}
    try:
        region: Region = getattr(solver, shape)(**values)
    except TypeError as error:
        raise source.error("region", f"a {shape} needs other keys: {error}", "shape") from error
    return region


def _material(source: _Source, table: Mapping[str, Any]) -> Any:
    from solver import ConductivityTensor, ElasticTensor

    kind = _kind(source, "material", table, "kind", MATERIALS)
    values = {k: v for k, v in table.items() if k not in ("kind", "angle_degrees")}
    material: Any
    if kind == "conductivity":
        material = ConductivityTensor(_need(source, "material", table, "tensor"))
    elif kind == "elastic":
        material = ElasticTensor(_need(source, "material", table, "voigt"))
    else:
        for key in sorted(MATERIALS[kind] - {"plane", "angle_degrees"}):
            _need(source, "material", table, key)
        material = getattr(ElasticTensor, kind)(**values)
    angle = float(table.get("angle_degrees", 0.0))
    return material.rotated(np.radians(angle)) if angle else material


def _support(source: _Source, section: str, table: Mapping[str, Any]) -> Support:
    from solver import Support

    _known(source, section, table, VALUES | {"layer_cells", "where"})
    values = {k: _formula(source, section, k, table[k]) for k in VALUES if k in table}
    if ("layer_cells" in table) == ("where" in table):
        raise source.error(section, "needs either layer_cells or where")
    if "layer_cells" in table:
        return Support.layer(cells=table["layer_cells"], **values)
    return Support.where(_formula(source, section, "where", table["where"]), **values)


def _load(source: _Source, section: str, table: Mapping[str, Any]) -> Load:
    from solver import Load

    kind = _kind(source, section, table, "kind", LOADS)
    value = _formula(source, section, "value", _need(source, section, table, "value"))
    if kind == "traction":
        ends = [tuple(_need(source, section, table, key)) for key in ("start", "end")]
        return Load.traction(value, ends[0], ends[1])
    where = table.get("where")
    selected = _formula(source, section, "where", where) if where is not None else None
    load: Load = getattr(Load, kind)(value, where=selected)
    return load


def _crack(source: _Source, section: str, table: Mapping[str, Any]) -> Crack:
    from solver import Crack

    _known(source, section, table, {"start", "end"})
    start, end = (tuple(_need(source, section, table, key)) for key in ("start", "end"))
    return Crack(start, end)
