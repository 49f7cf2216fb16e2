"""A body while it moves: state, what is recorded, and how a run goes on after a kill."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..errors import NegativeCurvatureError, SceneError
from ..linear.rotations import MasslessRotations
from ..problem import Description, Discretisation, Forcing
from ..problem.rigid import parts
from ..problem.values import Value, evaluate
from ..state_file import StateFile
from .recording import Log, Progress, Series, fingerprint, nearest
from .stepping import (
    ROTATIONAL_INERTIA,
    InertRotations,
    Internal,
    Newmark,
    Verlet,
    largest_frequency,
    require_end,
    stable_step,
)

# Accuracy of the inner solves where they tell the stable step.
_ROUGH = 1e-4
# Negative strain energy beyond this share of the whole is no rounding.
_RELEASED = 1e-6
# Newmark's usual step in stable ones of Verlet's.
_LONG = 10.0


@dataclass(frozen=True)
class Settings:
    """What `solver.waves.run` was asked for, checked; see there."""

    density: float
    start: float
    end: float
    times: Array
    step: float | None
    courant: float
    scheme: str
    rotations: str
    alpha: float
    beta: float
    tolerance: float


class Motion:
    """Displacements and velocities of the active particles, from step to step.

    Parameters
    ----------
    body : Discretisation
        At the start.
    scene : Description
        With its functions of time.
    initial, velocity : values of two components
    settings : Settings
    """

    def __init__(
        self,
        body: Discretisation,
        scene: Description,
        initial: Value,
        velocity: Value,
        settings: Settings,
    ) -> None:
        self.body, self.settings = body, settings
        self.forcing = Forcing(body, scene)
        self.forcing.check(np.linspace(settings.start, settings.end, 5))
        lattice, operator = body.lattice, body.operator
        if not len(operator.active):
            raise SceneError("nothing can move: every particle is held")
        u, v = (
            evaluate(value, lattice.places, 2, what)[operator.active].T
            for value, what in (
                (initial, "the initial displacement"),
                (velocity, "the initial velocity"),
            )
        )
        inert = settings.rotations == "inertia" and operator.components == 3
        if inert and body.stability.kind == "indefinite":
            raise SceneError(
                "rotations with inertia are unstable where the shear stiffness of bonds is "
                "negative (C66 < C12): condense them"
            )
        self.rows = 3 if inert else 2
        shares = body.storage("density")[operator.active]
        mass = np.tile(settings.density * shares, (self.rows, 1))
        mass[2:] *= ROTATIONAL_INERTIA
        self.fixed = np.zeros((operator.components, len(operator.active)), dtype=bool)
        if operator.identity_rows is not None:
            self.fixed = operator.identity_rows
        mass[self.fixed[: self.rows]] = 0.0
        self.mass = mass
        self.arms = lattice.points[operator.active].T
        _, self.labels = np.unique(parts(body.bonds)[1][operator.active], return_inverse=True)
        self.u, self.v = np.zeros_like(mass), np.zeros_like(mass)
        self.u[:2], self.v[:2] = u, v
        if inert:
            # Rotations begin in equilibrium with the displacements.
            still = self._massless(1e-12)
            for field in (self.u, self.v):
                theta = still(np.where(self.fixed[:2], 0.0, field[:2]))[1]
                assert theta is not None
                field[2] = theta
        self.time, self.steps = settings.start, 0
        self._place_prescribed()
        self._choose_step()
        self.work = self.dissipated = 0.0
        self.kept: list[Array] = []
        self.largest = 0.0
        self.last_load, self.last_energy = np.zeros(0), 0.0

    def _massless(self, tolerance: float) -> MasslessRotations:
        operator, kind = self.body.operator, self.body.stability.kind
        return MasslessRotations(operator, kind, tolerance, self.labels)

    def _choose_step(self) -> None:
        """The stable step of this body, and the one that is taken."""
        settings = self.settings
        inverse = np.divide(1.0, self.mass, out=np.zeros_like(self.mass), where=self.mass > 0)
        probe: Internal = (
            InertRotations(self.body.operator) if self.rows == 3 else self._massless(_ROUGH)
        )
        frequency = largest_frequency(probe, inverse)
        if not (np.isfinite(frequency) and frequency > 0):
            raise SceneError("nothing can move: every particle is held")
        self.stable = stable_step(frequency, settings.alpha, settings.beta)
        verlet = settings.scheme == "verlet"
        step = settings.step
        if step is None:
            step = settings.courant * self.stable * (1.0 if verlet else _LONG)
        elif verlet and step > self.stable:
            raise SceneError(
                f"a step of {step:.6g} s is beyond the stable one of this body, "
                f"{self.stable:.6g} s: take a shorter one, or scheme='newmark'"
            )
        whole = settings.end - settings.start
        require_end(whole, step)
        self.count = max(1, int(np.ceil(whole / step * (1 - 1e-9))))
        self.step = whole / self.count
        if verlet:
            self.internal: Internal = (
                probe if self.rows == 3 else self._massless(settings.tolerance)
            )
            self.internal.products = self.internal.inner = 0
            #: Condenses couples; the last ones and what they exert are kept.
            self.loaded = self._massless(settings.tolerance)
            self.moment = self.exerted = np.zeros(0)
            self.verlet = Verlet(self.internal, self.mass, self.step, settings.alpha, settings.beta)
        else:
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

    @property
    def products(self) -> int:
        """Products with the whole operator so far (Newmark: iterations)."""
        if self.settings.scheme == "newmark":
            return self.newmark.solver.iterations
        return self.internal.products + self.loaded.products

    @property
    def inner(self) -> int:
        """Products with the rotation block so far."""
        return 0 if self.settings.scheme == "newmark" else self.internal.inner + self.loaded.inner

    # ---- forces -------------------------------------------------------------------------

    def _load(self, time: float) -> Array:
        """Right-hand side of the active unknowns, shape (components, active)."""
        rhs = self.forcing.right_hand_side(time).reshape(self.body.operator.components, -1)
        return np.where(self.fixed, 0.0, rhs) if self.fixed.any() else rhs

    def _pushed(self, early: float, late: float, time: float) -> Array:
        """`_load`, and with damping β K what supports exert by their velocity, early to late.

        Forces are those of u + β u' throughout, of what is prescribed as of what is free.
        """
        load, beta = self._load(time), self.settings.beta
        if not (beta and self.forcing.moving):
            return load
        more = beta * self.forcing.of_velocity(early, late).reshape(load.shape)
        return load + (np.where(self.fixed, 0.0, more) if self.fixed.any() else more)

    def _around(self, time: float) -> tuple[float, float]:
        """Two times near one, none before the start, between which velocities are differences."""
        near = 1e-3 * self.step
        return max(time - near, self.settings.start), time + near

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

    def _given(self, time: float) -> Array:
        """Prescribed values of the active particles, shape (components, active)."""
        return self.forcing.values(time)[:, self.body.operator.active]

    def _place_prescribed(self) -> None:
        fixed = self.fixed[: self.rows]
        if fixed.any():
            self.u[fixed] = self._given(self.time)[: self.rows][fixed]
            self.v[fixed] = 0.0

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
                f"load at {t!r}": self.forcing.right_hand_side(float(t))
                for t in np.linspace(self.settings.start, self.settings.end, 5)
            }
            mark = fingerprint(
                self.body,
                u=self.u,
                v=self.v,
                mass=self.mass,
                times=self.settings.times,
                settings=replace(self.settings, times=np.zeros(0)),
                step=self.step,
                watched=self.watched,
                **driven,
            )
        self.file, self.every = StateFile(checkpoint, mark), every
        self.log = Log(8 + 2 * len(self.watched))
        self.saved = self.file.load()

    def _row(self, kinetic: float, strain: float, stored: float, momentum: Array) -> None:
        """A row of the ledger at the present time.

        `stored` is the strain energy of one field: it is negative only in an unstable body.
        """
        self.largest = max(self.largest, kinetic + abs(stored))
        if not np.isfinite(self.largest):
            raise NegativeCurvatureError(
                f"the motion is not finite at t = {self.time:.6g} s: the body is unstable"
            )
        if stored < -_RELEASED * self.largest:
            raise NegativeCurvatureError(
                f"at t = {self.time:.6g} s the strain energy is negative ({stored:.3g}): the body "
                f"has a motion that releases energy. Free corners have one from ν ≈ 0.44 on with "
                f"surface='extrapolated'; try another treatment or calibration='positive'"
            )
        probed = self._whole(self.u)[:2, self.watched].ravel()
        head = [self.time, kinetic, strain, self.work, self.dissipated, *momentum]
        self.log.append(np.concatenate([head, probed]))

    def _momentum(self, v: Array) -> Array:
        p = self.mass[:2] * v[:2]
        x, y = self.arms
        spin = float(x @ p[1] - y @ p[0])
        if self.rows == 3:
            # In scaled units: θ Δx with ρ/6, and moments over Δx.
            spin += float(self.mass[2] @ v[2]) * self.body.scene.spacing
        return np.array([p[0].sum(), p[1].sum(), spin])

    def _whole(self, u: Array) -> Array:
        """Rows of all particles, shape (len(u), N), prescribed ones from their supports."""
        values = self.forcing.values(self.time)[: len(u)].copy()
        values[:, self.body.operator.active] = u
        return values

    def _keep(self, time: float, u: Array, v: Array) -> None:
        """Keep the fields at one of the times; prescribed particles follow their supports."""
        body, active = self.body, self.body.operator.active
        given = self.forcing.values(time)
        speed = np.where(np.isnan(given), np.nan, 0.0)
        if self.forcing.moving:
            early, late = self._around(time)
            speed = (self.forcing.values(late) - self.forcing.values(early)) / (late - early)
        field = np.full((5, body.lattice.count), np.nan)
        field[0:2], field[2:4] = given[:2], speed[:2]
        free = ~self.fixed[:2]
        for rows, values in ((slice(0, 2), u[:2]), (slice(2, 4), v[:2])):
            part = field[rows]
            part[:, active] = np.where(free, values, part[:, active])
        if body.operator.components == 3:
            field[4] = given[2] / body.scene.spacing
            theta = u[2] if self.rows == 3 else self._rotations(time, field[0:2, active])
            field[4, active] = theta / body.scene.spacing
        self.kept.append(field)
        if self.series is not None:
            fields = {"displacement": field[:2].T, "velocity": field[2:4].T}
            if body.operator.components == 3:
                fields["rotation"] = field[4]
            count = len(self.kept)
            self.series.write(count - 1, self.settings.times[:count].tolist(), fields)

    def _rotations(self, time: float, u: Array) -> Array:
        """Rotations in equilibrium with displacements at a time, in the operator's units."""
        _, theta = self._massless(1e-10)(np.where(self.fixed[:2], 0.0, u), self._load(time)[2])
        assert theta is not None
        return np.where(self.fixed[2], self._given(time)[2], theta)

    # ---- steps --------------------------------------------------------------------------

    def go(self, progress: Progress | None) -> None:
        """Move to the end."""
        (self._go_verlet if self.settings.scheme == "verlet" else self._go_newmark)(progress)

    def _after(self, progress: Progress | None) -> None:
        self.steps += 1
        self.time = self.settings.start + self.steps * self.step
        if self.steps == self.count:
            self.time = self.settings.end
        if self.file.path is not None and self.steps % self.every == 0:
            self._save()
        if progress is not None:
            progress(self.steps / self.count)

    def _pending(self, until: float) -> bool:
        times, k = self.settings.times, len(self.kept)
        return k < len(times) and bool(times[k] <= until * (1 + 1e-14))

    def _go_verlet(self, progress: Progress | None) -> None:
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

    def _go_newmark(self, progress: Progress | None) -> None:
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

    # ---- state --------------------------------------------------------------------------

    def _save(self, done: bool = False) -> None:
        if self.file.path is None:
            return
        state = {
            "u": self.u,
            "v": self.v,
            "numbers": [self.time, self.work, self.dissipated, self.largest],
            "counts": [self.steps, self.products, self.inner, int(done)],
            "log": self.log.rows,
            "kept": np.array(self.kept).reshape(len(self.kept), 5, self.body.lattice.count),
        }
        if self.settings.scheme == "newmark":
            state |= {"a": self.a, "guess": self.guess, "load": self.last_load}
            state["energy"] = self.last_energy
        else:
            state["before"] = self.before
            state |= {"moment": self.moment, "exerted": self.exerted}
            state["turned"] = np.array(self.loaded.past)
            if isinstance(self.internal, MasslessRotations):
                state["past"] = np.array(self.internal.past)
        self.file.save(state)

    def _restore(self, state: dict[str, Array]) -> bool:
        """Go back to a saved state; whether it is that of a finished run."""
        self.u, self.v = state["u"], state["v"]
        self.time, self.work, self.dissipated, self.largest = state["numbers"].tolist()
        self.steps, products, inner, done = state["counts"].tolist()
        self.log = Log(state["log"].shape[1], state["log"])
        self.kept = list(state["kept"])
        if self.settings.scheme == "newmark":
            self.a, self.guess, self.last_load = state["a"], state["guess"], state["load"]
            self.last_energy = float(state["energy"])
            self.newmark.solver.iterations = products
            return bool(done)
        self.before = state["before"]
        self.moment, self.exerted = state["moment"], state["exerted"]
        self.loaded.past = list(state["turned"])
        self.internal.products, self.internal.inner = products, inner
        if isinstance(self.internal, MasslessRotations):
            self.internal.past = list(state["past"])
        return bool(done)
