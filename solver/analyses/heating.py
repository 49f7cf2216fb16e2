"""Heat while it flows: state, steps by TR-BDF2, and how a run goes on after a kill.

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

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..blas import one_thread
from ..errors import ConvergenceError, SceneError
from ..linear.shifted import Shifted
from ..problem import Description, Discretisation, Forcing
from ..problem.rigid import parts
from ..problem.values import Value, evaluate
from ..state_file import StateFile
from .recording import Log, Progress, Series, fingerprint, nearest

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


class Heating:
    """Temperatures of the active particles, from step to step.

    Parameters
    ----------
    body : Discretisation
        At the start.
    scene : Description
        With its functions of time.
    initial : values of one component
    times : (k,) array, s
        When fields are kept.
    start, tolerance, step
        See `solver.analyses.transient.run`.
    """

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
