"""What a scene file says of the body: its shape, its lattice, and the solids it consists of."""

from __future__ import annotations

from typing import Annotated, Any, Literal, TypeVar

from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator

from cmverify.exchange.table import Table, wrong
from cmverify.exchange.values import (
    Count,
    FileName,
    Matrix2,
    Matrix3,
    Number,
    Point,
    Points,
    Positive,
    Triple,
)

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
    tip: Literal["drawn", "calibrated"] = Field(
        default="drawn",
        description="Whether the stiffness around tips of cracks is calibrated to their fields "
        "(statics, surface = extrapolated)",
    )
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
