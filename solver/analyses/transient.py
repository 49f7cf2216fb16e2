"""Transient heat conduction c ∂T/∂t = div(D ∇T) + source, by TR-BDF2 with adapted steps.

A step of length h takes the trapezoidal rule over γ h and the second backward difference formula
over the rest, γ = 2 − √2 (Bank et al., IEEE Trans. Comput.-Aided Des. 4, 1985), which is a
diagonally implicit Runge–Kutta method: with rows r = f − K T of what flows in, d = γ/2, w = √2/4,

    C (T₂ − T) = h d (r₁ + r₂),    C (T₃ − T) = h (w r₁ + w r₂ + d r₃),

of second order and L-stable: what starts rough is damped and not set ringing. Both stages have
the matrix K + C/(d h), so that one preconditioner serves, and goes on serving while the step
stays (`solver.linear.shifted`). The difference from the embedded method of third order, taken
through the same matrix so that stiff parts do not count (Hosea and Shampine, Appl. Numer. Math.
20, 1996), estimates the error of a step. Conduction damps errors: their sum bounds, as far as
estimates can, the error in time at the end.

Unknowns of the linear systems are increments: where T lies on the Kelvin scale changes nothing.
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
from ..errors import ConvergenceError, SceneError
from ..linear.shifted import Shifted
from ..problem import Description, Discretisation, Forcing
from ..problem.rigid import parts
from ..problem.values import Value, evaluate
from ..result import Result, Table
from ..state_file import StateFile
from .recording import (
    History,
    Log,
    Progress,
    Series,
    checked_times,
    fingerprint,
    nearest,
)
from .registry import Analysis
from .stepping import require_end

_GAMMA = 2.0 - np.sqrt(2.0)
_D = 0.5 * _GAMMA
_W = 0.25 * np.sqrt(2.0)
# Third-order weights less those of the method: Σ b̂ = 1, Σ b̂ c = 1/2, Σ b̂ c² = 1/3.
_ERROR = ((1.0 - _W) / 3.0 - _W, (3.0 * _W + 1.0) / 3.0 - _W, _D / 3.0 - _D)
# Relative residual of the increments: far below any error that a step may make.
_SOLVE = 1e-9
# What a step's length may change by, its safety, and what it must gain to be worth a new matrix.
_SHRINK, _GROW, _SAFETY, _WORTH = 0.2, 3.0, 0.85, 1.3
# A step below this share of the whole time has lost its way.
_SHORTEST = 1e-13


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
    marching = _March(body, scene, initial, wanted, start, tolerance, step)
    marching.record(probes, series, checkpoint, every)
    setup = perf_counter() - begun
    with one_thread(), threads.suited(body.operator):
        marching.go(progress)
    return marching.result(setup, perf_counter() - begun - setup)


class _March:
    """A transient while it runs."""

    def __init__(
        self,
        body: Discretisation,
        scene: Description,
        initial: Value,
        times: Array,
        start: float,
        tolerance: float,
        step: float | None,
    ) -> None:
        assert scene.heat_capacity is not None
        self.body, self.times, self.tolerance, self.fixed = body, times, tolerance, step
        self.forcing = Forcing(body, scene)
        self.forcing.check(np.array([start, *times]))
        lattice, active = body.lattice, body.operator.active
        given = evaluate(initial, lattice.places, 1, "the initial temperature")[:, 0]
        self.capacity = scene.heat_capacity * body.storage("heat_capacity")[active]
        labels = np.unique(parts(body.bonds)[1][active], return_inverse=True)[1]
        self.solver = Shifted(body.operator, body.stability.kind, self.capacity[None], labels)
        ones = np.ones(len(active))
        # 1·K v for any v, because K is symmetric.
        self.outflow = body.operator.matvec(ones)
        self.start, self.time, self.x = start, start, given[active]
        self.change, self.length = np.zeros_like(self.x), 0.0
        self.h = 0.0 if step is None else step
        self.initial = float(self.capacity @ self.x)
        self.supplied = self.error = 0.0
        self.steps = self.rejected = 0
        held = self.forcing.values(start)[0]
        seen = np.concatenate([self.x, held[body.prescribed[0] & np.isfinite(held)]])
        self.low, self.high = (float(seen.min()), float(seen.max())) if len(seen) else (0.0, 0.0)
        self.kept: list[Array] = []
        self.ledger: list[tuple[float, float]] = []

    # ---- recording ----------------------------------------------------------------------

    def record(
        self,
        probes: ArrayLike | None,
        series: str | os.PathLike[str] | None,
        checkpoint: str | os.PathLike[str] | None,
        every: int,
    ) -> None:
        """Set up what is left behind, and go back to a saved state if there is one."""
        if isinstance(every, bool) or not isinstance(every, int) or every < 1:
            raise SceneError(f"a state is kept every so many steps, a whole number, not {every!r}")
        lattice = self.body.lattice
        self.watched = nearest(lattice, np.zeros((0, 2)) if probes is None else probes)
        self.series = None if series is None else Series(series, self.body.bonds)
        mark = ""
        if checkpoint is not None:
            driven = {
                f"values at {t!r}": self.forcing.right_hand_side(t)
                for t in (self.start, *map(float, self.times))
            }
            mark = fingerprint(
                self.body,
                initial=self.x,
                times=self.times,
                stepping=("TR-BDF2", self.start, self.tolerance, self.fixed),
                watched=self.watched,
                **driven,
            )
        self.file, self.every = StateFile(checkpoint, mark), every
        state = self.file.load()
        self.log = Log(1 + len(self.watched))
        if state is None:
            self.watch()
            if self.times[0] == self.start:
                self.keep()
            return
        self.x, self.change = state["x"], state["change"]
        self.time, self.length, self.h, self.supplied, self.error = state["numbers"].tolist()
        self.low, self.high = state["span"].tolist()
        self.steps, self.rejected, self.solver.iterations, built = state["counts"].tolist()
        with one_thread():
            anchor = float(state["anchor"])
            self.solver.restore(None if np.isnan(anchor) else anchor)
        self.solver.built = built
        self.kept, self.ledger = list(state["kept"]), [tuple(r) for r in state["ledger"].tolist()]
        self.log = Log(1 + len(self.watched), state["log"])

    def save(self) -> None:
        """Write the state."""
        anchor = self.solver.anchor
        self.file.save(
            {
                "x": self.x,
                "change": self.change,
                "numbers": [self.time, self.length, self.h, self.supplied, self.error],
                "span": [self.low, self.high],
                "counts": [self.steps, self.rejected, self.solver.iterations, self.solver.built],
                "anchor": np.nan if anchor is None else anchor,
                "kept": np.array(self.kept).reshape(len(self.kept), self.body.lattice.count),
                "ledger": np.array(self.ledger).reshape(-1, 2),
                "log": self.log.rows,
            }
        )

    def whole(self) -> Array:
        """T of all particles, shape (N,)."""
        then = self.forcing.at(self.time)
        return then.field(self.x)[0]

    def watch(self) -> None:
        if len(self.watched):
            self.log.append(np.array([self.time, *self.whole()[self.watched]]))

    def keep(self) -> None:
        """Keep the fields of one of the times."""
        field = self.whole()
        self.kept.append(field)
        self.ledger.append((float(self.capacity @ self.x), self.supplied))
        if self.series is not None:
            count = len(self.kept)
            self.series.write(count - 1, self.times[:count].tolist(), {"temperature": field})

    # ---- steps --------------------------------------------------------------------------

    def go(self, progress: Progress | None) -> None:
        """March to the last of the times."""
        whole = float(self.times[-1]) - self.start
        while len(self.kept) < len(self.times):
            target = float(self.times[len(self.kept)])
            rows = self.rows()
            if self.h == 0.0:
                self.h = self._first(rows, target - self.time)
            # Steps of equal length up to the next time, none longer than the one allowed.
            left = target - self.time
            count = max(1, int(np.ceil(left / self.h * (1 - 1e-9))))
            self._step(rows, left / count, target if count == 1 else None)
            if self.h < _SHORTEST * whole:
                raise ConvergenceError(
                    f"steps have shrunk to {self.h:.2e} s at t = {self.time:.6g} s: is a support "
                    f"or a source discontinuous in time? Let a time of the list fall there"
                )
            if self.file.path is not None and self.steps % self.every == 0:
                self.save()
            if progress is not None:
                progress(min(1.0, (self.time - self.start) / whole) if whole else 1.0)
        self.save()

    def rows(self) -> Array:
        """f − K T at the present time."""
        forcing = self.forcing.right_hand_side(self.time)
        return np.asarray(forcing - self.body.operator.matvec(self.x))

    def _first(self, rows: Array, left: float) -> float:
        """A first step that is short enough to be judged."""
        rate = float(np.abs(rows / self.capacity).max(initial=0.0))
        span = self.high - self.low
        if rate == 0.0 or span == 0.0:
            return 0.01 * left
        return float(min(left, self.tolerance ** (1 / 3) * span / rate))

    def _step(self, rows: Array, h: float, target: float | None) -> None:
        """Try a step; move on if it is good enough, and choose the length of the next."""
        begin = self.time
        end = begin + h if target is None else target
        f1, f2, f3 = (self.forcing.right_hand_side(t) for t in (begin, begin + _GAMMA * h, end))
        shift = 1.0 / (_D * h)
        guess = self.change * (_GAMMA * h / self.length if self.length else 0.0)
        first = self.solver.solve(shift, 2.0 * rows + f2 - f1, guess, _SOLVE)
        middle = shift * self.capacity * first - rows
        right = (_W / _D) * (rows + middle)
        change = self.solver.solve(shift, right + rows + f3 - f1, first / _GAMMA, _SOLVE)
        last = shift * self.capacity * change - right
        defect = sum(e * r for e, r in zip(_ERROR, (rows, middle, last), strict=True))
        zero = np.zeros_like(self.x)
        error = float(
            np.abs(self.solver.solve(shift, np.asarray(defect) / _D, zero, 1e-3)).max(initial=0.0)
        )
        x = self.x + change
        low, high = (
            float(x.min(initial=self.low)),
            float(x.max(initial=self.high)),
        )
        allowed = self.tolerance * (high - low)
        ratio = 1.0 if error == 0.0 else _SAFETY * (allowed / error) ** (1 / 3)
        if not np.isfinite(error):
            raise ConvergenceError(f"the temperatures are not finite at t = {end:.6g} s")
        if self.fixed is None:
            if error > allowed:
                self.h, self.rejected = h * max(_SHRINK, ratio), self.rejected + 1
                return
            # The length that was allowed, not the shorter one that met a time of the list.
            gain = min(_GROW, ratio if error else _GROW)
            if gain < 1.0 or h * gain > _WORTH * self.h:
                self.h = h * gain
        # What flowed in, from the rows of the stages themselves and not from what is stored.
        power = [
            float(rows.sum()),
            float(rows.sum() + (f2 - f1).sum() - self.outflow @ first),
            float(rows.sum() + (f3 - f1).sum() - self.outflow @ change),
        ]
        self.supplied += h * (_W * power[0] + _W * power[1] + _D * power[2])
        self.x, self.change, self.length = x, change, h
        self.low, self.high, self.error = low, high, self.error + error
        self.time, self.steps = end, self.steps + 1
        self.watch()
        if target is not None:
            self.keep()

    # ---- result -------------------------------------------------------------------------

    def result(self, setup: float, solve: float) -> Transient:
        """What is handed back."""
        cell = self.body.scene.spacing**2
        stored, supplied = np.array(self.ledger).T
        gap = float(np.abs(stored - self.initial - supplied).max())
        size = max(
            float(np.abs(stored - self.initial).max()),
            float(np.abs(supplied).max()),
            float(self.capacity.sum()) * (self.high - self.low),
        )
        operator = self.body.operator
        statistics = TransientStatistics(
            particles=self.body.lattice.count,
            unknowns=operator.shape[0],
            steps=self.steps,
            rejected=self.rejected,
            iterations=self.solver.iterations,
            preconditioners=self.solver.built,
            error=self.error,
            balance=gap / size if size else 0.0,
            setup_seconds=setup,
            solve_seconds=solve,
            warnings=self.body.warnings,
        )
        rows = self.log.rows
        history = History(self.watched, rows[:, 0].copy(), rows[:, None, 1:].copy())
        return Transient(
            self.body,
            self.times,
            np.array(self.kept),
            stored * cell,
            supplied * cell,
            history,
            statistics,
            self.forcing,
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
