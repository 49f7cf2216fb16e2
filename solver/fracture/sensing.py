"""Damage sensing (Sect. 4.3.2): the potential drop of a body whose bonds break.

One set of bonds, two physics: the electrical problem is that of an intact conductor on the same
lattice, less the bonds that the mechanics has broken. It is solved where the run records, and
nowhere else, as a monitor of `grow`:

    grow(scene, toughness, programme, monitors={"drop": Sensor(conductor, above, below)})

Between two readings nothing is done, and from one to the next all is kept that the breaks leave as
it was: the bonds, the last potential as a first guess, the preconditioner (`Equilibrium`). Parts
without a lead are set aside; hinges need not be looked for, because a connected conductor has none.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike

from ..analyses.statics import solve
from ..arrays import Array, Indices, Mask
from ..errors import MechanismError, SceneError
from ..geometry import Crack, Lattice, Where, select
from ..problem import Description, Discretisation
from ..solution import Solution
from .broken import BrokenBonds
from .damaged_body import Equilibrium

if TYPE_CHECKING:
    from .growth import Growth

# Iterations of one reading.
_MOST = 20_000


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
    _live: WeakKeyDictionary[Growth, _Live] = field(
        default_factory=WeakKeyDictionary, init=False, repr=False, compare=False
    )

    def __post_init__(self) -> None:
        if len(self.scene.physics.unknowns) != 1:
            raise SceneError(
                f"a sensor needs a conductor, not {self.scene.physics.adjective} scene"
            )
        if self.scene.inclusions:
            raise SceneError(
                "a sensor's scene has no inclusions: what the mechanics breaks would leave bonds "
                "that end at their interfaces"
            )
        if self.scene.broken is not None:
            raise SceneError("bonds of a sensor's scene break with the mechanics: leave them whole")

    def __call__(self, run: Growth) -> float:
        """Potential difference plus − minus for the bonds that `run` has broken, V.

        To the sensor's tolerance: the last digits depend on what was read before. Infinite once
        no current can pass from lead to lead, NaN once a probe hangs on a part without a lead.
        """
        live = self._live.get(run)
        if live is None:
            self._require_same_bonds(run)
            live = self._live[run] = _Live(self, run)
        return live.read(run)

    def solution(self, run: Growth) -> Solution:
        """The potential as it was last read, before the conductor parted if it has.

        Raises
        ------
        SceneError
            If nothing has been read of this run.
        """
        live = self._live.get(run)
        if live is None:
            raise SceneError("the sensor has read nothing of this run")
        return live.body.solution(1.0)

    def _require_same_bonds(self, run: Growth) -> None:
        """Refuse a conductor that is not the body whose bonds break."""
        scene, family = self.scene, self.scene.family()
        lattice = Lattice(scene.region, scene.spacing, family.reach, scene.phase)
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

    def along(self, *ways: ArrayLike) -> float:
        """Potential difference with cracks drawn along some ways, V, and no bond broken.

        What a crack would read that is cut right through where one grew (`Growth.path`, or the
        points of every one of `Growth.paths`): no whole bond across it conducts, and its faces are
        treated as those of any drawn crack. Each reading starts from nothing, at some ten times the
        cost of following what has broken.

        Parameters
        ----------
        ways : array_like, shape (n, 2), m
            Those of fewer than two points are no cracks.
        """
        drawn = [np.asarray(way, dtype=np.float64) for way in ways]
        more = [Crack(*((float(x), float(y)) for x, y in way)) for way in drawn if len(way) > 1]
        scene = replace(self.scene, cracks=[*self.scene.cracks, *more])
        start = Discretisation.of(scene, sharp_tips=False, constrained=True)
        return self.read(solve(start, self.tolerance))

    def read(self, solution: Solution) -> float:
        """Potential difference plus − minus of a solution, V.

        Raises
        ------
        SceneError
            If no particle is where a probe is.
        """
        plus, minus = self.probes(solution.discretisation.lattice)
        return _difference(solution.unknowns[0], plus, minus)

    def probes(self, lattice: Lattice) -> tuple[Mask, Mask]:
        """Particles of the two probes, each (N,); as `read`."""
        plus, minus = select(lattice, self.plus), select(lattice, self.minus)
        if not (plus.any() and minus.any()):
            raise SceneError("no particle is where a probe is to read the potential")
        return plus, minus


class _Record:
    """The bonds that the load has broken, as `Equilibrium` follows them."""

    def __init__(self, run: Growth) -> None:
        self._bonds, self.broken = run.bonds, BrokenBonds()

    def catch_up(self) -> None:
        """Take over what has been broken since; what merely went with a part still conducts."""
        new = self._bonds.broken.by_load[len(self.broken) :]
        self.broken.add(new["bond"], new["step"], new["load_factor"], False)

    def ends(self, bonds: Indices) -> tuple[Indices, Indices, Indices]:
        """See `Breakable.ends`."""
        return self._bonds.ends(bonds)


class _Live:
    """The conductor of one run, as it was when it was read last."""

    def __init__(self, sensor: Sensor, run: Growth) -> None:
        start = Discretisation.of(sensor.scene, sharp_tips=False, constrained=True)
        self.record = _Record(run)
        self.body = Equilibrium(start, self.record, sensor.tolerance, _MOST)
        self.plus, self.minus = sensor.probes(start.lattice)
        self._known: tuple[int, float] | None = None

    def read(self, run: Growth) -> float:
        """See `Sensor.__call__`."""
        if self._known is not None and np.isinf(self._known[1]):
            # Bonds do not heal: what has parted stays so, and its equations are gone.
            return self._known[1]
        self.record.catch_up()
        count = len(self.record.broken)
        if self._known is None or self._known[0] != count:
            self._known = count, self._solved()
        return self._known[1]

    def _solved(self) -> float:
        try:
            self.body.follow()
            loose = self.body.fragments()
            if len(loose):
                self.body.set_aside(loose)
            self.body.solve()
        except MechanismError:
            # Without a broken bond it is the scene that is wrong.
            if not len(self.record.broken):
                raise
            return float("inf")
        return _difference(self.body.unknowns[0], self.plus, self.minus)


def _difference(values: Array, plus: Mask, minus: Mask) -> float:
    return float(np.mean(values[plus]) - np.mean(values[minus]))
