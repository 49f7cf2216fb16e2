"""A body that is cooled or warmed from its surface until it cracks, as scene files ask for it.

Heat conduction through the body as it is drawn gives its temperatures at the times asked for, and
cracks grow under these (`solver.fracture.temperatures`). Grown cracks do not stop heat, which those
along its flow do not anyway, and what bonds set free does not warm.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isfinite, radians
from typing import Any

from ..analyses import solids, transient
from ..analyses.recording import Progress
from ..analyses.registry import Analysis
from ..analyses.transient import Transient
from ..arrays import Array
from ..errors import SceneError
from ..geometry import Where
from ..material.physics import ELASTICITY
from ..problem import Support
from ..result import Table
from ..scene import Scene
from .breaking import Criterion
from .grown import Grown
from .growth import Growth, require_whole_bonds
from .quasistatic import grow
from .temperatures import Temperatures
from .toughness import Toughness


@dataclass(frozen=True, eq=False)
class Quenched(Grown):
    """A run in which cracks grew under temperatures, and the conduction behind these.

    Attributes
    ----------
    growth : Growth
        Its history has the time, s, in a column of its own.
    heat : Transient
    """

    heat: Transient

    def fields(self) -> dict[str, Array]:
        """Those of the mechanics, the last temperatures among them."""
        return self.growth.fields()

    def tables(self) -> dict[str, Table]:
        """The history and the furthest crack's path, and heat over time."""
        return {**self.growth.tables(), **self.heat.tables()}

    def summary(self) -> dict[str, Any]:
        """What became of the body, and how the heat flowed."""
        heat = self.heat.statistics
        found = {**self.growth.summary(), "heat steps": heat.steps, "heat balance": heat.balance}
        return found | {"warnings": (*found["warnings"], *heat.warnings)}


def run(
    scene: Scene,
    cooled: Where,
    change: float,
    times: Sequence[float],
    conductivities: tuple[float, float],
    heat_capacity: float,
    expansions: tuple[float, float],
    G1: float,
    G2: float | None = None,
    n: int = 2,
    axis_degrees: float = 0.0,
    angle_degrees: float = 0.0,
    no_fail: Where | None = None,
    tension_only: bool = True,
    criterion: Criterion = "total",
    batch: int | None = None,
    max_solves: int | None = None,
    tolerance: float = 1e-8,
    checkpoint: str | None = None,
    progress: Progress | None = None,
) -> Quenched:
    """Change the temperature of a part of the surface at once and let cracks grow.

    Parameters
    ----------
    scene : Scene
        Elastic, with `surface` "volume" or "none"; its supports and loads act from the start.
    cooled : Region or callable
        The part of the surface whose temperature changes at time 0; the rest is insulated.
    change : float, K
        Negative for a quench. The body is free of strain before it.
    times : sequence of float, s
        At which bonds may break, ascending from above 0; the last one ends the run.
    conductivities : pair of float, W/(m K)
        Principal ones, along the axes that `angle_degrees` turns.
    expansions : pair of float, 1/K
        Principal ones along the same axes (in plane strain the effective ones).
    heat_capacity : float, J/(m³ K)
    angle_degrees : float
        Turn of these axes, anticlockwise.
    G1, G2, n, axis_degrees
        See `Toughness`; G1 and G2 in J/m².
    no_fail, tension_only, criterion, batch, max_solves, tolerance, checkpoint
        See `grow`.
    progress : callable, optional
        Told the share of the times that is done.

    Raises
    ------
    SceneError, ToughnessError
        If the scene is not elastic, has inclusions or temperatures of its own, bonds end at its
        surface, or the numbers make no run.
    """
    if scene.physics is not ELASTICITY:
        raise SceneError(
            f"cracks grow in an elastic body, and this is {scene.physics.adjective} one"
        )
    if scene.inclusions:
        raise SceneError("a quench knows one solid: the body has inclusions")
    require_whole_bonds(scene)
    if not (isfinite(change) and change != 0):
        raise SceneError(f"a quench changes the temperature of the surface, not by {change} K")
    if not all(t > 0 for t in times):
        raise SceneError("the surface changes its temperature at time 0: times must be after it")
    solid, expansion = solids.heated(conductivities, expansions, angle_degrees)
    conductor = replace(
        scene,
        material=solid,
        supports=[Support.edge(cooled, temperature=change)],
        loads=(),
        law=None,
        density=None,
        heat_capacity=heat_capacity,
        # The temperature is that of the true edge.
        surface="extrapolated",
        tip="drawn",
    )
    heat = transient.run(conductor, 0.0, times)
    fields = Temperatures.of(heat, expansion)

    def listen(growth: Growth) -> None:
        if progress is not None:
            progress(float(growth.history["time"][-1] / fields.times[-1]))

    growth = grow(
        scene,
        Toughness(G1, G2, n, axis=radians(axis_degrees)),
        no_fail=() if no_fail is None else (no_fail,),
        tension_only=tension_only,
        criterion=criterion,
        batch=batch,
        tolerance=tolerance,
        max_solves=max_solves,
        checkpoint=checkpoint,
        listen=listen,
        temperatures=fields,
    )
    return Quenched(growth, heat)


ANALYSIS = Analysis(
    "quench",
    "Cracks that grow while a body is cooled or warmed from its surface.",
    run,
    stressed=True,
)
