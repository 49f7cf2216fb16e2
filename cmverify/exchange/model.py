"""What a scene file may say, declared once: tables, keys, kinds of values and their meaning.

The same declaration checks files and gives the JSON schema (`SceneFile.model_json_schema()`).
What the physics allows (a positive tensor, a support that holds something) is checked by the
solver's objects that `scene_file` builds from it.
"""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal

from pydantic import Field, StrictBool, model_validator

from cmverify.exchange.body_tables import Discretisation, Inclusion, Material, Region
from cmverify.exchange.table import Table, wrong
from cmverify.exchange.values import (
    Condition,
    Count,
    FileName,
    ForceOrSource,
    Levels,
    Matrix2,
    NotNegative,
    Number,
    Point,
    Points,
    Positive,
    Scalar,
    ScalarInTime,
    SteadyForceOrSource,
    TripleInTime,
    VectorInTime,
)

# ---- what holds it and acts on it -------------------------------------------------------

Unknown = Literal["u1", "u2", "rotation", "temperature", "potential"]


class Support(Table):
    """What is held: particles, the very edge, a rigid pin, a lead; or what moves alike."""

    kind: Literal["particles", "edge", "pin", "equal", "lead"] = Field(
        default="particles",
        description="Particles, or the very edge (surface = extrapolated); a rigid pin, of which "
        "what is not given stays free; unknowns of one common value; metal at one potential, which "
        "floats where none is given",
    )
    layer_cells: Positive | None = Field(default=None, description="Particles nearer to the edge")
    where: Condition | None = Field(default=None, description="Where this is true")
    region: Region | None = Field(
        default=None, description="Or within these shapes; bonds end at the rim of a lead so given"
    )
    unknowns: list[Unknown] | None = Field(default=None, description="That are equal")
    centre: Point | None = Field(
        default=None, description="Of a pin, m; the mean of its particles by default"
    )
    displacement: VectorInTime | None = Field(default=None, description="m")
    u1: ScalarInTime | None = Field(default=None, description="m")
    u2: ScalarInTime | None = Field(default=None, description="m")
    rotation: ScalarInTime | None = Field(default=None, description="rad")
    temperature: ScalarInTime | None = Field(default=None, description="K")
    potential: ScalarInTime | None = Field(default=None, description="V")

    @property
    def values(self) -> dict[str, Any]:
        """What is prescribed."""
        names = ("displacement", "u1", "u2", "rotation", "temperature", "potential")
        return {name: getattr(self, name) for name in names if getattr(self, name) is not None}

    @model_validator(mode="after")
    def _complete(self) -> Support:
        places = [k for k in ("layer_cells", "where", "region") if getattr(self, k) is not None]
        if self.kind != "particles" and self.layer_cells is not None:
            raise wrong("layer_cells", f"layer_cells says nothing of kind = {self.kind!r}")
        if len(places) > 1:
            raise wrong(places[1], f"give either {places[0]} or {places[1]}, not both")
        if self.kind == "particles" and not places:
            raise wrong("where", "needs either layer_cells, where or region")
        if not places and self.kind != "edge":
            raise wrong("where", f"the key 'where' is missing: kind = {self.kind!r} needs it")
        for key, owner in (("unknowns", "equal"), ("centre", "pin")):
            if getattr(self, key) is not None and self.kind != owner:
                raise wrong(key, f"{key} belongs to kind = {owner!r}")
        if self.kind == "equal":
            if not self.unknowns:
                raise wrong("unknowns", "say which unknowns are equal: u1, u2, rotation, …")
            if self.values:
                raise wrong(next(iter(self.values)), "what is equal has no value of its own")
        elif self.kind == "lead":
            if other := set(self.values) - {"potential"}:
                raise wrong(min(other), "a lead has a potential and nothing else")
        elif not self.values and self.kind != "pin":
            raise wrong(
                "",
                "prescribes nothing: give displacement, u1, u2, rotation, temperature or potential",
            )
        for key in ("u1", "u2"):
            if "displacement" in self.values and key in self.values:
                raise wrong(key, "give either displacement or u1 and u2, not both")
        return self


class BodyForce(Table):
    """A force on the body's volume."""

    kind: Literal["body_force"]
    value: VectorInTime = Field(description="N/m³")
    where: Condition | None = None


