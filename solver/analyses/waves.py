"""Elastodynamics: ρ ∂²u/∂t² = div σ + b, marched in time.

Velocity Verlet by default: of second order, explicit, without drift of energy. A Cauchy solid
resists no rotation of its points, so rotations carry no inertia and are in equilibrium at every
step (`solver.linear.rotations`), which leaves S waves as fast as they should be and works for
every sign of the shear stiffness; ``rotations="inertia"`` gives them that of a particle's square
instead. Measured with ν = 0.2 and m = 5, the costs to the same time are about equal: an inner
solve of some products of the small block against a step that is 3.6 times shorter.

The longest stable step follows from the largest eigenvalue of the body itself, found by a few
Lanczos steps: the bulk symbol's is unsafe near surfaces. Newmark's average acceleration is there
for bodies whose interesting motion is slower by far, slender or stiff ones. Its phase errs by
(ω Δt)²/12: a strip twenty times as long as thick (4 cells, m = 2), held at one end and bending for
1.25 periods, takes Verlet's method 10,471 steps; Newmark's with 40 steps a period costs 1/6.8 of
the CPU time at an error of 1.6 %, with 160 steps 1/1.8 at 0.1 %. By that law
the costs meet near 0.03 %.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from time import perf_counter
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from .. import threads
from ..arrays import Array
from ..blas import one_thread
from ..bonds import Cells
from ..errors import SceneError
from ..material import ChiralTensor, PolarTensor
from ..problem import Description, Discretisation, Forcing
from ..problem.values import Value
from ..result import Result, Table
from .motion import Motion, Settings
from .newmark_motion import NewmarkMotion
from .recording import History, Progress, checked_times
from .registry import Analysis
from .verlet_motion import VerletMotion


@dataclass(frozen=True)
class WaveStatistics:
    """How a motion was obtained.

    Attributes
    ----------
    particles, unknowns : int
    scheme, rotations : str
    steps : int
    step, stable_step : float, s
        The one taken, and the longest that Verlet's method allows on this body.
    products, inner : float
        A step's products with the whole operator, and with the block of the rotations alone (one
        unknown). Newmark: iterations a step, no inner ones.
    drift : float
        Largest change of energy that no load and no damping explains, relative to the largest
        energy; NaN where damping with the stiffness leaves no exact balance.
    setup_seconds, solve_seconds : float
        Wall time of the discretisation with the stable step, and of the steps of this process.
    warnings : tuple of str
        What the answer leaves out or settles by a rule, one sentence each.
    """

    particles: int
    unknowns: int
    scheme: str
    rotations: str
    steps: int
    step: float
    stable_step: float
    products: float
    inner: float
    drift: float
    setup_seconds: float
    solve_seconds: float
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class Ledger:
    """Energies and momenta at every step, per unit thickness.

    Energies are those that Verlet's method conserves: kinetic at the half step before, strain
    energy mutual to both its ends. Newmark: both at the step.

    Attributes
    ----------
    times, kinetic, strain, work, dissipated : ndarray, shape (s,); s and J/m
        Work and dissipation since the start. What supports do by moving counts as work. With
        Verlet and β the strain energy is that of u + β v, and dissipation what the balance leaves.
    momentum : ndarray, shape (s, 3); N s/m and N s
        Linear, and angular about the origin.
    """

    times: Array
    kinetic: Array
    strain: Array
    work: Array
    dissipated: Array
    momentum: Array

    @property
    def energy(self) -> Array:
        """Kinetic and strain energy, J/m."""
        return self.kinetic + self.strain


@dataclass(frozen=True, eq=False)
class Waves(Result):
    """Motion at the times asked for.

    Attributes
    ----------
    body : Discretisation
    times : ndarray, shape (k,), s
    displacement, velocity : ndarray, shape (k, N, 2); m, m/s
    rotation : ndarray, shape (k, N), rad
        NaN where the solid has no rotations.
    history : History
        Displacements at the probes, every step.
    ledger : Ledger
    statistics : WaveStatistics
    """

    body: Discretisation
    times: Array
    displacement: Array
    velocity: Array
    rotation: Array
    history: History
    ledger: Ledger
    statistics: WaveStatistics
    _forcing: Forcing = field(repr=False)

    @property
    def points(self) -> Array:
        """Particle centres, shape (N, 2), m."""
        return self.body.lattice.points

    def surface_displacement(self, index: int = -1) -> Array:
        """u at the surface's nodes at one of the times, shape (s, 2), m."""
        values = [*self.displacement[index].T]
        if self.body.operator.components == 3:
            values.append(self.rotation[index] * self.body.scene.spacing)
        then = self._forcing.at(float(self.times[index]))
        found = then.surface_values(np.array(values))
        return np.zeros((0, 2)) if found is None else found[:2].T

    @property
    def cells(self) -> Cells:
        """The particles' cells, parted where bonds carry nothing."""
        return Cells.of(self.body.bonds)

    def fields(self, index: int = -1) -> dict[str, Array]:
        """Fields by name at one of the times."""
        return {
            "displacement": self.displacement[index],
            "velocity": self.velocity[index],
            "rotation": self.rotation[index],
        }

    def tables(self) -> dict[str, Table]:
        """Energies at every step, and the history of the probes if there are any."""
        ledger = self.ledger
        columns = ("time", "kinetic", "strain", "work", "dissipated")
        rows = np.column_stack([getattr(ledger, n) for n in ("times", *columns[1:])])
        return {"energy": Table(columns, rows), **self.history.table(("u1", "u2"))}

    def summary(self) -> dict[str, Any]:
        """Plain values, for JSON."""
        return {"physics": self.body.scene.physics.name, **vars(self.statistics)} | {
            "end": float(self.times[-1]),
            "times": len(self.times),
        }


