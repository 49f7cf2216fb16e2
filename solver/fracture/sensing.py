"""Damage sensing (Sect. 4.3.2): the potential drop of a body whose bonds break.

One set of bonds, two physics: the electrical problem is that of an intact conductor on the same
lattice, less the bonds that the mechanics has broken. It is solved where the run records, and
nowhere else, as a monitor of `grow`:

    grow(scene, toughness, programme, monitors={"drop": Sensor(conductor, above, below)})
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..analyses.statics import solve
from ..arrays import Mask
from ..errors import MechanismError, SceneError
from ..geometry import Lattice, Where, select
from ..problem import Description, Discretisation
from ..solution import Solution

if TYPE_CHECKING:
    from .growth import Growth


@dataclass(frozen=True)
class Sensor:
    """A voltmeter on a body in which bonds break.

    Parameters
    ----------
    scene : Scene
        Of an electrical conductor with its leads, on the same lattice as the mechanical scene.
    plus, minus : Region or callable
        Places of the probes; each reads the mean potential of its particles.
    tolerance : float
        Relative residual of every solve.

    Raises
    ------
    SceneError
        If the scene does not conduct, or has broken bonds of its own.
    """

    scene: Description
    plus: Where
    minus: Where
    tolerance: float = 1e-9

    def __post_init__(self) -> None:
        if len(self.scene.physics.unknowns) != 1:
            raise SceneError(
                f"a sensor needs a conductor, not {self.scene.physics.adjective} scene"
            )
        if self.scene.broken is not None:
            raise SceneError("bonds of a sensor's scene break with the mechanics: leave them whole")

    def __call__(self, run: Growth) -> float:
        """Potential difference plus − minus for the bonds that `run` has broken, V.

        Infinite once no current can pass from lead to lead.
        """
        self._require_same_bonds(run)
        broken = run.broken
        try:
            solution = self.solve(broken)
        except MechanismError:
            if not broken.any():
                raise
            return float("inf")
        return self.read(solution)

    def _require_same_bonds(self, run: Growth) -> None:
        """Refuse a conductor that is not the body whose bonds break."""
        scene, family = self.scene, self.scene.family()
        lattice = Lattice(scene.region, scene.spacing, family.reach, scene.phase).centred
        other = run.bonds
        same = {
            "particles": np.array_equal(lattice.points, other.lattice.points),
            "families": np.array_equal(family.offsets, other.family.offsets)
            and np.array_equal(family.weight, other.family.weight),
            "surfaces": scene.surface == run.scene.surface,
            "cracks": [c.points for c in scene.cracks] == [c.points for c in run.scene.cracks],
        }
        if wrong := [name for name, equal in same.items() if not equal]:
            raise SceneError(
                f"sensor and mechanics share one set of bonds: their {', '.join(wrong)} differ"
            )

    def solve(self, broken: Mask) -> Solution:
        """The electrical solution with some bonds broken, shape (family size / 2, N)."""
        # Fragments without a lead carry no current: they are set aside.
        live = replace(self.scene, broken=lambda lattice, family: broken, loose="drop")
        return solve(Discretisation.of(live, constrained=True), self.tolerance)

    def read(self, solution: Solution) -> float:
        """Potential difference plus − minus of a solution, V.

        Raises
        ------
        SceneError
            If no particle is where a probe is.
        """
        lattice, values = solution.discretisation.lattice, solution.unknowns[0]
        found = []
        for where in (self.plus, self.minus):
            chosen = select(lattice, where)
            if not chosen.any():
                raise SceneError("no particle is where a probe is to read the potential")
            found.append(float(np.mean(values[chosen])))
        return found[0] - found[1]