class Couple(Table):
    """A couple on the body's volume."""

    kind: Literal["couple"]
    value: ScalarInTime = Field(description="N m/m³")
    where: Condition | None = None


class Temperature(Table):
    """A change of temperature that strains the body."""

    kind: Literal["temperature"]
    value: ScalarInTime = Field(description="K")
    expansion: Matrix2 = Field(description="In the plane, 1/K; in plane strain the effective one")


class Source(Table):
    """A source of heat."""

    kind: Literal["source"]
    value: ScalarInTime = Field(description="W/m³")
    where: Condition | None = None


class Current(Table):
    """A current fed into the body."""

    kind: Literal["current"]
    value: ScalarInTime = Field(description="A/m³")
    where: Condition | None = None


class LeadCurrent(Table):
    """A lead that feeds in a current evenly."""

    kind: Literal["lead"]
    value: Number = Field(description="A per m of thickness")
    where: Condition | None = Field(default=None, description="Cells where this is true")
    region: Region | None = Field(
        default=None, description="Or metal of these shapes, at whose rim bonds end"
    )

    @model_validator(mode="after")
    def _placed(self) -> LeadCurrent:
        if (self.where is None) == (self.region is None):
            raise wrong("where", "a lead needs either where or region")
        return self


class PointLoad(Table):
    """A force, or a source of heat or current, at a point."""

    kind: Literal["point"]
    value: SteadyForceOrSource = Field(description="N, or W or A, each per m of thickness")
    at: Point = Field(description="m")


class LineLoad(Table):
    """A force per length, or a source, along a straight line in the body or on its edge."""

    kind: Literal["line"]
    value: ForceOrSource = Field(description="Pa, or W/m² or A/m²")
    start: Point = Field(description="m")
    end: Point = Field(description="m")

    @model_validator(mode="after")
    def _length(self) -> LineLoad:
        if self.start == self.end:
            raise wrong("end", "the line ends elsewhere than it starts")
        return self


class Traction(Table):
    """A traction on a straight part of the edge."""

    kind: Literal["traction"]
    value: VectorInTime = Field(description="Pa")
    start: Point = Field(description="m")
    end: Point = Field(description="m")

    @model_validator(mode="after")
    def _length(self) -> Traction:
        if self.start == self.end:
            raise wrong("end", "the edge ends elsewhere than it starts")
        return self


class Stress(Table):
    """The traction σ·n of a stress (σ11, σ22, σ12) on the body's edges."""

    kind: Literal["stress"]
    value: TripleInTime = Field(description="Pa")
    where: Condition | None = None


class Flux(Table):
    """What a flux carries into the body through its edges."""

    kind: Literal["flux"]
    value: VectorInTime = Field(description="W/m² or A/m²")
    where: Condition | None = None


Load = Annotated[
    BodyForce
    | Couple
    | Temperature
    | Source
    | Current
    | LeadCurrent
    | PointLoad
    | LineLoad
    | Traction
    | Stress
    | Flux,
    Field(discriminator="kind"),
]


class Crack(Table):
    """A crack: straight from start to end, or along the polyline through points."""

    start: Point | None = Field(default=None, description="m")
    end: Point | None = Field(default=None, description="m")
    points: Points | None = Field(default=None, description="Of a polyline, in turn, m")

    @property
    def path(self) -> list[tuple[float, float]]:
        """Its points, in turn."""
        found = self.points if self.points is not None else [self.start or [], self.end or []]
        return [(x, y) for x, y in found]

    @model_validator(mode="after")
    def _length(self) -> Crack:
        if self.points is None:
            for key in ("start", "end"):
                if getattr(self, key) is None:
                    raise wrong(key, "a crack needs start and end, or points")
        elif self.start is not None or self.end is not None:
            raise wrong("points", "a crack has either start and end or points")
        elif len(self.points) < 2:
            raise wrong("points", "a crack runs through two points or more")
        if all(point == self.path[0] for point in self.path):
            key = "end" if self.points is None else "points"
            raise wrong(key, "a crack ends elsewhere than it starts")
        return self


# ---- what is asked ----------------------------------------------------------------------


