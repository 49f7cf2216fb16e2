"""Cracks that grow while a body cools or warms: one field of temperature after the other.

A quenched body is no body under a load factor: its temperatures change in shape. Between two fields
nothing breaks and all is linear, so that the way from one to the next is a straight line, in the
displacements too, and what expansion does against the bonds is known exactly,

    −½ Σ L k [(ε − e)₀ + (ε − e)₁]·(e₁ − e₀) α Λ Δv Δv,

e the strains that cost nothing. Then bonds that carry more than they bear break, batch by batch, at
temperatures that hold still; fields lie so close in time that what this sets free beyond the
toughness (`excess`) stays small. Only mechanical strain ε − e loads a bond. What else acts on the
body acts in full from the start.

The temperatures are given. Those of heat conduction (`solver.transient`) are those of the body as
it was: that grown cracks stop heat is left out, which cracks along the flow do not.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..errors import SceneError
from ..geometry import Where
from ..material import ExpansionTensor
from ..operators.eigenstrain import Eigenstrain
from ..problem import Load
from ..scene import Scene
from .breaking import Criterion, Critical, free_strains
from .growth import Growth
from .programme import Programme

if TYPE_CHECKING:
    from ..analyses.transient import Transient


@dataclass(frozen=True, eq=False)
class Temperatures:
    """Changes of temperature that a body goes through.

    Parameters
    ----------
    times : array_like, shape (k,), s
        Ascending.
    changes : array_like, shape (k, N), K
        One field of particles a time, from where the body is free of strain.
    expansion : ExpansionTensor
        In plane strain the plane's effective one.

    Raises
    ------
    SceneError
        If times do not ascend, or fields and times are not alike in number, or not finite.
    """

    times: Array
    changes: Array
    expansion: ExpansionTensor

    def __init__(self, times: ArrayLike, changes: ArrayLike, expansion: ExpansionTensor) -> None:
        at, fields = np.array(times, dtype=np.float64), np.array(changes, dtype=np.float64)
        if at.ndim != 1 or not at.size or not np.isfinite(at).all() or (np.diff(at) <= 0).any():
            raise SceneError("the times of temperatures must be finite numbers that ascend")
        if fields.ndim != 2 or len(fields) != len(at):
            raise SceneError(
                f"{len(at)} times need as many fields of temperature, one value a particle, not "
                f"shape {fields.shape}"
            )
        if not np.isfinite(fields).all():
            raise SceneError("temperatures must be finite")
        if not isinstance(expansion, ExpansionTensor):
            raise SceneError(
                f"a temperature needs the solid's ExpansionTensor, not {type(expansion).__name__}"
            )
        object.__setattr__(self, "times", at)
        object.__setattr__(self, "changes", fields)
        object.__setattr__(self, "expansion", expansion)

    @classmethod
    def of(
        cls, transient: Transient, expansion: ExpansionTensor, free_at: float = 0.0
    ) -> Temperatures:
        """Those of heat conduction; the body is free of strain at the temperature `free_at`, K."""
        return cls(transient.times, transient.temperature - free_at, expansion)

    def load(self, k: int) -> Load:
        """The k-th field as a scene's load."""
        return Load.temperature(self.changes[k], self.expansion)

    def strained(self, known: Eigenstrain, k: int) -> Eigenstrain:
        """`known` with the k-th field instead."""
        particles = self.expansion.voigt[:, None] * self.changes[k]
        return replace(known, particles=particles, temperature=self.changes[k])


class Tempered(Growth):
    """A body whose bonds break while its temperatures change; see `Growth`.

    Its history has the time, s, in a column of its own.

    Attributes
    ----------
    temperatures : Temperatures
    """

    def __init__(
        self,
        scene: Scene,
        toughness: Critical | ArrayLike,
        temperatures: Temperatures,
        no_fail: tuple[Where, ...],
        tension_only: bool,
        criterion: Criterion,
        batch: int | None,
        tolerance: float,
        max_iterations: int,
        monitors: Mapping[str, Callable[[Growth], float]],
    ) -> None:
        if "time" in monitors:
            raise SceneError("the history of a body that cools has its own column 'time'")
        if any(load.strain is not None for load in scene.loads):
            raise SceneError(
                "the scene has a temperature of its own beside those that change: give one"
            )
        self.temperatures = temperatures
        super().__init__(
            replace(scene, loads=[*scene.loads, temperatures.load(0)]),
            toughness,
            Programme(start=1.0, levels=(1.0,)),
            no_fail,
            tension_only,
            criterion,
            batch,
            tolerance,
            max_iterations,
            {"time": lambda _: self.time, **monitors},
        )

    @property
    def time(self) -> float:
        """Time of the present temperatures, s."""
        return float(self.temperatures.times[self.target])

    @property
    def marks(self) -> dict[str, Any]:
        """What decides results beyond a body under a load factor."""
        given = self.temperatures
        return {"times": given.times, "changes": given.changes, "matrix": given.expansion.matrix}

    def arrive(self) -> None:
        """Give the body the temperatures of `target`, without a new equilibrium."""
        warm = self.body.sound.eigenstrain
        assert warm is not None
        self.body.warm(self.temperatures.strained(warm, self.target))
        self.bonds.free = free_strains(self.body.sound)

    def _idle(self) -> str:
        """Nothing: what does not strain the body yet may do so at another time."""
        return ""

    def _ended(self) -> bool:
        """Only with the last temperatures: a body without stress now may bear some later."""
        return False

    def _load(self, largest: float) -> None:
        """On to the next temperatures."""
        if self.target + 1 == len(self.temperatures.times):
            self.reason = "the last temperatures are reached"
            return
        self.target += 1
        before, free = self.body.unknowns, self.bonds.free
        self.arrive()
        change = self.bonds.free - free
        now, self.bonds.free = self.bonds.free, free
        done = self.bonds.expansion_work(before, change)
        self.bonds.free = now
        # What expands loads nothing that moves freely: nothing has to be set aside for it.
        step = self.body.solve()
        self.solves.append((0, step.iterations, step.refreshed))
        done += self.bonds.expansion_work(self.body.unknowns, change)
        self.ledger.warmed(0.5 * done)
        self.record()
