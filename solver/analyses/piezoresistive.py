"""A strained body as a resistor between two electrodes: the scene's statics, then conduction.

The elastic scene is solved as it is; on the same lattice a conductor with two electrodes, regions
of given potentials, is solved twice: unstrained, and with the bonds as they are stretched.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

from .. import recovery
from ..arrays import Array
from ..bonds import Cells
from ..errors import SceneError
from ..geometry import Where
from ..material import ElectricConductivityTensor, Piezoresistance
from ..material.physics import ELASTICITY
from ..material.piezoresistance import Law, Length, Moments
from ..problem import Description, Discretisation, Support
from ..reactions import supply
from ..result import Result
from ..solution import Solution
from ..state import State
from ..strained import strained
from .registry import Analysis
from .statics import solve


@dataclass(frozen=True, eq=False)
class Resistor(Result):
    """What the strain of a body does to its resistance.

    Attributes
    ----------
    mechanics, unstrained, strained : Solution
        Of the elastic scene, and of the conductor before and after.
    resistances : pair of float
        Between the electrodes, before and after, Ω m (Ω with a thickness).
    """

    mechanics: Solution
    unstrained: Solution
    strained: Solution
    resistances: tuple[float, float]

    @property
    def points(self) -> Array:
        """Particle centres, shape (N, 2), m."""
        return self.mechanics.points

    @property
    def change(self) -> float:
        """ΔR/R."""
        before, after = self.resistances
        return after / before - 1.0

    @property
    def cells(self) -> Cells:
        """The particles' cells, parted where bonds carry nothing."""
        return self.mechanics.cells

    @property
    def stressed(self) -> State | None:
        """The strained body."""
        return self.mechanics

    def fields(self) -> dict[str, Array]:
        """The mechanical fields, and potential and current density of the strained conductor."""
        return {
            **self.mechanics.fields(),
            "potential": self.strained.potential,
            "unstrained_potential": self.unstrained.potential,
            "current_density": recovery.current_density(self.strained),
        }

    def summary(self) -> dict[str, Any]:
        """Resistances, and how the three fields were obtained."""
        solutions = (self.mechanics, self.unstrained, self.strained)
        return {
            "resistance": self.resistances[1],
            "unstrained resistance": self.resistances[0],
            "relative change": self.change,
            "iterations": sum(s.statistics.iterations for s in solutions),
            "warnings": tuple(dict.fromkeys(w for s in solutions for w in s.statistics.warnings)),
        }


def run(
    scene: Description,
    gauge: float,
    plus: Where,
    minus: Where,
    resistivities: tuple[float, float],
    angle_degrees: float = 0.0,
    law: Law = "conductivity",
    length: Length = "reference",
    moments: Moments = "continuum",
    tolerance: float = 1e-10,
) -> Resistor:
    """Resistance between two electrodes of an elastic body, unstrained and as its loads strain it.

    Parameters
    ----------
    scene : Scene
        Elastic.
    gauge, law, length, moments
        See `solver.Piezoresistance`.
    plus, minus : Region or callable
        The electrodes, at 1 V and 0 V.
    resistivities : pair of float
        Principal ones, Ω m, before they are turned.
    angle_degrees : float
        Turn of the conductor's axes, anticlockwise.
    tolerance : float
        Relative residual of every solve.

    Raises
    ------
    SceneError
        If the scene is not elastic, has inclusions or a thickness that is a function, an electrode
        holds no particle, or the strain is too large.

    Examples
    --------
    >>> from solver import ElasticTensor, Scene, Support, rectangle
    >>> import numpy as np
    >>> def stretched(x, y):
    ...     return np.stack([1e-3 * x, 0 * y], axis=-1)
    >>> held = Support.layer(2.5, displacement=stretched, rotation=0.0)
    >>> body = Scene(rectangle(2, 1), 0.1, ElasticTensor.isotropic(1.0, 0.2), [held], m=2)
    >>> found = run(body, 4.0, lambda x, y: x > 0.8, lambda x, y: x < -0.8, (1.0, 1.0))
    >>> f"{found.change:.4f}"  # 0.75 × 4 × 1e-3 in uniaxial strain
    '-0.0030'
    """
    if scene.physics is not ELASTICITY:
        raise SceneError(
            f"strain makes a piezoresistance, and {scene.physics.adjective} scene has none"
        )
    if scene.inclusions or callable(scene.thickness):
        raise SceneError(
            "a strained conductor is of one solid, its thickness a number: the bonds of this body "
            "have factors already"
        )
    piezoresistance = Piezoresistance(gauge, law, length, moments)
    material = ElectricConductivityTensor.of_resistivities(
        *resistivities, math.radians(angle_degrees)
    )
    electrodes = [Support.lead(plus, potential=1.0), Support.lead(minus, potential=0.0)]
    conductor = replace(
        scene,
        material=material,
        supports=electrodes,
        loads=(),
        law=None,
        density=None,
        # Of the mechanics: conduction knows tips as they are drawn.
        tip="drawn",
    )
    # What is wrong with the electrodes is said before anything long.
    bare = Discretisation.of(conductor, constrained=True)
    mechanics = solve(Discretisation.of(scene, constrained=True), tolerance)
    now = Discretisation.of(strained(conductor, mechanics, piezoresistance), constrained=True)
    before = solve(bare, tolerance)
    after = solve(now, tolerance, previous=before)
    resistances = tuple(1.0 / supply(solution, plus) for solution in (before, after))
    return Resistor(mechanics, before, after, (resistances[0], resistances[1]))


ANALYSIS = Analysis(
    "piezoresistive",
    "Resistance of a strained conductor between two electrodes.",
    run,
    stressed=True,
)
