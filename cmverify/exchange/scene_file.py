"""Scenes in TOML: read, checked key by key, turned into a `solver.Scene`.

See examples/disc.toml for a complete one, and `model` for what there is to say. A file is refused
in one line that names it, the line and the key: what the declaration does not allow, what the
solver's objects do not accept, formulas without a value on the body, and what would cost too much.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cmverify.exchange import beforehand, body_tables, budget, comparison, model, shapes
from cmverify.exchange.model import SceneFile
from cmverify.exchange.output import check_fields
from cmverify.exchange.refusal import SceneFileError, Source
from cmverify.exchange.request import Request, timed

if TYPE_CHECKING:
    from solver import Crack, Inclusion, Load, Scene, Support

__all__ = ["Request", "SceneFileError", "read", "request"]


def request(path: Path, memory: float | None = None, seconds: float = budget.SECONDS) -> Request:
    """Read a scene file and check everything that can be checked without solving it.

    Parameters
    ----------
    path : Path
    memory : float, optional
        Bytes that it may take; most of what is free by default.
    seconds : float
        Seconds that set-up and a solve may take by the estimate.

    Raises
    ------
    SceneFileError
        If the file is missing, is not TOML, says something that does not exist or makes no sense,
        or asks for more than may be spent.
    """
    return request_of(source_of(path), memory, seconds)


def request_of(
    source: Source, memory: float | None = None, seconds: float = budget.SECONDS
) -> Request:
    """As `request`, of a file that was read (and changed, as a sweep does)."""
    file = declared(source)
    scene = _scene(file, source)
    cost = beforehand.afford(file, scene, source, memory, seconds)
    analysis, options = _asked(file, source)
    _timeless(file, source, analysis)
    _writable(file, scene, source, analysis)
    found = Request(source, file, scene, analysis, options, cost)
    if file.compare is not None:
        comparison.check(found)
    # Later times are tried by the analysis, before it starts.
    beforehand.try_on_lattice(file, scene, source, float(options.get("start", 0.0)))
    return found


def read(path: Path) -> tuple[Scene, dict[str, Any]]:
    """The scene of a file and the keyword arguments of its `solve`.

    Raises
    ------
    SceneFileError
        As `request`.
    """
    found = request(path)
    return found.scene, found.file.solve.model_dump(exclude_unset=True)


def _asked(file: SceneFile, source: Source) -> tuple[str, dict[str, Any]]:
    """The analysis that a file asks for, and its keywords."""
    from solver import state_file
    from solver.analyses import analyses

    given = {name: getattr(file, name, None) for name in analyses() if name != "solve"}
    asked = {name: table for name, table in given.items() if table is not None}
    if len(asked) > 1:
        first, second = list(asked)[:2]
        raise source.error((second,), f"one analysis at a time: the file has [{first}] too")
    name, table = next(iter(asked.items()), ("solve", file.solve))
    options = {key: getattr(table, key) for key in table.model_fields_set}
    if "checkpoint" in options:
        with source.at(name, "checkpoint"):
            state_file.check(options["checkpoint"])
    for key, value in options.items():
        if shapes.drawn(value):
            with source.at(name, key):
                step = file.discretisation.spacing
                options[key] = shapes.region(value, source.path.parent, step)
    return name, options


def _writable(file: SceneFile, scene: Scene, source: Source, analysis: str) -> None:
    """Refuse outputs that there cannot be."""
    from solver.analyses import analyses
    from solver.material.physics import ELASTICITY

    with source.at("output", "fields"):
        check_fields(file.output.fields)
    stressed = analyses()[analysis].stressed and scene.physics is ELASTICITY
    if file.output.stress_rule is not None and not stressed:
        what = analysis if analysis != "solve" else f"a scene of {scene.physics.name}"
        raise source.error(("output", "stress_rule"), f"{what} writes no stress to recover")


def _timeless(file: SceneFile, source: Source, analysis: str) -> None:
    """Refuse values that depend on time where there is none."""
    from solver.analyses import analyses

    if analyses()[analysis].timed:
        return
    known = " or ".join(f"[{name}]" for name, one in analyses().items() if one.timed)
    what = "statics" if analysis == "solve" else f"[{analysis}]"
    for place, value in timed(file):
        raise source.error(
            place,
            f"{value.texts[0]!r} depends on the time t, and {what} knows no time: ask for {known}",
        )


# ---- from bytes to the declared model ---------------------------------------------------


def source_of(path: Path) -> Source:
    """A file as it stands, TOML and no more."""
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except OSError as error:
        raise SceneFileError(f"{path} cannot be read: {error.strerror}") from error
    except ValueError as error:
        if not isinstance(error, UnicodeDecodeError):  # a name that no file can have
            raise SceneFileError(f"{str(path)!r} cannot be read: {error}") from error
        line = error.object[: error.start].count(b"\n") + 1
        raise SceneFileError(
            f"{path}:{line}: the file is not UTF-8 (byte {error.object[error.start]:#04x})"
        ) from error
    try:
        return Source(path, text, tomllib.loads(text))
    except RecursionError as error:
        raise SceneFileError(f"{path} is not TOML of a scene: nested too deeply") from error
    except ValueError as error:
        # Where the text breaks off tomllib says "at end of document", and no line.
        found = re.search(r"at line (\d+)", str(error))
        line = int(found[1]) if found else max(1, len(text.splitlines()))
        raise SceneFileError(f"{path}:{line}: is not TOML: {error}") from error


def declared(source: Source) -> SceneFile:
    """The model of what a file says, before anything is built."""
    from pydantic import ValidationError

    from cmverify.exchange.analysis_table import scene_model

    try:
        return scene_model().model_validate(source.data)
    except ValidationError as error:
        raise source.invalid(error) from None


# ---- from the model to the solver's objects ---------------------------------------------


def _scene(file: SceneFile, source: Source) -> Scene:
    from solver import Scene

    options = dict(file.discretisation)
    law, exponent = options.pop("law"), options.pop("exponent")
    folder, step = source.path.parent, file.discretisation.spacing
    with source.at("region"):
        region = shapes.region(file.region, folder, step)
    with source.at("material"):
        material = _material(file.material)
    supports, loads, cracks, inclusions = [], [], [], []
    for i, inclusion in enumerate(file.inclusion):
        with source.at("inclusion", i):
            inclusions.append(_inclusion(inclusion, material, folder, step))
            # Whether such a solid goes with the body's.
            Scene(region, options["spacing"], material, inclusions=inclusions[-1:], **_stores(file))
    for i, support in enumerate(file.support):
        with source.at("support", i):
            supports.append(_support(support, shapes.place(support, folder, step)))
    for i, load in enumerate(file.load):
        with source.at("load", i):
            loads.append(_load(load, shapes.place(load, folder, step)))
            # Whether such a load acts on such a body.
            Scene(region, options["spacing"], material, loads=loads)
    for i, crack in enumerate(file.crack):
        with source.at("crack", i):
            cracks.append(_crack(crack))
    with source.at("discretisation"):
        return Scene(
            region=region,
            material=material,
            supports=supports,
            loads=loads,
            cracks=cracks,
            law=_law(law, exponent),
            inclusions=inclusions,
            thickness=file.thickness,
            **_stores(file),
            **options,
        )


def _stores(table: Any) -> dict[str, Any]:
    """Density and heat capacity of a file's, or an inclusion's, material."""
    names = ("density", "heat_capacity")
    return {name: getattr(table.material, name, None) for name in names}


def _law(name: str | None, exponent: int | None) -> Any:
    import solver

    if name is None:
        return None
    laws: dict[str, Callable[[], Any]] = {
        "cosine": lambda: solver.Cosine(exponent),
        "two-harmonic": solver.TwoHarmonic,
        "fourfold": solver.Fourfold,
        "uniform-shear": solver.UniformShear,
    }
    return laws[name]()


def _inclusion(table: body_tables.Inclusion, material: Any, folder: Path, step: float) -> Inclusion:
    from solver import ExpansionTensor, Inclusion

    own = material if table.material is None else _material(table.material)
    expansion = None if table.expansion is None else ExpansionTensor(table.expansion)
    return Inclusion(
        shapes.region(table.region, folder, step),
        own,
        thickness=table.thickness,
        expansion=expansion,
        **_stores(table),
    )


def _material(table: Any) -> Any:
    from solver import (
        ChiralTensor,
        ConductivityTensor,
        ElasticTensor,
        ElectricConductivityTensor,
        PolarTensor,
    )

    if table.kind == "conductivity":
        material: Any = (
            ConductivityTensor.orthotropic(*table.principal)
            if table.tensor is None
            else ConductivityTensor(table.tensor)
        )
    elif table.kind == "electric":
        if table.tensor is not None:
            material = ElectricConductivityTensor(table.tensor)
        else:
            material = ElectricConductivityTensor.of_resistivities(*table.resistivities)
    elif table.kind == "elastic":
        material = (
            ElasticTensor.of_compliance(table.compliance)
            if table.voigt is None
            else ElasticTensor(table.voigt)
        )
    else:
        own = ("kind", "angle_degrees", "density", "bending", "turn")
        values = {k: v for k, v in table if k not in own and v is not None}
        material = getattr(ElasticTensor, table.kind)(**values)
    if (turn := getattr(table, "turn", None)) is not None:
        material = ChiralTensor(material, turn)
    if (bending := getattr(table, "bending", None)) is not None:
        material = PolarTensor(material, bending)
    angle = getattr(table, "angle_degrees", 0.0)
    return material.rotated(np.radians(angle)) if angle else material


def _support(table: model.Support, place: Any) -> Support:
    from solver import Support

    if table.layer_cells is not None:
        return Support.layer(cells=table.layer_cells, **table.values)
    if table.kind == "edge":
        return Support.edge(place, **table.values)
    if table.kind == "pin":
        centre = None if table.centre is None else (table.centre[0], table.centre[1])
        return Support.pin(place, centre, **table.values)
    if table.kind == "equal":
        return Support.equal(place, *(table.unknowns or ()))
    if table.kind == "lead":
        return Support.lead(place, **table.values)
    return Support.where(place, **table.values)


def _load(table: Any, place: Any) -> Load:
    from solver import ExpansionTensor, Load

    if table.kind == "traction":
        return Load.traction(table.value, tuple(table.start), tuple(table.end))
    if table.kind == "line":
        return Load.line(table.value, tuple(table.start), tuple(table.end))
    if table.kind == "point":
        return Load.point(table.value, tuple(table.at))
    if table.kind == "temperature":
        return Load.temperature(table.value, ExpansionTensor(table.expansion))
    load: Load = getattr(Load, table.kind)(table.value, where=place)
    return load


def _crack(table: model.Crack) -> Crack:
    from solver import Crack

    return Crack(*table.path)