def run(
    scene: Description,
    initial: Value,
    end: float,
    *,
    velocity: Value = (0.0, 0.0),
    times: ArrayLike | None = None,
    start: float = 0.0,
    step: float | None = None,
    courant: float = 0.9,
    scheme: Literal["verlet", "newmark"] = "verlet",
    rotations: Literal["condensed", "inertia"] = "condensed",
    damping: tuple[float, float] = (0.0, 0.0),
    tolerance: float | None = None,
    probes: ArrayLike | None = None,
    series: str | os.PathLike[str] | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    every: int = 200,
    progress: Progress | None = None,
) -> Waves:
    """March an elastic scene through time.

    Supports and loads may be functions of (x, y, t). A body that nothing holds moves freely.

    Parameters
    ----------
    scene : Scene
        With a `density`.
    initial, velocity : pair, array of shape (N, 2) or function of (x, y); m, m/s
        Of the free particles; held ones follow their supports.
    end : float, s
    times : sequence of float, optional, s
        When fields are kept, by cubic interpolation within steps; the end alone by default.
    start : float, s
    step : float, optional, s
        By default `courant` times the stable one (Newmark: ten times that). It is shortened a
        little so that the end is met.
    courant : float
    scheme : {"verlet", "newmark"}
    rotations : {"condensed", "inertia"}
        See the module's docstring; inertia with Verlet only.
    damping : pair of float
        Rayleigh's α (1/s) and β (s). β damps the strain rate, of supports that move too; it is of
        first order in time with Verlet's method, whose velocity lags half a step.
    tolerance : float, optional
        Of the moments that condensed rotations leave (1e-6), or of Newmark's systems (1e-10).
    probes : array_like, shape (p, 2), optional
        Points whose nearest particles are recorded at every step.
    series : path without suffix, optional
        Fields are written there for ParaView as the run goes, a .pvd and a .vtu for each time.
    checkpoint : path, optional
        The state is kept there every `every` steps; a run that finds one goes on from it.
    every : int
        Steps between two states that are kept.
    progress : callable, optional
        Told the share that is done.

    Raises
    ------
    SceneError
        If the scene cannot move, or what is asked for makes no sense: a step beyond the stable
        one among other things.
    NegativeCurvatureError
        If the body has a motion that releases energy.
    """
    begun = perf_counter()
    settings = _checked(
        scene, end, times, start, step, courant, scheme, rotations, damping, tolerance
    )
    body = Discretisation.of(scene.at(start), free=True)
    with one_thread(), threads.suited(body.operator):
        stepping = VerletMotion if settings.scheme == "verlet" else NewmarkMotion
        motion = stepping(body, scene, initial, velocity, settings)
        motion.record(probes, series, checkpoint, every)
        setup = perf_counter() - begun
        motion.go(progress)
    return _result(motion, setup, perf_counter() - begun - setup)