class Solve(Table):
    """How well the equations are solved."""

    tolerance: Positive = Field(default=1e-10, description="Relative residual, below 1")

    @model_validator(mode="after")
    def _small(self) -> Solve:
        if not self.tolerance < 1:
            raise wrong("tolerance", f"must lie between 0 and 1, not {self.tolerance:g}")
        return self


class Fracture(Table):
    """Fracture energies, load programme and options of a run in which cracks grow."""

    G1: Positive = Field(description="Fracture energy of a cut across the axis, J/m²")
    G2: Positive | None = Field(default=None, description="Of a cut along the axis, J/m²")
    n: Count = Field(default=2, description="Even exponent of the toughness law")
    frequency: Count = Field(default=1, description="Lobes of the toughness law over a half turn")
    axis_degrees: Number = Field(default=0.0, description="Axis of the toughness law")
    toughness_calibration: Literal["lattice", "continuum", "even", "directions"] = "lattice"
    start: NotNegative = Field(default=0.0, description="First load factor")
    stop: NotNegative | None = Field(default=None, description="Last load factor")
    increment: Positive | None = Field(default=None, description="Of the load factor")
    overload: Positive | None = Field(default=None, description="Admissible share above w_c")
    levels: Levels | None = Field(default=None, description="Load factors one after the other")
    control: Literal["fixed", "following"] = "fixed"
    batch: Count | None = Field(default=None, description="Bonds broken between two equilibria")
    criterion: Literal["total", "axial"] = "total"
    tension_only: StrictBool = True
    max_solves: Count | None = Field(default=None, description="The run ends there")
    tolerance: Positive = Field(default=1e-8, description="Relative residual, below 1")
    no_fail: Condition | None = Field(default=None, description="Where bonds never break")
    advance: Positive | None = Field(default=None, description="The run ends there, m")
    checkpoint: FileName | None = Field(default=None, description="File to save to and go on from")

    @model_validator(mode="after")
    def _ends(self) -> Fracture:
        ends = (self.stop, self.levels, self.advance, self.max_solves)
        if all(end is None for end in ends):
            raise wrong("", "has no end: give stop, levels, advance or max_solves")
        if not self.tolerance < 1:
            raise wrong("tolerance", f"must lie between 0 and 1, not {self.tolerance:g}")
        if self.stop is not None and self.stop < self.start:
            raise wrong("stop", f"the programme stops at {self.stop:g}, before it starts")
        return self


class Line(Table):
    """A line along which fields are written, at the particles nearest to it."""

    name: FileName = Field(description="Of its table, <out>.line-<name>.csv")
    start: Point = Field(description="m")
    end: Point = Field(description="m")
    count: Count = Field(default=101, description="Points; those outside the body are left out")

    @model_validator(mode="after")
    def _checked(self) -> Line:
        if not re.fullmatch(r"[\w-]+", self.name):
            raise wrong("name", f"a name of letters, digits, - and _, not {self.name!r}")
        if self.start == self.end:
            raise wrong("end", "the line ends elsewhere than it starts")
        if not 2 <= self.count <= 10**6:
            raise wrong("count", f"must be from 2 to 10⁶, not {self.count}")
        return self


class Output(Table):
    """What is written, and how stresses are recovered."""

    fields: list[FileName] | None = Field(
        default=None, description="By name; all by default", examples=[["displacement"]]
    )
    stress_rule: Literal["plane", "family"] | None = Field(
        default=None,
        description="Force through a section, or half the virial of a particle's own bonds; by "
        "default what fits the surface treatment",
    )
    line: list[Line] = Field(default=[])

    @model_validator(mode="after")
    def _names(self) -> Output:
        names = [line.name for line in self.line]
        for k, name in enumerate(names):
            if name in names[:k]:
                raise wrong("line", f"two lines are called {name!r}")
        return self


class SceneFile(Table):
    """A scene file."""

    title: str = ""
    thickness: Scalar | None = Field(default=None, description="Of the body, m")
    discretisation: Discretisation
    region: Region
    material: Material
    support: list[Support] = Field(default=[])
    load: list[Load] = Field(default=[])
    inclusion: list[Inclusion] = Field(default=[])
    crack: list[Crack] = Field(default=[])
    solve: Solve = Solve()
    fracture: Fracture | None = None
    output: Output = Output()
    compare: Literal["fem"] | None = Field(
        default=None, description="Finite elements solve the same scene; see --compare"
    )
