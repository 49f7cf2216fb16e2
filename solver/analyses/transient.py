"""Transient heat conduction c ∂T/∂t = div(D ∇T) + source, by TR-BDF2 with adapted steps.

The method, of second order and L-stable, and how its steps are chosen: see
`solver.analyses.heating`.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .. import threads
from ..arrays import Array
from ..blas import one_thread
from ..bonds import Cells
from ..errors import SceneError
from ..problem import Description, Discretisation, Forcing
from ..problem.values import Value
from ..result import Result, Table
from .heating import Heating
from .recording import History, Progress, checked_times
from .registry import Analysis
from .stepping import require_end


@dataclass(frozen=True)
class TransientStatistics:
    """How a transient was obtained.

    Attributes
    ----------
    particles, unknowns : int
    steps, rejected : int
        Steps taken, and tried in vain.
    iterations, preconditioners : int
        Of all linear solves (three a step); preconditioners made.
    error : float
        Sum of the estimated errors of the steps, K.
    balance : float
        |heat stored − heat that flowed in|, relative to the largest of the two and of the heat
        that the span of temperatures stands for.
    setup_seconds, solve_seconds : float
        Wall time of the discretisation and of the steps of this process.
    warnings : tuple of str
        What the answer leaves out or settles by a rule, one sentence each.
    """

    particles: int
    unknowns: int
    steps: int
    rejected: int
    iterations: int
    preconditioners: int
    error: float
    balance: float
    setup_seconds: float
    solve_seconds: float
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Transient(Result):
    """Temperatures at the times asked for.

    Attributes
    ----------
    body : Discretisation
    times : ndarray, shape (k,), s
    temperature : ndarray, shape (k, N), K
    stored, supplied : ndarray, shape (k,), J/m
        Heat in the free particles per unit thickness, and what has flowed into them since the
        start: sources, edges and supports together.
    history : History
        At the probes, every step.
    statistics : TransientStatistics
    """

    body: Discretisation
    times: Array
    temperature: Array
    stored: Array
    supplied: Array
    history: History
    statistics: TransientStatistics
    _forcing: Forcing = field(repr=False)

    @property
    def points(self) -> Array:
        """Particle centres, shape (N, 2), m."""
        return self.body.lattice.points

    def surface_temperature(self, index: int = -1) -> Array:
        """T at the surface's nodes at one of the times, shape (s,), K."""
        then = self._forcing.at(float(self.times[index]))
        found = then.surface_values(self.temperature[index][None])
        return np.zeros(0) if found is None else found[0]

    @property
    def cells(self) -> Cells:
        """The particles' cells, parted where bonds carry nothing."""
        return Cells.of(self.body.bonds)

    def fields(self, index: int = -1) -> dict[str, Array]:
        """Fields by name at one of the times."""
        return {"temperature": self.temperature[index]}

    def tables(self) -> dict[str, Table]:
        """Heat at the times, and the history of the probes if there are any."""
        heat = Table(
            ("time", "stored", "supplied"),
            np.column_stack([self.times, self.stored, self.supplied]),
        )
        return {"heat": heat, **self.history.table(("temperature",))}

    def summary(self) -> dict[str, Any]:
        """Plain values, for JSON."""
        found = {"physics": self.body.scene.physics.name, **vars(self.statistics)}
        return found | {"end": float(self.times[-1]), "times": len(self.times)}


def run(
    scene: Description,
    initial: Value,
    times: ArrayLike,
    *,
    start: float = 0.0,
    tolerance: float = 1e-4,
    step: float | None = None,
    probes: ArrayLike | None = None,
    series: str | os.PathLike[str] | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    every: int = 20,
    progress: Progress | None = None,
) -> Transient:
    """March a conductive scene through time.

    Supports and loads may be functions of (x, y, t). A body that nothing holds is insulated.

    Parameters
    ----------
    scene : Scene
        With a `heat_capacity`.
    initial : number, array of shape (N,) or function of (x, y), K
        Of the free particles; held ones have their supports' values from the start on.
    times : sequence of float, s
        When fields are kept; steps end there. The last one ends the run.
    start : float, s
    tolerance : float
        Of the largest error of a step in any particle, relative to the span of temperatures met
        so far.
    step : float, optional, s
        Steps of this length (or a little less) instead of adapted ones; errors are estimated
        all the same.
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
        If the scene has no heat to conduct, or what is asked for makes no sense.
    ConvergenceError
        If steps shrink to nothing, or a solve stops short.
    """
    begun = perf_counter()
    if scene.physics.storage != "heat_capacity":
        raise SceneError("transient conduction needs a conductive body; elastic ones: solver.waves")
    if scene.heat_capacity is None:
        raise SceneError(
            "transient conduction needs what the body stores: give the scene a heat_capacity, "
            "J/(m³ K)"
        )
    if not 0 < tolerance < 1:
        raise SceneError(f"the tolerance must lie between 0 and 1, not {tolerance}")
    if step is not None and not 0 < step < np.inf:
        raise SceneError(f"the step must be a positive time, not {step}")
    wanted = checked_times(times, start)
    if step is not None:
        require_end(float(wanted[-1]) - start, step)
    body = Discretisation.of(scene.at(start), free=True)
    heating = Heating(body, scene, initial, wanted, start, tolerance, step)
    heating.record(probes, series, checkpoint, every)
    setup = perf_counter() - begun
    with one_thread(), threads.suited(body.operator):
        heating.go(progress)
    return _result(heating, setup, perf_counter() - begun - setup)


def _result(heating: Heating, setup: float, solve: float) -> Transient:
    """What is handed back."""
    cell = heating.body.scene.spacing**2
    stored, supplied = np.array(heating.ledger).T
    gap = float(np.abs(stored - heating.initial - supplied).max())
    size = max(
        float(np.abs(stored - heating.initial).max()),
        float(np.abs(supplied).max()),
        float(heating.capacity.sum()) * (heating.high - heating.low),
    )
    operator = heating.body.operator
    statistics = TransientStatistics(
        particles=heating.body.lattice.count,
        unknowns=operator.shape[0],
        steps=heating.steps,
        rejected=heating.rejected,
        iterations=heating.solver.iterations,
        preconditioners=heating.solver.built,
        error=heating.error,
        balance=gap / size if size else 0.0,
        setup_seconds=setup,
        solve_seconds=solve,
        warnings=heating.body.warnings,
    )
    rows = heating.log.rows
    history = History(heating.watched, rows[:, 0].copy(), rows[:, None, 1:].copy())
    return Transient(
        heating.body,
        heating.times,
        np.array(heating.kept),
        stored * cell,
        supplied * cell,
        history,
        statistics,
        heating.forcing,
    )


def _asked(
    scene: Description,
    initial: Value,
    times: Sequence[float],
    start: float = 0.0,
    tolerance: float = 1e-4,
    step: float | None = None,
    probes: Sequence[tuple[float, float]] | None = None,
    series: str | None = None,
    checkpoint: str | None = None,
    every: int = 20,
    progress: Progress | None = None,
) -> Transient:
    """`run`, by what a scene file can say."""
    return run(
        scene,
        initial,
        times,
        start=start,
        tolerance=tolerance,
        step=step,
        probes=probes,
        series=series,
        checkpoint=checkpoint,
        every=every,
        progress=progress,
    )


ANALYSIS = Analysis("transient", "Conduction of heat in time.", _asked, timed=True)
