"""What drives a body in time: supports and loads as functions of t.

Geometry (who is held, where a load acts) is found once; values are evaluated anew at every time
that is asked for, and only those that depend on it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import Array
from ..errors import SceneError
from ..geometry import Outline
from . import loading
from .description import Description
from .discretisation import Discretisation

_REMEMBERED = 4


class Forcing:
    """Prescribed values and right-hand sides of a discretised scene at any time.

    Parameters
    ----------
    body : Discretisation
        Of ``scene.at(t)`` for some t.
    scene : Description
        The scene with its functions of time.
    """

    def __init__(self, body: Discretisation, scene: Description) -> None:
        self.body, self.scene = body, scene
        self.moving = any(support.timed for support in scene.supports)
        self.driven = any(load.timed for load in scene.loads)
        #: Whether nodes of the surface are held at values that depend on time.
        self.edge_moves = any(s.timed for s in scene.supports if s.nodes is not None)
        self._outline: Outline | None = None
        near = body.lattice.centred
        self._cracks = loading.centred_cracks(scene.cracks, body.lattice)
        if self.driven and any(load.edge is not None for load in scene.loads):
            ended = body.bonds.ended
            tips = scene.broken is None
            self._outline = (
                ended.outline
                if ended is not None
                else Outline.of(near.region, self._cracks, near.spacing, tips)
            )
        self._time: float | None = None
        self._now = body
        #: Right-hand sides of the last few times: a step asks for both its ends.
        self._known: dict[float, Array] = {}
        self._coupling: Array | None = None

    @property
    def constant(self) -> bool:
        """Whether nothing depends on time."""
        return not (self.moving or self.driven)

    def at(self, time: float) -> Discretisation:
        """The body with supports and loads as they are at one time, s."""
        if self.constant or time == self._time:
            return self._now
        body, scene = self.body, self.scene.at(time)
        values, load, nodal = body.values, body.load, body.nodal_load
        edge = self._edge_values(scene)
        if self.moving:
            _, found = loading.prescribed_values(scene, body.lattice, body.moduli)
            values = np.where(np.isnan(body.values), np.nan, found)
        if self.driven:
            load = loading.body_loads(scene, body.lattice, body.moduli, body.bonds.phases)
            rules = (
                []
                if self._outline is None
                else loading.on_outline(scene, self._outline, body.lattice)
            )
            nodal = loading.share_out(rules, body.lattice, body.operator, load)
            loading.concentrate(scene, body.lattice, self._cracks, body.operator, load, nodal)
            if load[:, np.isnan(values).any(axis=0)].any():
                raise SceneError(
                    f"at t = {time:g} s a load acts on a part that was set aside: hold it, or "
                    f"leave it out of the load (where=...)"
                )
        self._now = replace(body, values=values, load=load, nodal_load=nodal, edge_values=edge)
        self._time = time
        return self._now

    def _edge_values(self, scene: Description) -> Array | None:
        """Values of held nodes as they are in a scene of one time, if they depend on time."""
        ended = self.body.bonds.ended
        if not self.edge_moves or ended is None:
            return None
        return loading.edge_values(
            scene, ended.outline, self.body.lattice.centred, self.body.moduli
        )[1]

    def values(self, time: float) -> Array:
        """Prescribed values, shape (components, N); zero where free, NaN where set aside."""
        return self.at(time).values

    def right_hand_side(self, time: float) -> Array:
        """See `Discretisation.right_hand_side`; shape (components·active,)."""
        key = 0.0 if self.constant else time
        if key not in self._known:
            if len(self._known) >= _REMEMBERED:
                del self._known[next(iter(self._known))]
            self._known[key] = self._evaluate(time)
        return self._known[key]

    def _evaluate(self, time: float) -> Array:
        now = self.at(time)
        if self.moving:
            return now.right_hand_side()
        if self._coupling is None:
            self._coupling = self.body.operator.coupling(self.body.values)
        return now.right_hand_side(self._coupling)

    def of_velocity(self, early: float, late: float) -> Array:
        """What prescribed values exert by their mean velocity between two times, on the left.

        Minus K_fp ġ: the part of damping β K that comes from supports which move, over β; shape
        (components·active,).
        """
        before, after = self.at(early), self.at(late)
        span, body = late - early, self.body
        still, edge = None, None
        if (ended := body.bonds.ended) is not None:
            still = np.zeros((body.moduli.components, len(ended.outline.nodes)))
            if before.edge_values is None or after.edge_values is None:
                edge = still if ended.held is not None else None
            else:
                edge = (after.edge_values - before.edge_values) / span
        moved = replace(
            body,
            values=np.nan_to_num(after.values - before.values) / span,
            load=np.zeros_like(body.load),
            nodal_load=still,
            edge_values=edge,
        )
        return moved.right_hand_side()

    def check(self, times: Array) -> None:
        """Evaluate everything at some times: wrong shapes and values come before any work."""
        for time in times:
            self.at(float(time))
