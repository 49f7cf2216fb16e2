"""A body in motion by Newmark's average acceleration: implicit steps of any length."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import Array
from .motion import Motion
from .recording import Progress
from .stepping import Internal, Newmark


class NewmarkMotion(Motion):
    """Displacement, velocity and acceleration at the step; rotations without inertia."""

    usual = 10.0

    def _admit(self, step: float) -> None:
        """Steps of any length are stable."""

    def _prepare(self, probe: Internal) -> None:
        settings = self.settings
        full = np.zeros((self.body.operator.components, len(self.body.operator.active)))
        full[:2] = self.mass
        self.newmark = Newmark(
            self.body.operator,
            self.body.stability.kind,
            full,
            self.step,
            settings.alpha,
            settings.beta,
            settings.tolerance,
        )
        self.last_load, self.last_energy = np.zeros(0), 0.0

    @property
    def products(self) -> int:
        return self.newmark.solver.iterations

    @property
    def inner(self) -> int:
        return 0

    def go(self, progress: Progress | None) -> None:
        """At each pass: u, v and a at the present time."""
        operator, newmark = self.body.operator, self.newmark
        shape = (operator.components, len(operator.active))
        u, v = np.zeros(shape), np.zeros(shape)
        m = newmark.mass
        if self.saved is None:
            u[:2], v[:2] = self.u, self.v
            if shape[0] == 3:
                u[2] = self._rotations(self.time, u[:2])
            load = self._pushed(*self._around(self.time), self.time)
            # Rotations of u + β v, which the damping with the stiffness turns too.
            lagged = np.where(self.fixed[:2], 0.0, u[:2] + newmark.beta * v[:2])
            moment = load[2] if shape[0] == 3 else None
            force, _ = self._massless(1e-12)(lagged, moment)
            a = np.zeros(shape)
            free = m[:2] > 0
            np.divide(load[:2] - force, m[:2], out=a[:2], where=free)
            a[:2] -= newmark.alpha * v[:2] * free
            self.guess = u.copy()
            self.u, self.v, self.a = u, v, a
            self._count_newmark(load, None)
            if self._pending(self.time):
                self._keep(self.time, self.u, self.v)
        elif self._restore(self.saved):
            return
        while self.steps < self.count:
            last_u, last_v, last_a = self.u, self.v, self.a
            late = self.time + self.step if self.steps + 1 < self.count else self.settings.end
            load = self._pushed(*self._around(late), late)
            self.u, self.v, self.a, self.guess = newmark.advance(
                last_u, last_v, last_a, self.guess, load, self._given(late)
            )
            previous, self.time = self.time, late
            self._count_newmark(load, (last_u, last_v))
            while self._pending(self.time):
                t = float(self.settings.times[len(self.kept)])
                s = (t - previous) / self.step
                # The average acceleration is constant in a step.
                mean = 0.5 * (last_a + self.a)
                d = s * self.step
                at = last_u + d * last_v + 0.5 * d * d * mean
                self._keep(t, self.u if s > 1 - 1e-12 else at, last_v + d * mean)
            self._after(progress)
        self._save(done=True)

    def _count_newmark(self, load: Array, last: tuple[Array, Array] | None) -> None:
        """Energies at the step, and work and dissipation over it by the mean of both ends."""
        operator, m = self.body.operator, self.newmark.mass
        force = operator.product(np.where(self.fixed, 0.0, self.u), masked=True)
        free = np.where(self.fixed, 0.0, self.u)
        kinetic = 0.5 * float(np.vdot(m * self.v, self.v))
        strain = 0.5 * float(np.vdot(force, free))
        if last is not None:
            change = free - np.where(self.fixed, 0.0, last[0])
            done = 0.5 * float(np.vdot(load + self.last_load, change))
            self.work += done
            self.dissipated += done - (kinetic + strain - self.last_energy)
            if not (self.newmark.alpha or self.newmark.beta):
                self.dissipated = 0.0
        self.last_load, self.last_energy = load, kinetic + strain
        self._row(kinetic, strain, strain, self._momentum(self.v))

    def _own(self) -> dict[str, Any]:
        return {
            "a": self.a,
            "guess": self.guess,
            "load": self.last_load,
            "energy": self.last_energy,
        }

    def _take_back(self, state: dict[str, Array], products: int, inner: int) -> None:
        self.a, self.guess, self.last_load = state["a"], state["guess"], state["load"]
        self.last_energy = float(state["energy"])
        self.newmark.solver.iterations = products
