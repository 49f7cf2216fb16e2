"""Supports: what is prescribed in a scene, and where."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from ..arrays import Mask
from ..errors import SceneError
from ..geometry import Lattice, Outline, Point, Region, Where, select
from ..material.physics import Physics
from .values import Value, at_time, in_time

# What of a support is no value.
_NO_VALUES = {"select", "rigid", "centre", "tied", "nodes", "electrode"}


@dataclass(frozen=True)
class Support:
    """Particles, or the body's very edge, on which unknowns are prescribed.

    Build one with `layer`, `where` or `edge`. Values are numbers, arrays (one row for each selected
    particle, in the lattice's order) or functions of (x, y), or of (x, y, t) where the analysis
    has a time. What is not given stays free.

    Attributes
    ----------
    select : callable
        Lattice → mask over the particles (none of them if the edge is held).
    displacement : value of two components, m, optional
    u1, u2 : values, m, optional
        One component alone (a roller); not together with `displacement`.
    rotation : value, rad, optional
        Prescribe it wherever it is known: a layer with free rotations gets them wrong, because
        its families are cut by the body's edge.
    temperature : value, K, optional
    potential : value, V, optional
    rigid : bool
        The particles move as a rigid body (`pin`); what is given is the motion of its centre.
    centre : point, optional
        Of a rigid body, by default the mean of its particles.
    tied : tuple of str, optional
        Unknowns that have one common value, as yet unknown (`equal`).
    nodes : callable, optional
        Outline, its shift from the user's coordinates → mask over its nodes, of a support of the
        edge.
    electrode : Region or callable, optional
        Of a lead (`lead`), which must lie in the body and touch no other.
    """

    select: Callable[[Lattice], Mask]
    displacement: Value | None = None
    u1: Value | None = None
    u2: Value | None = None
    rotation: Value | None = None
    temperature: Value | None = None
    potential: Value | None = None
    rigid: bool = False
    centre: Point | None = None
    tied: tuple[str, ...] | None = None
    nodes: Callable[[Outline, Point], Mask] | None = None
    electrode: Where | None = None

    def __post_init__(self) -> None:
        if self.displacement is not None and (self.u1 is not None or self.u2 is not None):
            raise SceneError("give either displacement or u1 and u2 in a support, not both")
        if self.constrains:
            return
        if not (self.given - {"rotation"}) and self.rotation is None:
            raise SceneError(
                "a support prescribes nothing: give displacement, u1, u2, rotation, temperature or "
                "potential"
            )

    @property
    def given(self) -> set[str]:
        """Names of the values that are given."""
        names = {item.name for item in fields(self)} - _NO_VALUES
        return {name for name in names if getattr(self, name) is not None}

    @property
    def timed(self) -> bool:
        """Whether a value depends on time."""
        return any(in_time(getattr(self, name)) for name in self.given)

    def at(self, time: float) -> Support:
        """The support at one time, s."""
        now: dict[str, Any] = {n: at_time(getattr(self, n), time) for n in self.given}
        return replace(self, **now)

    @property
    def constrains(self) -> bool:
        """Whether it relates unknowns to each other instead of prescribing their values."""
        return self.rigid or self.tied is not None

    @classmethod
    def pin(cls, where: Where, centre: Point | None = None, **motion: Any) -> Support:
        """Particles that move as one rigid body, such as a loading pin or the rim that it bears on.

        Its displacement (or u1, u2, of the centre) and rotation are prescribed where they are
        given, and free where they are not: a pin without a rotation turns as the body wants it
        to. Loads on its particles act on it. `solver.reactions.reaction` reads off its force and
        moment.

        Parameters
        ----------
        where : Region or callable
        centre : point, optional
            By default the mean of the particles.
        **motion
            displacement, u1, u2, rotation: numbers.
        """
        return cls(lambda lattice: select(lattice, where), rigid=True, centre=centre, **motion)

    @classmethod
    def equal(cls, where: Where, *unknowns: str) -> Support:
        """Particles on which some unknowns have one common value that nobody prescribes.

        Such as ``Support.equal(top, "u2")``: an edge that stays straight and level under a load.

        Parameters
        ----------
        where : Region or callable
        *unknowns : str
            Names as in a support: "u1", "u2", "rotation", "temperature", "potential".
        """
        if not unknowns:
            raise SceneError("name what is equal: u1, u2, rotation, temperature or potential")
        return cls(lambda lattice: select(lattice, where), tied=unknowns)

    @classmethod
    def layer(cls, cells: float, **values: Any) -> Support:
        """Particles nearer than `cells` spacings to the body's edge.

        Raises
        ------
        SceneError
            If `cells` is not positive.
        """
        if not cells > 0:
            raise SceneError(f"a layer needs a positive thickness in cells, not {cells}")
        # Centres at exactly that depth belong to it whatever the rounding.
        return cls(
            lambda lattice: lattice.edge_distance <= cells * lattice.spacing * (1 + 1e-9), **values
        )

    @classmethod
    def where(cls, where: Where, **values: Any) -> Support:
        """Particles in a region, or those for which ``where(x, y)`` is true."""
        return cls(lambda lattice: select(lattice, where), **values)

    @classmethod
    def edge(cls, where: Where | None = None, **values: Any) -> Support:
        """The surface itself: nodes of outer edges and holes, those in `where` if it is given.

        The body is held exactly where it ends, which a layer of particles does only to first
        order. Needs nodes to hold: ``surface="extrapolated"``. Faces of cracks stay free.
        """

        def nodes(outline: Outline, shift: Point) -> Mask:
            chosen = np.zeros(len(outline.nodes), dtype=bool)
            chosen[outline.edges[outline.face == 0]] = True
            x, y = (outline.nodes + shift).T
            if isinstance(where, Region):
                chosen &= where.contains(x, y)
            elif where is not None:
                chosen &= np.asarray(where(x, y), dtype=bool)
            return chosen

        return cls(lambda lattice: np.zeros(lattice.count, dtype=bool), nodes=nodes, **values)

    @classmethod
    def lead(cls, where: Where, potential: Value | None = None) -> Support:
        """A lead: a small region of the body on metal, at one potential.

        Parameters
        ----------
        where : Region or callable
        potential : value, V, optional
            Without it the lead floats at the potential that the current of a `Load.lead` on the
            same region drives it to.
        """
        if potential is None:
            return replace(cls.equal(where, "potential"), electrode=where)
        return replace(cls.where(where, potential=potential), electrode=where)

    def columns(self, physics: Physics) -> list[tuple[int, Value, int, int]]:
        """(unknown, value, component of it, components it has) of everything prescribed.

        Raises
        ------
        SceneError
            If something is prescribed that the physics does not know.
        """
        known = physics.supports
        if wrong := self.given - set(known):
            raise SceneError(
                f"{physics.adjective} scene has no {', '.join(sorted(wrong))} to prescribe"
            )
        found = []
        for name in known:
            value = getattr(self, name)
            if value is not None:
                width = len(known[name])
                found += [(unknown, value, k, width) for k, unknown in enumerate(known[name])]
        return found
