"""What a scene file may say, declared once: tables, keys, kinds of values and their meaning.

The same declaration checks files and gives the JSON schema (`SceneFile.model_json_schema()`).
What the physics allows (a positive tensor, a support that holds something) is checked by the
solver's objects that `scene_file` builds from it.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Mapping
from typing import Annotated, Any, Literal, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    StrictBool,
    Tag,
    model_validator,
)
from pydantic_core import PydanticCustomError

from cmverify.exchange.values import (
    Condition,
    Count,
    FileName,
    ForceOrSource,
    Levels,
    Matrix2,
    Matrix3,
    NotNegative,
    Number,
    Point,
    Points,
    Positive,
    Scalar,
    ScalarInTime,
    SteadyForceOrSource,
    Triple,
    TripleInTime,
    VectorInTime,
)


def wrong(key: str, message: str) -> PydanticCustomError:
    """An error of a whole table that points to one of its keys."""
    # The message is a template: what it says is not.
    return PydanticCustomError("scene", "{said}", {"said": message, "key": key})


class Table(BaseModel):
    """A table of a scene file: no keys but those declared."""

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)

    @model_validator(mode="before")
    @classmethod
    def _known(cls, data: Any) -> Any:
        if not isinstance(data, Mapping):
            raise ValueError("must be a table of keys and values")
        for key in data:
            if key not in cls.model_fields:
                near = difflib.get_close_matches(key, cls.model_fields, n=1, cutoff=0.5)
                known = ", ".join(sorted(cls.model_fields))
                hint = f"did you mean {near[0]!r}?" if near else f"known: {known}"
                raise wrong(key, f"unknown key {key!r}; {hint}")
        return data


# ---- the body ---------------------------------------------------------------------------


class _Shape(Table):
    """A shape, and what it does to those before it in a list."""

    operation: Literal["add", "subtract", "intersect"] = Field(
        default="add", description="In a list of shapes, one after the other"
    )


class Disc(_Shape):
    """A disc."""

    shape: Literal["disc"]
    radius: Positive = Field(description="m")
    centre: Point = Field(default=[0.0, 0.0], description="m")


class Rectangle(_Shape):
    """A rectangle, its sides along the axes unless it is turned."""

    shape: Literal["rectangle"]
    width: Positive = Field(description="m")
    height: Positive = Field(description="m")
    centre: Point = Field(default=[0.0, 0.0], description="m")
    angle_degrees: Number = Field(default=0.0, description="Turn anticlockwise about the centre")


class Polygon(_Shape):
    """A simple polygon."""

    shape: Literal["polygon"]
    vertices: Points = Field(description="Corners in turn, m")


class FromFile(_Shape):
    """What another program has drawn: a mesh (.msh, …), a gmsh script (.geo), a drawing (.dxf)."""

    shape: Literal["file"]
    path: FileName = Field(description="Beside the scene file, or a full path")
    part: FileName | None = Field(
        default=None, description="Physical surface (gmsh) or layer (DXF); all by default"
    )
    scale: Positive | None = Field(
        default=None, description="Metres a unit of the file: 1, or what a DXF file says"
    )


Shape = Annotated[Disc | Rectangle | Polygon | FromFile, Field(discriminator="shape")]


def _begins(shapes: list[Any]) -> list[Any]:
    if not shapes:
        raise ValueError("a region needs a shape")
    if shapes[0].operation != "add":
        raise ValueError(f"the first shape has nothing to {shapes[0].operation} from")
    return shapes


def _one(shape: Any) -> list[Any]:
    return _begins([shape])


#: One shape, or several that are added, subtracted and intersected one after the other.
Region = Annotated[
    Annotated[Shape, AfterValidator(_one), Tag("one")]
    | Annotated[list[Shape], AfterValidator(_begins), Tag("several")],
    Discriminator(lambda given: "several" if isinstance(given, list) else "one"),
]


class Discretisation(Table):
    """Lattice, bonds and their moduli."""

    spacing: Positive = Field(description="Grid spacing, m")
    m: Positive = Field(default=5.0, description="Horizon in cells, at least 1")
    calibration: Literal["continuum", "lattice", "positive"] = "lattice"
    area_rule: Literal["full", "partial", "exact"] = "partial"
    influence: Literal["constant", "conical", "gaussian"] = "constant"
    surface: Literal["none", "volume", "extrapolated"] = "volume"
    law: Literal["cosine", "two-harmonic", "fourfold", "uniform-shear"] | None = Field(
        default=None, description="How bond moduli depend on direction"
    )
    exponent: Count | None = Field(default=None, description='Of law = "cosine"')

    @model_validator(mode="after")
    def _exponent(self) -> Discretisation:
        if self.exponent is not None and self.law != "cosine":
            raise wrong("exponent", 'an exponent belongs to law = "cosine"')
        return self


# ---- the material -----------------------------------------------------------------------


class _Massive(Table):
    density: Positive | None = Field(default=None, description="Mass per volume, kg/m³")
    bending: Matrix2 | None = Field(
        default=None,
        description="Of a polar solid: [[E3131, E3132], [E3132, E3232]], N, before it is turned",
        examples=[[[1.0, 0.0], [0.0, 1.0]]],
    )
    turn: Triple | None = Field(
        default=None,
        description="Of a chiral solid: rotations of its points per ε11, ε22 and 2 ε12, before it "
        "is turned",
    )


class _Turned(_Massive):
    angle_degrees: Number = Field(default=0.0, description="Turn anticlockwise")


T = TypeVar("T", bound=Table)


def _either(table: T, first: str, second: str) -> T:
    """Refuse a table that has both of two keys, or neither."""
    if (getattr(table, first) is None) == (getattr(table, second) is None):
        raise wrong(first, f"needs either {first} or {second}")
    return table


class Conductivity(Table):
    """A conductor by its tensor or its principal conductivities."""

    kind: Literal["conductivity"]
    tensor: Matrix2 | None = Field(default=None, description="Conductivity, W/(m K)")
    principal: Point | None = Field(
        default=None, description="Along x and y before it is turned, W/(m K)"
    )
    heat_capacity: Positive | None = Field(default=None, description="ρ c, J/(m³ K)")
    angle_degrees: Number = Field(default=0.0, description="Turn anticlockwise")

    @model_validator(mode="after")
    def _one(self) -> Conductivity:
        return _either(self, "tensor", "principal")


class Electric(Table):
    """An electrical conductor by its tensor or its principal resistivities."""

    kind: Literal["electric"]
    tensor: Matrix2 | None = Field(default=None, description="Conductivity, S/m")
    resistivities: Point | None = Field(
        default=None, description="Along x and y before it is turned, Ω m"
    )
    angle_degrees: Number = Field(default=0.0, description="Turn anticlockwise")

    @model_validator(mode="after")
    def _one(self) -> Electric:
        return _either(self, "tensor", "resistivities")


class Elastic(_Turned):
    """An elastic solid by its plane stiffness or compliance."""

    kind: Literal["elastic"]
    voigt: Matrix3 | None = Field(
        default=None, description="[[C11, C12, C16], [C12, C22, C26], [C16, C26, C66]], Pa"
    )
    compliance: Matrix3 | None = Field(
        default=None, description="[[S11, S12, S16], …] for strains (ε11, ε22, 2 ε12), 1/Pa"
    )

    @model_validator(mode="after")
    def _one(self) -> Elastic:
        return _either(self, "voigt", "compliance")


class Isotropic(_Massive):
    """An isotropic elastic solid."""

    kind: Literal["isotropic"]
    E: Positive = Field(description="Young's modulus, Pa")
    nu: Number = Field(description="Poisson's ratio")
    plane: Literal["stress", "strain"] = "stress"


class Orthotropic(_Turned):
    """An orthotropic elastic solid with its axes along x and y before it is turned."""

    kind: Literal["orthotropic"]
    E1: Positive = Field(description="Young's modulus along axis 1, Pa")
    E2: Positive = Field(description="Young's modulus along axis 2, Pa")
    G12: Positive = Field(description="Shear modulus, Pa")
    nu12: Number = Field(description="Contraction along 2 over extension along 1")
    plane: Literal["stress", "strain"] = "stress"
    E3: Positive | None = Field(default=None, description="Pa, plane strain only")
    nu13: Number | None = Field(default=None, description="Plane strain only")
    nu23: Number | None = Field(default=None, description="Plane strain only")

    @model_validator(mode="after")
    def _third_axis(self) -> Orthotropic:
        for key in ("E3", "nu13", "nu23"):
            given = getattr(self, key) is not None
            if given and self.plane == "stress":
                raise wrong(key, f'{key} has no meaning in plane = "stress"')
            if not given and self.plane == "strain":
                raise wrong(
                    "plane", f"the key {key!r} is missing: plane strain needs E3, nu13 and nu23"
                )
        return self


Material = Annotated[
    Conductivity | Electric | Elastic | Isotropic | Orthotropic, Field(discriminator="kind")
]


class Inclusion(Table):
    """A part of the body that is of another solid, or of another thickness."""

    region: Region
    material: Material | None = Field(default=None, description="That of the body by default")
    thickness: Positive | None = Field(default=None, description="m")
    expansion: Matrix2 | None = Field(
        default=None, description="Under temperatures, 1/K; in plane strain the effective one"
    )

    @model_validator(mode="after")
    def _differs(self) -> Inclusion:
        if self.material is None and self.thickness is None:
            raise wrong("", "says nothing of its part of the body: give material or thickness")
        return self


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
        if self.kind == "particles":
            if (self.layer_cells is None) == (self.where is None):
                raise wrong("where", "needs either layer_cells or where")
        elif self.layer_cells is not None:
            raise wrong("layer_cells", f"layer_cells says nothing of kind = {self.kind!r}")
        elif self.where is None and self.kind != "edge":
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
    where: Condition


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
    line: list[Line] = []

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
    support: list[Support] = []
    load: list[Load] = []
    inclusion: list[Inclusion] = []
    crack: list[Crack] = []
    solve: Solve = Solve()
    fracture: Fracture | None = None
    output: Output = Output()
    compare: Literal["fem"] | None = Field(
        default=None, description="Finite elements solve the same scene; see --compare"
    )
