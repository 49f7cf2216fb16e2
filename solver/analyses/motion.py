"""A body while it moves: state, what is recorded, and how a run goes on after a kill."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Any

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
    largest_frequency,
    require_end,
    stable_step,
)

# Accuracy of the inner solves where they tell the stable step.
_ROUGH = 1e-4
# Negative strain energy beyond this share of the whole is no rounding.
_RELEASED = 1e-6


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


class Motion(ABC):
    """Displacements and velocities of the active particles, from step to step.

    How they step is a subclass's: `solver.analyses.verlet_motion`, `newmark_motion`.

    Parameters
    ----------
    body : Discretisation
        At the start.
    scene : Description
        With its functions of time.
    initial, velocity : values of two components
    settings : Settings
    """

    #: The usual step in stable ones of Verlet's.
    usual = 1.0

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
        step = settings.step
        if step is None:
            step = settings.courant * self.stable * self.usual
        else:
            self._admit(step)
        whole = settings.end - settings.start
        require_end(whole, step)
        self.count = max(1, int(np.ceil(whole / step * (1 - 1e-9))))
        self.step = whole / self.count
        self._prepare(probe)

    @abstractmethod
    def _admit(self, step: float) -> None:
        """Refuse a step that is too long."""

    @abstractmethod
    def _prepare(self, probe: Internal) -> None:
        """Make what the steps need, for the step that was chosen."""

    @property
    @abstractmethod
    def products(self) -> int:
        """Products with the whole operator so far (Newmark: iterations)."""

    @property
    @abstractmethod
    def inner(self) -> int:
        """Products with the rotation block so far."""

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

    @abstractmethod
    def go(self, progress: Progress | None) -> None:
        """Move to the end."""

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
        self.file.save(state | self._own())

    def _restore(self, state: dict[str, Array]) -> bool:
        """Go back to a saved state; whether it is that of a finished run."""
        self.u, self.v = state["u"], state["v"]
        self.time, self.work, self.dissipated, self.largest = state["numbers"].tolist()
        self.steps, products, inner, done = state["counts"].tolist()
        self.log = Log(state["log"].shape[1], state["log"])
        self.kept = list(state["kept"])
        self._take_back(state, products, inner)
        return bool(done)

    @abstractmethod
    def _own(self) -> dict[str, Any]:
        """What the scheme adds to a state."""

    @abstractmethod
    def _take_back(self, state: dict[str, Array], products: int, inner: int) -> None:
        """What it needs of a saved one."""
