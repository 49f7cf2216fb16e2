"""The state of a body whose bonds break, and how it goes on from one equilibrium to the next.

`solver.fracture.grow` leads it; what the energies are, is said there.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array, Indices, Mask
from ..bonds import Bonds, Cells, damage
from ..errors import ConvergenceError, NegativeCurvatureError, SceneError
from ..geometry import Where
from ..result import Result, Table
from ..scene import Scene
from ..solution import Solution
from ..state import State
from . import crack_path
from .breaking import TIE, Breakable, Criterion, Critical, next_batch
from .crack_path import CrackPath
from .damaged_body import Equilibrium, Step
from .ledger import History, Ledger, same
from .programme import Programme

# Share of the bonds that a straight cut breaks per cell of its length: the default batch. Larger
# and smaller ones (0.03 to 0.4) give the same paths and loads.
_BATCH = 0.2
# Relative residual within an avalanche. Mirror images must stay nearer than `breaking.TIE` in every
# bond: with 1e-5 of a pair of cracks they did not.
_ROUGH = 1e-6
# Utilisation, relative to what is to break or has broken, that is the solver's noise.
_NOISE = 1e-10


class Growth(Result):
    """A body whose bonds break: what `until` and monitors see, and what `grow` returns.

    Attributes
    ----------
    scene : Scene
    load_factor : float
        Load factor now.
    history : History
        Loads, energies, counts and the crack's advance at every equilibrium.
    reason : str
        Why the run has ended; empty while it goes on.
    batch : int
    """

    def __init__(
        self,
        scene: Scene,
        toughness: Critical | ArrayLike,
        programme: Programme,
        no_fail: tuple[Where, ...],
        tension_only: bool,
        criterion: Criterion,
        batch: int | None,
        tolerance: float,
        max_iterations: int,
        monitors: Mapping[str, Callable[[Growth], float]],
    ) -> None:
        if any(load.strain is not None for load in scene.loads):
            require_whole_bonds(scene)
        start = scene.discretise(sharp_tips=False, constrained=True)
        self.scene, self.programme, self.reason = scene, programme, ""
        #: Warnings about the scene; `warnings` adds what the run has come to.
        self.cautions = start.warnings
        self.bonds = Breakable(start, toughness, no_fail, tension_only, criterion)
        self.batch = _batch_size(batch, start.family.offsets)
        self.body = Equilibrium(start, self.bonds, tolerance, max_iterations)
        self.ledger = Ledger(self.body, self.bonds)
        # Solver options that decide results, for checkpoints.
        self.options = (tension_only, criterion, self.batch, tolerance, max_iterations)
        self.history = History(tuple(monitors))
        self._monitors = monitors
        self.load_factor, self.target, self.resting = programme.start, 0, True
        # Whether the last equilibrium keeps the tolerance, or is one within an avalanche.
        self.precise = True
        self.solves: list[tuple[int, int, bool]] = []
        self._starts = crack_path.initial_tips(scene.cracks, scene.region)
        # Utilisation, and of which answer with how many bonds gone.
        self._judged: tuple[tuple[Array, Array, int], int, Array] | None = None
        self._paths: tuple[int, list[CrackPath]] = (-1, [])

    # ---- what has happened ----------------------------------------------------------------

    @property
    def breaks(self) -> NDArray[Any]:
        """Broken bonds in their order: fields offset (half), origin, step, load_factor.

        `step` is the number of the solve before which the bond broke. Bonds of one batch are in
        no order.
        """
        kept = self.bonds.broken.by_load
        found = np.zeros(
            len(kept),
            dtype=[("offset", "i8"), ("origin", "i8"), ("step", "i8"), ("load_factor", "f8")],
        )
        found["offset"], found["origin"] = np.divmod(kept["bond"], self.bonds.lattice.count)
        found["step"], found["load_factor"] = kept["step"], kept["load_factor"]
        return found

    @property
    def steps(self) -> NDArray[Any]:
        """Every solve: bonds broken before it, iterations, preconditioner brought up to date."""
        return np.array(
            self.solves, dtype=[("broken", "i8"), ("iterations", "i8"), ("refreshed", "?")]
        )

    @property
    def broken_bonds(self) -> Indices:
        """Flat indices (half offset · N + particle of origin) of broken bonds, in their order."""
        return self.bonds.broken.by_load["bond"]

    @property
    def broken(self) -> Mask:
        """Broken bonds as `Scene.broken` returns them, shape (family size / 2, N)."""
        return self.bonds.broken.mask(self.bonds.whole.shape)

    @property
    def loose(self) -> Mask:
        """Particles that came loose and were set aside, shape (N,)."""
        return self.body.aside

    @property
    def damage(self) -> Array:
        """Damage of every particle (Eq. 105), cuts by the scene's cracks included, shape (N,).

        Bonds within a loose fragment count as long as they are whole: only those that broke are
        gone, not those that setting it aside took out of the equations.
        """
        return damage(self.left)

    @property
    def left(self) -> Bonds:
        """The bonds that have not broken, those within loose fragments too."""
        offsets, origins = np.divmod(self.broken_bonds, self.bonds.lattice.count)
        return self.body.sound.bonds.breaking(offsets, origins)

    @property
    def midpoints(self) -> Array:
        """Midpoints of the broken bonds, in their order, shape (n, 2), m."""
        return self.bonds.midpoints(self.broken_bonds)

    @property
    def paths(self) -> list[CrackPath]:
        """Ways of all crack tips, the furthest first; see `crack_path`.

        Every tip of the scene's cracks has one, however short, and every other tip that there is:
        of cracks that have begun by themselves (both of them, where one grew both ways), and of
        branches.
        """
        records = self.bonds.broken.by_load
        short = self.bonds.lengths(records["bond"]) <= crack_path.SHORT * self.scene.spacing
        known = int(short.sum())
        if self._paths[0] != known:
            records = records[short]
            traced = crack_path.trace(
                self._starts,
                self.bonds.midpoints(records["bond"]),
                self.scene.spacing,
                records["step"],
                max(5.0, self.scene.m),
            )
            self._paths = known, traced
        return self._paths[1]

    @property
    def path(self) -> Array:
        """Points of the furthest path, shape (n, 2), m; empty before anything has grown."""
        return self.paths[0].points if self.paths else np.zeros((0, 2))

    @property
    def tip(self) -> Array:
        """Tip of the furthest path, shape (2,), m; NaN before there is one."""
        return self.paths[0].tip if self.paths else np.full(2, np.nan)

    @property
    def advance(self) -> float:
        """Distance of the furthest tip from where its crack began to grow, m."""
        return self.paths[0].advance if self.paths else 0.0

    @property
    def unknowns(self) -> Array:
        """u1, u2 and θ Δx under the present load, shape (components, N)."""
        return self.load_factor * self.body.unknowns

    @property
    def solution(self) -> Solution:
        """The present equilibrium as a solution, for `solver.recovery` and export."""
        return self.body.solution(self.load_factor)

    @property
    def points(self) -> Array:
        """Particle centres, shape (N, 2), m."""
        return self.body.sound.lattice.points

    @property
    def cells(self) -> Cells:
        """The particles' cells, parted where bonds carry nothing."""
        return Cells.of(self.left)

    @property
    def stressed(self) -> State | None:
        """The last equilibrium."""
        return self.solution

    def fields(self) -> dict[str, Array]:
        """Fields of the last equilibrium under its load, the damage, and what came loose."""
        return {**self.solution.fields(), "damage": self.damage, "loose": self.loose.astype(float)}

    def tables(self) -> dict[str, Table]:
        """The history, and the points of the furthest crack's path."""
        history = Table(self.history.names, self.history.array)
        return {"history": history, "path": Table(("x", "y"), self.path)}

    def summary(self) -> dict[str, Any]:
        """How the run ended, what broke, the energies and what it took."""
        h, steps = self.history, self.steps
        return {
            "ended": self.reason,
            "load factor": self.load_factor,
            "largest factor": float(h.load_factor.max()),
            "advance": self.advance,
            "tip": f"({self.tip[0]:.4g}, {self.tip[1]:.4g})",
            "bonds broken": len(self.broken_bonds),
            "loose particles": int(self.loose.sum()),
            "work": float(h.work[-1]),
            "stored": float(h.stored[-1]),
            "dissipated": float(h.dissipated[-1]),
            "excess": float(h.excess[-1]),
            "imbalance": float(h.imbalance[-1]),
            "solves": len(steps),
            "iterations": int(steps["iterations"].sum()),
            "bonds a solve": len(self.broken_bonds) / len(steps),
            "warnings": self.warnings,
        }

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the run leaves out or settles by a rule, one sentence each."""
        return self.solution.statistics.warnings

    @property
    def marks(self) -> dict[str, Any]:
        """What decides results beyond scene, toughness and programme, for checkpoints."""
        return {}

    # ---- what happens ---------------------------------------------------------------------

    def arrive(self) -> None:
        """What a saved `target` stands for besides a load factor: nothing here."""

    def begin(self) -> None:
        """First equilibrium, loaded to the first factor without breaking anything."""
        step = self.body.solve()
        self.solves.append((0, step.iterations, step.refreshed))
        self.ledger.opened()
        self.ledger.move(0.0, self.load_factor)
        self.record()
        self.reason = self._idle()

    def _idle(self) -> str:
        """Why no load factor will ever break a bond, if so: known from the first equilibrium."""
        if self.ledger.unstrained and self.body.unknowns.any():
            return (
                "the load moves the body and does not strain it: the parts that it moves are not "
                "joined (a crack runs right through?), or move as one"
            )
        return ""

    def finish(self) -> None:
        """Bring an equilibrium in the middle of an avalanche to the tolerance of those at rest."""
        if self.precise:
            return
        step, (broken, iterations, refreshed) = self._equilibrium(), self.solves[-1]
        self.precise = True
        self.solves[-1] = (broken, iterations + step.iterations, refreshed or step.refreshed)
        self.ledger.solved(step, self.load_factor)

    def proceed(self) -> None:
        """On to the next equilibrium: a batch of bonds breaks, or the load changes."""
        utilisation = self._utilisation()
        if self.programme.control == "following":
            self._follow(utilisation)
            return
        # Bonds are overloaded where λ² q ≥ 1.
        least = 1.0 / self.load_factor**2 if self.load_factor else np.inf
        batch, _ = next_batch(utilisation, least, self.batch)
        if len(batch):
            self.resting = False
            self._break(batch)
        elif not self.precise:
            self._solve(0)
        elif not self.resting:
            self._set_aside(self.body.fragments())
            self.resting = True
            self.record()
            self._ended()
        else:
            self._load(float(utilisation.max(initial=0.0)))

    def _utilisation(self) -> Array:
        """Of all bonds in the present equilibrium: asked for at its end and for the next batch.

        Who looks on may have asked for that of another field in between.
        """
        state, known = (self.body.unknowns, self.bonds.free, len(self.bonds.broken)), self._judged
        if known is None or known[1] != self.bonds.asked or not same(known[0], state):
            found = self.bonds.utilisation(state[0])
            known = self._judged = state, self.bonds.asked, found
        return known[2]

    def _ended(self) -> bool:
        """Whether nothing is left to do at a state of rest; says so in `reason`."""
        h = self.history
        if len(self.bonds.broken) and self.ledger.unloaded:
            self.reason = "the body has parted"
        elif self.programme.least_force is not None and len(h):
            peak = float(np.abs(h["force"]).max())
            now = abs(float(h["force"][-1]))
            if len(self.bonds.broken) and peak > 0 and now < self.programme.least_force * peak:
                self.reason = (
                    f"the force has fallen below {self.programme.least_force:g} of its peak"
                )
        return bool(self.reason)

    def _load(self, largest: float) -> None:
        """Change the load to the next event or the next target."""
        targets = self.programme.targets
        target = targets[self.target]
        event = self._event(largest)
        if not np.isfinite(event) and not np.isfinite(target):
            self.reason = "no load breaks another bond"
            return
        if target > self.load_factor and event <= target * (1 + TIE):
            self._move(self.programme.reach(max(event, self.load_factor), target))
            self.record()
            return
        if not np.isfinite(target):
            self.reason = "no load breaks another bond"
            return
        self._move(target)
        self.record()
        self.target += 1
        if self.target == len(targets):
            self.reason = "the programme is done"

    def _follow(self, utilisation: Array) -> None:
        """Break the next batch at the load that just overloads all of it."""
        # What next to nothing loads is noise, and no part of a batch.
        least = _NOISE * float(utilisation.max(initial=0.0))
        batch, load = next_batch(utilisation, least, self.batch)
        event = self._event(float(load.min())) if len(batch) else np.inf
        if not np.isfinite(event):
            batch = batch[:0]
        if event > self.programme.stop or not len(batch):
            self._set_aside(self.body.fragments())
            if self.ledger.unloaded:
                self.resting = True
                self.record()
                self.reason = "the body has parted"
                return
            if np.isfinite(self.programme.stop):
                self._move(self.programme.stop)
            self.resting = True
            self.record()
            self.reason = "the programme is done" if len(batch) else "no load breaks another bond"
            return
        self._move(max(event, self.programme.start))
        self.resting = True
        self.record()
        if self._ended():
            return
        self.resting = False
        self._break(batch)

    def _event(self, largest: float) -> float:
        """Load factor of the next event; infinite if bonds bear nothing but the solver's noise."""
        if largest <= 0.0:
            return float(np.inf)
        event = float(1.0 / np.sqrt(largest))
        before = self.bonds.broken.records["load_factor"].max(initial=-np.inf)
        before = np.inf if before == -np.inf else before
        return event if event * np.sqrt(_NOISE) < before else float(np.inf)

    def _move(self, factor: float) -> None:
        self.ledger.move(self.load_factor, factor)
        self.load_factor = factor

    def _break(self, batch: Indices) -> None:
        """Break bonds, and on to the next equilibrium."""
        self.ledger.broken(batch, self.load_factor)
        self._remove(batch, dropped=False)
        self._set_aside(self.body.slack())
        # Within an avalanche it is enough to tell overloaded bonds from others.
        rough = self.programme.control == "fixed"
        self._solve(len(batch), max(_ROUGH, self.body.tolerance) if rough else None)

    def _solve(self, broken: int, tolerance: float | None = None) -> None:
        """Equilibrium after `broken` bonds broke, to a coarser `tolerance` if one is given."""
        step = self._equilibrium(tolerance)
        self.precise = tolerance is None or tolerance <= self.body.tolerance
        self.solves.append((broken, step.iterations, step.refreshed))
        self.ledger.solved(step, self.load_factor)

    def _equilibrium(self, tolerance: float | None = None) -> Step:
        """A new one; a part that moves freely is set aside."""
        try:
            return self.body.solve(tolerance)
        except (ConvergenceError, NegativeCurvatureError):
            particles = self.body.fragments()
            if not len(particles):
                particles = self.body.hinges()
            if not len(particles):
                raise
            self._set_aside(particles)
            return self.body.solve(tolerance)

    def _remove(self, bonds: Indices, dropped: bool) -> None:
        step = len(self.solves)
        self.bonds.broken.add(bonds, step, self.load_factor, dropped)
        self.body.follow()
        self.ledger.parted(self.load_factor)

    def _set_aside(self, particles: Indices) -> None:
        """Set aside particles that cannot carry load, and others that this leaves slack."""
        while len(particles):
            bonds = self.bonds.of_particles(particles)
            self.ledger.dropped(bonds, self.load_factor)
            if len(bonds):
                self._remove(bonds, dropped=True)
            self.body.set_aside(particles)
            particles = self.body.slack()

    def record(self) -> None:
        """Another line of the history."""
        steps, tip = self.steps, self.tip
        self.history.add(
            load_factor=self.load_factor,
            **self.ledger.row(self.load_factor),
            broken=len(self.broken_bonds),
            loose=int(self.loose.sum()),
            solves=len(steps),
            iterations=int(steps["iterations"].sum()),
            advance=self.advance,
            tip_x=float(tip[0]),
            tip_y=float(tip[1]),
            settled=float(self.resting),
            **{name: float(monitor(self)) for name, monitor in self._monitors.items()},
        )


def require_whole_bonds(scene: Scene) -> None:
    """Refuse bonds that end at the surface: temperatures do not strain them while others break."""
    if scene.surface == "extrapolated":
        raise SceneError(
            "bonds that end at the surface cannot be broken under temperatures yet: use "
            "surface='volume' or 'none'"
        )


def _batch_size(batch: int | None, offsets: NDArray[np.int64]) -> int:
    if batch is None:
        # Bonds that a cut along a row of the lattice breaks per cell.
        return max(1, round(_BATCH * float(np.abs(offsets[:, 1]).sum()) / 2))
    if isinstance(batch, bool) or int(batch) != batch or batch < 1:
        raise SceneError(f"a batch holds at least one bond, not {batch}")
    return int(batch)
