"""Fracture of a body that a voltmeter watches, as scene files ask for it (Sect. 4.3.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, radians
from typing import Any

from .. import recovery
from ..analyses.recording import Progress
from ..analyses.registry import Analysis
from ..arrays import Array
from ..errors import SceneError
from ..geometry import Where
from ..material import ElectricConductivityTensor
from ..material.physics import ELASTICITY
from ..problem import Load, Support
from ..result import Table
from ..scene import Scene
from .analysis import run as break_bonds
from .grown import Grown
from .programme import Control
from .sensing import Sensor

#: The history's column of what the sensor reads.
DROP = "drop"


@dataclass(frozen=True, eq=False)
class Sensed(Grown):
    """A run in which cracks grew, and what the sensor read.

    Attributes
    ----------
    growth : Growth
        Its history has the drop, V for 1 A per m of thickness (1 A with a thickness), in a column
        of its own.
    sensor : Sensor
    """

    sensor: Sensor

    @property
    def drop(self) -> Array:
        """The drop at every equilibrium, shape (k,), V."""
        history = self.growth.history
        return history.array[:, history.names.index(DROP)]

    def fields(self) -> dict[str, Array]:
        """Those of the mechanics, and potential and current density as they were read last."""
        current = self.sensor.solution(self.growth)
        return {
            **self.growth.fields(),
            "potential": current.potential,
            "current_density": recovery.current_density(current),
        }

    def tables(self) -> dict[str, Table]:
        """The history, with the drop, and the path of the furthest crack."""
        return self.growth.tables()

    def summary(self) -> dict[str, Any]:
        """What became of the body, the first drop and the last over it."""
        first, last = float(self.drop[0]), float(self.drop[-1])
        return {**self.growth.summary(), "first drop": first, "relative drop": last / first}


def run(
    scene: Scene,
    resistivities: tuple[float, float],
    lead_plus: Where,
    lead_minus: Where,
    probe_plus: Where,
    probe_minus: Where,
    G1: float,
    G2: float | None = None,
    n: int = 2,
    axis_degrees: float = 0.0,
    angle_degrees: float = 0.0,
    start: float = 0.0,
    stop: float = inf,
    increment: float | None = None,
    levels: Sequence[float] | None = None,
    control: Control = "fixed",
    no_fail: Where | None = None,
    batch: int | None = None,
    advance: float | None = None,
    max_solves: int | None = None,
    tolerance: float = 1e-8,
    checkpoint: str | None = None,
    progress: Progress | None = None,
) -> Sensed:
    """Let a scene's cracks grow and read the potential drop at every equilibrium.

    Parameters
    ----------
    scene : Scene
        Elastic.
    resistivities : pair of float
        Principal ones, Ω m.
    lead_plus, lead_minus : Region or callable
        Where 1 A per m of thickness (1 A with a thickness) enters evenly, and where it leaves at
        0 V.
    probe_plus, probe_minus : Region or callable
        Each reads the mean potential of its particles.
    angle_degrees : float
        Turn of the resistivities' axes, anticlockwise.
    G1, G2, n, axis_degrees, start, stop, increment, levels, control, no_fail, batch, advance, \
max_solves, tolerance, checkpoint, progress
        As of `solver.fracture.analysis.run`.

    Raises
    ------
    SceneError
        If the scene is not elastic or has inclusions, the run has no end, or a lead or a probe
        holds no particle.
    """
    if scene.physics is not ELASTICITY:
        kind = scene.physics.adjective
        raise SceneError(f"cracks grow in an elastic body, and this is {kind} one")
    ends = (levels, advance, max_solves)
    if stop == inf and all(end is None for end in ends):
        raise SceneError("the run has no end: give stop, levels, advance or max_solves")
    conductor = replace(
        scene,
        material=ElectricConductivityTensor.of_resistivities(
            *resistivities, radians(angle_degrees)
        ),
        supports=[Support.lead(lead_minus, potential=0.0)],
        loads=[Load.lead(1.0, lead_plus)],
        law=None,
        density=None,
        tip="drawn",  # the mechanics say what they make of tips
    )
    sensor = Sensor(conductor, probe_plus, probe_minus)
    growth = break_bonds(
        scene,
        G1,
        G2,
        n,
        axis_degrees=axis_degrees,
        start=start,
        stop=stop,
        increment=increment,
        levels=levels,
        control=control,
        no_fail=no_fail,
        batch=batch,
        advance=advance,
        max_solves=max_solves,
        tolerance=tolerance,
        checkpoint=checkpoint,
        monitors={DROP: sensor},
        progress=progress,
    )
    return Sensed(growth, sensor)


ANALYSIS = Analysis(
    "sensing", "Cracks that grow, and the potential drop that tells of them.", run, stressed=True
)
