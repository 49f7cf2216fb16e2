"""Inclusions: parts of a body that are of another solid than the rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from ..arrays import Array
from ..errors import SceneError
from ..geometry import Lattice, Phases, Region
from ..geometry.phases import moved
from ..magnitude import MODULI, require_positive
from ..material import (
    AngularLaw,
    Calibration,
    ExpansionTensor,
    Family,
    Material,
    Mixture,
    Moduli,
    Stability,
    calibrated,
    require_admissible,
    together,
)
from ..material.physics import Physics
from . import thickness
from .thickness import Composite


@dataclass(frozen=True)
class Inclusion:
    """Another solid in a part of the body, firmly bonded to what is around it.

    Parameters
    ----------
    region : Region
        What of it lies in the body. Later inclusions win where they overlap.
    material : ElasticTensor, ConductivityTensor or ElectricConductivityTensor
        Of the scene's physics.
    density : float, optional
        ρ, kg/m³; that of the scene by default.
    heat_capacity : float, optional
        J/(m³ K); that of the scene by default.
    thickness : float, optional
        m; that of the scene by default. A groove is an inclusion of the same material.
    expansion : ExpansionTensor, optional
        What it expands by under the scene's temperatures, which then it needs.
    """

    region: Region
    material: Material
    density: float | None = None
    heat_capacity: float | None = None
    thickness: float | None = None
    expansion: ExpansionTensor | None = None

    def __post_init__(self) -> None:
        if not (self.expansion is None or isinstance(self.expansion, ExpansionTensor)):
            raise SceneError(
                f"the expansion of an inclusion must be an ExpansionTensor, not "
                f"{type(self.expansion).__name__}"
            )
        if not isinstance(self.region, Region):
            raise SceneError(
                f"the region of an inclusion must be a Region, not {type(self.region).__name__}"
            )
        if not isinstance(self.material, Material):
            raise SceneError(
                f"an inclusion needs a material, not {type(self.material).__name__}: a hole is "
                f"what is subtracted from the region"
            )
        for name, unit in (("density", "kg/m³"), ("heat_capacity", "J/(m³ K)")):
            given = getattr(self, name)
            if given is not None:
                what = f"the {name.replace('_', ' ')} of an inclusion"
                require_positive(given, what, unit, MODULI)


class _Scene(Composite, Protocol):
    """What else of a scene is asked."""

    @property
    def material(self) -> Material: ...
    @property
    def physics(self) -> Physics: ...
    @property
    def calibration(self) -> Calibration: ...
    @property
    def law(self) -> AngularLaw | None: ...
    @property
    def loads(self) -> Sequence[Any]: ...
    @property
    def broken(self) -> Any: ...


def check(scene: _Scene) -> None:
    """Refuse inclusions that do not fit their scene.

    Raises
    ------
    SceneError
    """
    physics = scene.physics
    for inclusion in scene.inclusions:
        if inclusion.material.physics is not physics:
            raise SceneError(
                f"{physics.adjective} body has no inclusion of "
                f"{type(inclusion.material).__name__}: its solids share one physics"
            )
        for name in ("density", "heat_capacity"):
            if getattr(inclusion, name) is not None and getattr(scene, name) is None:
                raise SceneError(
                    f"an inclusion has a {name.replace('_', ' ')}, and the scene has none"
                )
    if scene.inclusions and scene.broken is not None:
        raise SceneError(
            "single bonds cannot be broken in a body with inclusions: bonds that end at an "
            "interface have no strength"
        )
    if scene.inclusions and scene.factors is not None:
        raise SceneError("factors on single bonds are not known in a body with inclusions")
    if any(load.strain is not None for load in scene.loads) and any(
        inclusion.expansion is None for inclusion in scene.inclusions
    ):
        raise SceneError(
            "a temperature strains every solid of a body: an inclusion needs its expansion "
            "(Inclusion(..., expansion=ExpansionTensor))"
        )


def phases_of(scene: _Scene, lattice: Lattice) -> Phases | None:
    """The phases of a scene's body, None if it is of one."""
    if not scene.inclusions:
        return None
    near = lattice.centred
    x, y = near.shift
    regions = [inclusion.region for inclusion in scene.inclusions]
    return Phases(near, moved(regions, (-x, -y), near.grid))


def solids(scene: _Scene, family: Family) -> tuple[tuple[Moduli, ...], Stability]:
    """Moduli of every solid, the scene's own first, and how stable they are together.

    Raises
    ------
    CalibrationError, InadmissibleMaterialError
    """
    materials = [scene.material, *(inclusion.material for inclusion in scene.inclusions)]
    known: dict[int, tuple[Moduli, Stability]] = {}
    for material in materials:
        if id(material) not in known:
            moduli = calibrated(family, material, scene.calibration, scene.law)
            known[id(material)] = moduli, require_admissible(family, moduli)
    found = [known[id(material)] for material in materials]
    thick = thickness.of_phases(scene)
    each = [
        moduli if t == 1.0 else moduli.scaled(np.full(family.size, t))
        for (moduli, _), t in zip(found, thick, strict=True)
    ]
    return tuple(each), together(tuple(s for _, s in found))


def mixed(each: Sequence[Moduli], phases: Phases | None) -> Moduli:
    """The moduli of a body."""
    return each[0] if phases is None else Mixture(tuple(each), phases.of)


def shares(scene: _Scene, name: str) -> Array:
    """Density, or heat capacity, of every phase relative to the scene's own, shape (phases,)."""
    own = getattr(scene, name)
    each = [getattr(inclusion, name) for inclusion in scene.inclusions]
    return np.array([1.0, *(1.0 if value is None else value / own for value in each)])