def _checked(
    scene: Description,
    end: float,
    times: ArrayLike | None,
    start: float,
    step: float | None,
    courant: float,
    scheme: str,
    rotations: str,
    damping: tuple[float, float],
    tolerance: float | None,
) -> Settings:
    """Everything that can be refused before the body is built."""
    if scene.physics.storage != "density":
        raise SceneError("waves need an elastic body; conductive ones: solver.transient")
    density = scene.density_for("waves")
    if not (np.isfinite(end) and end > start):
        raise SceneError(f"the end must come after the start at {start:g} s, not at {end} s")
    if scheme not in ("verlet", "newmark"):
        raise SceneError(f"scheme must be 'verlet' or 'newmark', not {scheme!r}")
    if rotations not in ("condensed", "inertia"):
        raise SceneError(f"rotations must be 'condensed' or 'inertia', not {rotations!r}")
    if rotations == "inertia" and isinstance(scene.material, ChiralTensor):
        raise SceneError(
            "rotations of a chiral solid follow its strain, and an inertia would hold them back: "
            "leave them massless (rotations='condensed')"
        )
    if rotations == "inertia" and isinstance(scene.material, PolarTensor):
        raise SceneError(
            "rotations of a polar solid have an inertia of the solid's own, which this model does "
            "not know: they carry none (rotations='condensed')"
        )
    if rotations == "inertia" and scheme == "newmark":
        raise SceneError("an implicit step needs no inertia of rotations: leave rotations out")
    if step is not None and not 0 < step < np.inf:
        raise SceneError(f"the step must be a positive time, not {step}")
    if not 0 < courant <= 1:
        raise SceneError(f"courant, a share of the stable step, lies between 0 and 1: {courant}")
    alpha, beta = (float(part) for part in damping)
    if not (0 <= alpha < np.inf and 0 <= beta < np.inf):
        raise SceneError(f"damping takes two numbers that are not negative, not {damping}")
    usual = 1e-6 if scheme == "verlet" else 1e-10
    accuracy = usual if tolerance is None else tolerance
    if not 0 < accuracy < 1e-2:
        raise SceneError(f"the tolerance must lie between 0 and 0.01, not {tolerance}")
    wanted = checked_times([end] if times is None else times, start, end)
    return Settings(
        density, start, end, wanted, step, courant, scheme, rotations, alpha, beta, accuracy
    )


def _result(motion: Motion, setup: float, solve: float) -> Waves:
    body, settings = motion.body, motion.settings
    cell = body.scene.spacing**2
    rows = motion.log.rows
    kinetic, strain, work, dissipated = cell * rows[:, 1:5].T
    ledger = Ledger(rows[:, 0].copy(), kinetic, strain, work, dissipated, cell * rows[:, 5:8])
    exact = not (settings.beta and settings.scheme == "verlet")
    if not exact:
        ledger = replace(ledger, dissipated=ledger.energy[0] + ledger.work - ledger.energy)
    balance = ledger.energy - ledger.work + ledger.dissipated
    # Verlet's conserved energy begins at the first half step.
    begin = min(1, len(rows) - 1) if settings.scheme == "verlet" else 0
    largest = float(ledger.energy.max())
    drift = float(np.abs(balance[begin:] - balance[begin]).max()) / largest if largest > 0 else 0.0
    kept = np.array(motion.kept)
    count = max(motion.steps, 1)
    statistics = WaveStatistics(
        particles=body.lattice.count,
        unknowns=body.operator.shape[0],
        scheme=settings.scheme,
        rotations=settings.rotations if body.operator.components == 3 else "none",
        steps=motion.steps,
        step=motion.step,
        stable_step=motion.stable,
        products=motion.products / count,
        inner=motion.inner / count,
        drift=drift if exact else float("nan"),
        setup_seconds=setup,
        solve_seconds=solve,
        warnings=body.warnings + body.overlaps(_last(kept, body)),
    )
    probed = rows[:, 8:].reshape(len(rows), 2, -1)
    return Waves(
        body,
        settings.times,
        np.moveaxis(kept[:, 0:2], 1, 2),
        np.moveaxis(kept[:, 2:4], 1, 2),
        kept[:, 4],
        History(motion.watched, ledger.times, probed),
        ledger,
        statistics,
        motion.forcing,
    )


def _last(kept: Array, body: Discretisation) -> Array:
    """Unknowns of the last fields, shape (components, N)."""
    scales = body.moduli.scales(body.scene.spacing)
    return np.asarray(kept[-1][[0, 1, 4][: len(scales)]] * scales[:, None])


def _asked(
    scene: Description,
    end: float,
    initial: Annotated[Value, 2] = (0.0, 0.0),
    velocity: Annotated[Value, 2] = (0.0, 0.0),
    times: Sequence[float] | None = None,
    start: float = 0.0,
    step: float | None = None,
    courant: float = 0.9,
    scheme: Literal["verlet", "newmark"] = "verlet",
    rotations: Literal["condensed", "inertia"] = "condensed",
    damping: tuple[float, float] = (0.0, 0.0),
    probes: Sequence[tuple[float, float]] | None = None,
    series: str | None = None,
    checkpoint: str | None = None,
    every: int = 200,
    progress: Progress | None = None,
) -> Waves:
    """`run`, by what a scene file can say."""
    return run(
        scene,
        initial,
        end,
        velocity=velocity,
        times=times,
        start=start,
        step=step,
        courant=courant,
        scheme=scheme,
        rotations=rotations,
        damping=(damping[0], damping[1]),
        probes=probes,
        series=series,
        checkpoint=checkpoint,
        every=every,
        progress=progress,
    )


ANALYSIS = Analysis("waves", "Motion of an elastic body in time.", _asked, timed=True)
