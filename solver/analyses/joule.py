"""Joule's heat and what it strains: current, then heat, then elasticity, on one body.

A current between two electrodes heats the body, bond by bond (`solver.recovery.dissipation`); the
heat leaves through sinks of given temperature; what is warmer expands. Nothing comes back: neither
temperature nor strain changes what conducts. All that is fed in becomes heat, and all heat leaves:

    Σ I V  =  Σ k g² α Δv²  =  − what the sinks supply,

each to the solver's tolerance, with any treatment of surfaces.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from scipy.spatial import KDTree

from .. import recovery
from ..arrays import Array, Mask
from ..bonds import Cells
from ..errors import SceneError
from ..geometry import Lattice, Phases, Where
from ..material import ElectricConductivityTensor, ExpansionTensor
from ..material.physics import ELASTICITY
from ..problem import Description, Discretisation, Load, Support
from ..reactions import supply
from ..result import Result
from ..solution import Solution
from ..state import State
from . import solids
from .registry import Analysis
from .statics import solve

D = TypeVar("D", bound=Description)


def heated(conductor: D, current: Solution) -> D:
    """The scene of heat conduction with the heat that a current makes as a source."""
    heat = recovery.dissipation(current)
    # Sources are multiplied by a thickness; what bonds make has it already.
    thick = current.discretisation.thickness
    heat = heat if thick is None else heat / thick

    def density(
        lattice: Lattice, true_edges: bool, phases: Phases | None = None
    ) -> tuple[Mask, Array]:
        if lattice.count != len(heat):
            raise SceneError("current and heat share one lattice: their particles differ")
        return np.ones(len(heat), dtype=bool), heat[:, None]

    return replace(conductor, loads=[*conductor.loads, Load("source", density)])


def expanded(body: D, heat: Solution, expansion: ExpansionTensor) -> D:
    """The elastic scene under the temperatures of a solution, at the surface's nodes too."""
    points = np.concatenate([heat.discretisation.lattice.places, heat.surface_points])
    known = np.concatenate([heat.temperature, heat.surface_temperature])
    tree = KDTree(points)

    def at_surface(x: Array, y: Array) -> Array:
        return np.asarray(known[tree.query(np.column_stack([x, y]))[1]])

    load = Load.temperature(heat.temperature, expansion, at_surface)
    return replace(body, loads=[*body.loads, load])


@dataclass(frozen=True, eq=False)
class Chain(Result):
    """A body that a current heats and the heat strains.

    Attributes
    ----------
    current, heat, mechanics : Solution
    supplied, made, removed : float
        What the electrodes supply, what the bonds make of it, and what the sinks take, W/m (W with
        a thickness).
    """

    current: Solution
    heat: Solution
    mechanics: Solution
    supplied: float
    made: float
    removed: float

    @property
    def points(self) -> Array:
        """Particle centres, shape (N, 2), m."""
        return self.mechanics.points

    @property
    def cells(self) -> Cells:
        """The particles' cells, parted where bonds carry nothing."""
        return self.mechanics.cells

    @property
    def imbalance(self) -> float:
        """Largest difference of the three powers, over what is supplied."""
        powers = (self.supplied, self.made, self.removed)
        return (max(powers) - min(powers)) / abs(self.supplied)

    @property
    def stressed(self) -> State | None:
        """The body as the heat strains it."""
        return self.mechanics

    def fields(self) -> dict[str, Array]:
        """Fields of all three, and the heat that is made."""
        return {
            **self.mechanics.fields(),
            "temperature": self.heat.temperature,
            "potential": self.current.potential,
            "current_density": recovery.current_density(self.current),
            "joule_heat": recovery.joule_heat(self.current),
        }

    def summary(self) -> dict[str, Any]:
        """The powers, and how the three fields were obtained."""
        solutions = (self.current, self.heat, self.mechanics)
        return {
            "supplied": self.supplied,
            "made": self.made,
            "removed": self.removed,
            "imbalance": self.imbalance,
            "hottest": float(np.nanmax(self.heat.temperature)),
            "iterations": sum(s.statistics.iterations for s in solutions),
            "warnings": tuple(dict.fromkeys(w for s in solutions for w in s.statistics.warnings)),
        }


def run(
    scene: Description,
    plus: Where,
    minus: Where,
    sink: Where,
    voltage: float,
    resistivities: tuple[float, float],
    conductivities: tuple[float, float],
    expansions: tuple[float, float],
    angle_degrees: float = 0.0,
    tolerance: float = 1e-10,
) -> Chain:
    """Heat an elastic body by a current between two electrodes, and let it expand.

    Parameters
    ----------
    scene : Scene
        Elastic; its supports hold it while it expands.
    plus, minus : Region or callable
        The electrodes, at `voltage` and 0 V.
    sink : Region or callable
        Where heat leaves: particles whose temperature stays at 0, from which changes count.
    voltage : float, V
    resistivities, conductivities, expansions : pair of float
        Principal ones along common axes: Ω m, W/(m K), 1/K (in plane strain the effective ones).
    angle_degrees : float
        Turn of these axes, anticlockwise.
    tolerance : float
        Relative residual of every solve.

    Raises
    ------
    SceneError
        If the scene is not elastic or has inclusions, the voltage is zero, a conductivity is not
        positive, or an electrode or the sink holds no particle.
    """
    if scene.physics is not ELASTICITY:
        raise SceneError(f"heat strains an elastic body, and this is {scene.physics.adjective} one")
    if scene.inclusions:
        raise SceneError("Joule's heat and what it strains know one solid: the body has inclusions")
    if not (np.isfinite(voltage) and voltage != 0):
        raise SceneError(f"without a voltage no current heats the body: {voltage} V")
    if scene.tip == "calibrated":
        raise SceneError(
            "tips of cracks are calibrated (tip='calibrated') in bodies that no temperature strains"
        )
    angle = math.radians(angle_degrees)
    bare = replace(scene, loads=(), law=None, density=None)
    electric = replace(
        bare,
        material=ElectricConductivityTensor.of_resistivities(*resistivities, angle),
        supports=[Support.lead(plus, potential=voltage), Support.lead(minus, potential=0.0)],
    )
    conductor, expansion = solids.heated(conductivities, expansions, angle_degrees)
    thermal = replace(
        bare,
        material=conductor,
        supports=[Support.where(sink, temperature=0.0)],
    )
    current = solve(Discretisation.of(electric, constrained=True), tolerance)
    heat = solve(Discretisation.of(heated(thermal, current), constrained=True), tolerance)
    warm = expanded(scene, heat, expansion)
    mechanics = solve(Discretisation.of(warm, constrained=True), tolerance)
    area = current.discretisation.family.cell_area
    made = float(recovery.dissipation(current).sum()) * area
    # What is made where the temperature is held leaves at once, and counts.
    supplied, removed = voltage * supply(current, plus), -supply(heat, sink)
    return Chain(current, heat, mechanics, supplied, made, removed)


ANALYSIS = Analysis(
    "joule", "A body that a current heats and the heat strains.", run, stressed=True
)
