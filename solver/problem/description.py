"""What is asked, checked; knows no array and no analysis.

`solver.Scene` is a description that can discretise and solve itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from numbers import Real
from typing import Any, Literal, Self

from ..arrays import Mask
from ..bonds import Bonds, Factors, Surface, check_surface
from ..errors import SceneError
from ..geometry import Crack, Lattice, Region
from ..magnitude import MODULI, require_positive
from ..material import (
    CONSTANT,
    AngularLaw,
    AreaRule,
    Calibration,
    Family,
    Influence,
    Material,
    Moduli,
)
from ..material.influence import influence
from ..material.physics import Physics
from . import thickness
from .inclusions import Inclusion, check
from .loads import Load
from .supports import Support
from .tips import Tip, check_tip


@dataclass(frozen=True)
class Description:
    """A body, its material, what holds it and what acts on it.

    Parameters
    ----------
    region : Region
    spacing : float
        Grid spacing Δx, m.
    material : ElasticTensor, ConductivityTensor or ElectricConductivityTensor
        Decides the physics.
    supports : sequence of Support
        Later ones win where they overlap.
    loads : sequence of Load
        They add up.
    m : float
        Horizon in cells.
    calibration : {"continuum", "lattice", "positive"}
    law : angular law, optional
        See `solver.material.calibration.calibrate` for the default.
    influence : str or Influence
    area_rule : {"partial", "full", "exact"}
    surface : {"volume", "none", "extrapolated"}
    cracks : sequence of Crack
        Bonds that cross one are cut, and its faces are surfaces. A part that cracks leave on a
        single bond is not looked for; broken bonds (`broken`) are searched for such hinges.
    broken : callable, optional
        ``broken(lattice, family)`` → booleans of shape (family size / 2, N): bonds, by half
        offset and particle of origin, that carry nothing (damage).
    phase : pair of float, optional
        Where the cells of the lattice begin, at (k + phase) Δx; chosen from the body by default,
        see `solver.geometry.lattice`.
    loose : {"refuse", "drop"}
        What to do with parts and particles that nothing holds: refuse the scene, or set them
        aside (their fields are NaN, the rest is solved). A load on such a part is refused.
    density : float, optional
        ρ, kg/m³: statics needs none, whatever moves in time does.
    heat_capacity : float, optional
        Volumetric heat capacity, density times specific heat, J/(m³ K), of a transient.
    factors : callable, optional
        ``factors(bonds, moduli)`` → `solver.bonds.Factors` on the moduli of single bonds, such as
        those of a strained conductor (`solver.strained`).
    inclusions : sequence of Inclusion
        Parts of the body that are of other solids, bonded to the rest. Bonds end at the
        interfaces, whose nodes both sides share, with every treatment of surfaces.
    tip : {"drawn", "calibrated"}
        Whether the stiffness around tips of cracks is calibrated to their singular fields
        (`solver.tips`): of statics of elastic bodies with ``extrapolated`` surfaces, whose cracks
        do not grow. A tip too near to something else stays as drawn, with a warning.
    thickness : number or function of (x, y), optional
        m; see `solver.problem.thickness`. Without it, and without any of an inclusion, everything
        is per unit thickness; with it forces, energies and currents are those of the body.

    Raises
    ------
    SceneError
        If the description contradicts itself.
    """

    region: Region
    spacing: float
    material: Material
    supports: Sequence[Support] = ()
    loads: Sequence[Load] = ()
    m: float = 5
    calibration: Calibration = "lattice"
    law: AngularLaw | None = None
    influence: str | Influence = field(default=CONSTANT)
    area_rule: AreaRule = "partial"
    surface: Surface = "volume"
    cracks: Sequence[Crack] = ()
    broken: Callable[[Lattice, Family], Mask] | None = None
    loose: Literal["refuse", "drop"] = "refuse"
    phase: tuple[float, float] | None = None
    density: float | None = None
    heat_capacity: float | None = None
    factors: Callable[[Bonds, Moduli], Factors] | None = None
    inclusions: Sequence[Inclusion] = ()
    thickness: float | Callable[..., Any] | None = None
    tip: Tip = "drawn"

    def __post_init__(self) -> None:
        check_surface(self.surface)
        if self.loose not in ("refuse", "drop"):
            raise SceneError(f"loose must be 'refuse' or 'drop', not {self.loose!r}")
        if not isinstance(self.region, Region):
            raise SceneError(f"region must be a Region, not {type(self.region).__name__}")
        if not isinstance(self.material, Material):
            raise SceneError(
                f"material must be an ElasticTensor, a ConductivityTensor or an "
                f"ElectricConductivityTensor, not {type(self.material).__name__}"
            )
        listed: dict[str, type] = {
            "supports": Support,
            "loads": Load,
            "cracks": Crack,
            "inclusions": Inclusion,
        }
        for name, kind in listed.items():
            items = getattr(self, name)
            if not isinstance(items, Sequence) or not all(isinstance(i, kind) for i in items):
                raise SceneError(f"{name} must be a list of {kind.__name__} objects")
        for name in ("spacing", "m"):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, Real):
                raise SceneError(f"{name} must be a number, not {value!r}")
        for name, unit in (("density", "kg/m³"), ("heat_capacity", "J/(m³ K)")):
            given = getattr(self, name)
            if given is None:
                continue
            what = name.replace("_", " ")
            require_positive(given, f"the {what}", unit, MODULI)
            if name != self.physics.storage:
                raise SceneError(f"{self.physics.adjective} body has no {what}")
        for load in self.loads:
            if load.kind not in self.physics.loads:
                raise SceneError(f"a {load.kind} does not act on {self.physics.adjective} body")
        check(self)
        thickness.check(self)
        check_tip(self)

    @property
    def physics(self) -> Physics:
        """What the scene is about, as its material says."""
        return self.material.physics

    @property
    def timed(self) -> bool:
        """Whether a support or a load depends on time."""
        supports, loads = (s.timed for s in self.supports), (load.timed for load in self.loads)
        return any(supports) or any(loads)

    def at(self, time: float) -> Self:
        """The scene with its supports and loads as they are at one time, s."""
        if not self.timed:
            return self
        return replace(
            self,
            supports=[support.at(time) for support in self.supports],
            loads=[load.at(time) for load in self.loads],
        )

    def density_for(self, what: str) -> float:
        """ρ, kg/m³, for an analysis that needs it.

        Raises
        ------
        SceneError
            If the scene has none.
        """
        if self.density is None:
            raise SceneError(f"{what} need the mass of the body: give the scene a density, kg/m³")
        return float(self.density)

    def family(self) -> Family:
        """The family of a bulk particle."""
        return Family(self.m, self.spacing, self.area_rule, influence(self.influence))
