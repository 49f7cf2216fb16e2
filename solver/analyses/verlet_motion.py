"""A body in motion by Verlet's method: explicit steps below the stable one."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import SceneError
from ..linear.rotations import MasslessRotations
from .motion import Motion
from .recording import Progress
from .stepping import Internal, Verlet


class VerletMotion(Motion):
    """Velocities half a step behind; rotations condensed at every step, or with inertia."""

    def _admit(self, step: float) -> None:
        if step > self.stable:
            raise SceneError(
                f"a step of {step:.6g} s is beyond the stable one of this body, "
                f"{self.stable:.6g} s: take a shorter one, or scheme='newmark'"
            )

    def _prepare(self, probe: Internal) -> None:
        settings = self.settings
        self.internal: Internal = probe if self.rows == 3 else self._massless(settings.tolerance)
        self.internal.products = self.internal.inner = 0
        #: Condenses couples; the last ones and what they exert are kept.
        self.loaded = self._massless(settings.tolerance)
        self.moment = self.exerted = np.zeros(0)
        self.verlet = Verlet(self.internal, self.mass, self.step, settings.alpha, settings.beta)

    @property
    def products(self) -> int:
        return self.internal.products + self.loaded.products

    @property
    def inner(self) -> int:
        return self.internal.inner + self.loaded.inner

    def _condensed(self, time: float) -> Array:
        """Loads of the moving unknowns, those of massless rotations condensed onto them.

        Couples act through rotations that follow at once; so do supports that hold neighbours.
        Supports' velocity lags half a step like that of all others.
        """
        early, late = (time - self.step, time) if self.steps else self._around(time)
        load = self._pushed(early, late, time)
        if self.rows == len(load):
            return load
        moment = load[2]
        if not moment.any():
            return load[:2]
        if not np.array_equal(moment, self.moment):
            self.exerted, theta = self.loaded(np.zeros_like(self.mass), moment)
            self.loaded.remember(theta)
            self.moment = moment.copy()
        return np.asarray(load[:2] - self.exerted)

    def go(self, progress: Progress | None) -> None:
        """At each pass: u at the present time, v half a step before."""
        verlet, h = self.verlet, self.step
        # The velocity at the last step, where fields between the two are wanted.
        self.before = np.zeros_like(self.v)
        if self.saved is not None and self._restore(self.saved):
            return
        moving = self.fixed[: self.rows] if self.fixed.any() else None
        while True:
            load = self._condensed(self.time)
            internal, a = verlet.force(self.u, self.v, load)
            begin = self.steps == 0
            after = verlet.first(self.v, a) if begin else verlet.next(self.v, a)
            now = self.v if begin else 0.5 * (self.v + after)
            self._account(internal, load, after, begin)
            while self._pending(self.time):
                self._interpolate(float(self.settings.times[len(self.kept)]), now)
            if self.steps == self.count:
                break
            if self._pending(self.time + h):
                self.before = now.copy()
            self.v = after
            self.u = self.u + h * self.v
            if moving is not None:
                late = self.time + h if self.steps + 1 < self.count else self.settings.end
                there = self._given(late)[: self.rows][moving]
                self.v[moving] = (there - (self.u - h * self.v)[moving]) / h
                self.u[moving] = there
            self._after(progress)
        self._save(done=True)

    def _account(self, internal: Array, load: Array, after: Array, begin: bool) -> None:
        """Energy, work and dissipation up to the present time, and a row for them."""
        h, u, v, m = self.step, self.u, self.v, self.mass
        kinetic = 0.5 * float(np.vdot(m * v, v))
        there = u if begin else u - h * v
        strain = 0.5 * float(np.vdot(internal, self._free(there)))
        lagged = u + self.verlet.beta * v if self.verlet.beta else u
        stored = 0.5 * float(np.vdot(internal, self._free(lagged)))
        self._row(kinetic, strain, stored, self._momentum(v))
        if begin:
            # The balance starts at the first half step, whose energy is another one.
            return
        mean = 0.5 * (v + after)
        mean[m == 0] = 0.0
        done = h * float(np.vdot(load, mean))
        change = float(np.vdot(m * (after - v), mean)) + h * float(np.vdot(internal, mean))
        self.work += done
        self.dissipated += done - change

    def _free(self, u: Array) -> Array:
        return np.where(self.fixed[: self.rows], 0.0, u) if self.fixed.any() else u

    def _interpolate(self, time: float, now: Array) -> None:
        """Fields at a time of the last step by cubic interpolation."""
        h = self.step
        s = 1.0 - (self.time - time) / h
        if self.steps == 0 or s >= 1.0 - 1e-12:
            self._keep(time, self.u, now)
            return
        last = self.u - h * self.v
        u = (
            (2 * s**3 - 3 * s**2 + 1) * last
            + (s**3 - 2 * s**2 + s) * h * self.before
            + (3 * s**2 - 2 * s**3) * self.u
            + (s**3 - s**2) * h * now
        )
        v = (
            6 * (s**2 - s) * (last - self.u) / h
            + (3 * s**2 - 4 * s + 1) * self.before
            + (3 * s**2 - 2 * s) * now
        )
        self._keep(time, u, v)

    def _own(self) -> dict[str, Any]:
        state = {"before": self.before, "moment": self.moment, "exerted": self.exerted}
        state["turned"] = np.array(self.loaded.past)
        if isinstance(self.internal, MasslessRotations):
            state["past"] = np.array(self.internal.past)
        return state

    def _take_back(self, state: dict[str, Array], products: int, inner: int) -> None:
        self.before = state["before"]
        self.moment, self.exerted = state["moment"], state["exerted"]
        self.loaded.past = list(state["turned"])
        self.internal.products, self.internal.inner = products, inner
        if isinstance(self.internal, MasslessRotations):
            self.internal.past = list(state["past"])
