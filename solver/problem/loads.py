"""Loads: what acts on a body, in it, at its edges, and by its temperature."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, Mask
from ..errors import SceneError
from ..geometry import Lattice, Outline, Phases, Point, Quadrature, Region, Where, select, volumes
from ..magnitude import VALUES, outside
from ..material import ExpansionTensor
from .values import Value, at_time, evaluate, in_time

# Points of a line load in every cell.
_PER_CELL = 4


def particle_volumes(
    lattice: Lattice, true_edges: bool, phases: Phases | None = None, within: Region | None = None
) -> Array:
    """Area of the body that each particle stands for, shape (N,), cells; remembered.

    Parameters
    ----------
    lattice : Lattice
    true_edges : bool
        Whether the body ends where it is drawn (``extrapolated``), and not with its outermost
        cells.
    phases : Phases, optional
        Of a body of several. Interfaces are where they are drawn with every treatment: a cell
        that one cuts is shared out between its sides.
    within : Region, optional
        Count only what lies in it, where edges are as drawn.
    """
    if not true_edges and phases is None:
        return np.ones(lattice.count)
    key = f"volumes {true_edges}", id(within)
    if key not in lattice.known:
        if phases is None:
            found = volumes(lattice, within)
        else:
            found = np.zeros(lattice.count)
            for k, part in enumerate(phases.lattices):
                found[phases.of == k] = volumes(part, within)
            if not true_edges:
                # What passes over interfaces, of bodies whose edges are as drawn.
                found += 1.0 - volumes(lattice)
        lattice.known[key] = within, found
    known: Array = lattice.known[key][1]
    return known


@dataclass(frozen=True)
class Load:
    """Something that acts on the body, per unit volume or on its edges.

    Attributes
    ----------
    kind : {"force", "couple", "temperature", "source", "current", "traction", "inflow"}
        Body force (N/m³, two components), body couple (N m/m³), source of heat (W/m³) or current
        (A/m³); on edges traction (Pa, two components) and inflow of heat (W/m²) or current (A/m²).
    density : callable, optional
        Of a load in the body: lattice, whether its edge is where it is drawn, its phases if it has
        several → (mask, what acts on each particle over its cell, shape (selected, components)).
    edge : callable, optional
        Of a load on edges: outline, its shift from the user's coordinates, the lattice's `grid` →
        quadrature.
    points : callable, optional
        Of a concentrated load: spacing → (places, what acts at each, (k, components)).
    instant : callable, optional
        Of a load that depends on time: time (s) → the load then.
    electrode : Region or callable, optional
        Of a lead (`lead`), which must lie in the body and touch no other.
    strain : callable, optional
        Of a temperature: places, whether they are the surface's nodes, another solid's expansion
        → the strain (ε11, ε22, 2 ε12) that it would cause without stress, (n, 3).
    """

    kind: str
    density: Callable[[Lattice, bool, Phases | None], tuple[Mask, Array]] | None = None
    edge: Callable[[Outline, Point, float], Quadrature] | None = None
    points: Callable[[float], tuple[Array, Array]] | None = None
    electrode: Where | None = None
    strain: Callable[..., Array] | None = None
    instant: Callable[[float], Load] | None = None

    @property
    def timed(self) -> bool:
        """Whether the load depends on time."""
        return self.instant is not None

    def at(self, time: float) -> Load:
        """The load at one time, s."""
        return self if self.instant is None else self.instant(time)

    @classmethod
    def _of(
        cls,
        kind: str,
        value: Value,
        density: Callable[[Value, Lattice, bool, Phases | None], tuple[Mask, Array]] | None = None,
        edge: Callable[[Value, Outline, Point, float], Quadrature] | None = None,
        points: Callable[[Value, float], tuple[Array, Array]] | None = None,
    ) -> Load:
        """A load whose value may depend on time."""

        def fixed(value: Value) -> Load:
            return cls(
                kind,
                None if density is None else partial(density, value),
                None if edge is None else partial(edge, value),
                None if points is None else partial(points, value),
            )

        if in_time(value):
            return replace(fixed(value), instant=lambda time: fixed(at_time(value, time)))
        return fixed(value)

    @classmethod
    def _body(cls, kind: str, value: Value, components: int, where: Where | None) -> Load:
        def density(
            value: Value, lattice: Lattice, true_edges: bool, phases: Phases | None = None
        ) -> tuple[Mask, Array]:
            everywhere = np.ones(lattice.count, dtype=bool)
            mask = everywhere if where is None else select(lattice, where)
            # One value a particle goes with the particles that the region holds.
            listed = not callable(value) and np.ndim(value) >= min(components, 2)
            if true_edges and isinstance(where, Region) and not listed:
                volume = particle_volumes(lattice, True, phases, where)
                mask = volume > 0
            else:
                volume = particle_volumes(lattice, true_edges, phases)
            if not mask.any():
                raise SceneError(f"a {kind} acts on no particle")
            acting = evaluate(value, lattice.places[mask], components, f"a body {kind}")
            return mask, acting * volume[mask, None]

        return cls._of(kind, value, density)

    @classmethod
    def body_force(cls, force: Value, where: Where | None = None) -> Load:
        """Body force (b1, b2), N/m³, as a pair, an (n, 2) array or a function of (x, y).

        With ``extrapolated`` surfaces, where edges lie as drawn, all loads in the body act on its
        area (`solver.geometry.strips`): a constant one adds up to density × area, whether or not
        the body, or the region `where`, is a whole number of cells; each inclusion carries what
        acts on its own area, with its own thickness. Treatments that let the body end at its
        outermost cells load whole cells, but for those that an interface cuts.
        """
        return cls._body("force", force, 2, where)

    @classmethod
    def couple(cls, couple: Value, where: Where | None = None) -> Load:
        """Body couple c, N m/m³."""
        return cls._body("couple", couple, 1, where)

    @classmethod
    def temperature(
        cls, change: Value, expansion: ExpansionTensor, at_surface: Value | None = None
    ) -> Load:
        """A change of temperature, K, that strains the body by ε = A T without stress.

        The stress of a solution, and its energy, are those of what the displacement strains it
        beyond that. Several add up.

        Parameters
        ----------
        change : value
        expansion : ExpansionTensor
            Of the scene's own solid (inclusions bring theirs); in plane strain the plane's
            effective one.
        at_surface : value, optional
            The change at the surface's nodes where `change` is one value a particle and bonds end
            at the surface (``extrapolated``): `State.surface_temperature` of the conduction
            problem on the same body.
        """
        if not isinstance(expansion, ExpansionTensor):
            raise SceneError(
                f"a temperature needs the solid's ExpansionTensor, not {type(expansion).__name__}"
            )

        def strain(places: Array, surface: bool, other: ExpansionTensor | None = None) -> Array:
            value = change if not surface or at_surface is None else at_surface
            if surface and not callable(value) and np.ndim(value) and at_surface is None:
                raise SceneError(
                    "a temperature of one value a particle says nothing of the surface, where "
                    "bonds end: give at_surface, or a function of (x, y)"
                )
            own = expansion if other is None else other
            return evaluate(value, places, 1, "a temperature") * own.voigt

        if in_time(change) or in_time(at_surface):
            raise SceneError("a temperature that strains a body is known to statics only: f(x, y)")
        return cls("temperature", strain=strain)

    def warming(self, places: Array) -> Array:
        """Change of temperature at particles, K, shape (n,), by their places (n, 2)."""
        if self.strain is None:
            return np.zeros(len(places))
        # A solid that expands by 1 a kelvin is strained by the temperature itself.
        return np.asarray(self.strain(places, False, ExpansionTensor.isotropic(1.0))[:, 0])

    @classmethod
    def source(cls, source: Value, where: Where | None = None) -> Load:
        """Heat source ω, W/m³ (in electrical conduction `current` says the same)."""
        return cls._body("source", source, 1, where)

    @classmethod
    def current(cls, density: Value, where: Where | None = None) -> Load:
        """Current fed into the body, A/m³."""
        return cls._body("current", density, 1, where)

    @classmethod
    def lead(cls, current: float, where: Where) -> Load:
        """A lead that feeds in a current, A per m of thickness, evenly over a small region.

        What enters adds up to `current` whether or not the region is a whole number of cells.
        With `Support.lead` on the same region it spreads as metal lets it.

        Raises
        ------
        SceneError
            If the current is not a finite number.
        """
        if not np.isfinite(current):
            raise SceneError(f"a lead's current must be a finite number, not {current}")
        if wrong := outside(abs(current), VALUES):
            raise SceneError(f"a lead's current is {wrong}")
        even = cls._body("current", 1.0, 1, where).density
        assert even is not None

        def density(
            lattice: Lattice, true_edges: bool, phases: Phases | None = None
        ) -> tuple[Mask, Array]:
            mask, volume = even(lattice, true_edges, phases)
            return mask, volume * (current / (volume.sum() * lattice.spacing**2))

        return cls("current", density, electrode=where)

    @classmethod
    def point(cls, force: ArrayLike, at: Point) -> Load:
        """A force (f1, f2), N per m of thickness, or a source, W or A per m, at a point.

        On an edge of the body (``extrapolated``) its nodes carry it, elsewhere the particles
        around it, resultant and moment being exact (`solver.geometry.spread`). What it does at
        the point itself grows without bound as the spacing falls: read displacements some cells
        away.
        """
        given = np.asarray(force, dtype=np.float64)
        if given.shape not in ((), (2,)) or np.shape(at) != (2,):
            raise SceneError(
                f"a point load is a force (f1, f2) or a source at (x, y), not {force!r}"
            )
        if not (np.all(np.isfinite(given)) and np.all(np.isfinite(at))):
            raise SceneError(f"a point load that is not finite: {force!r} at {at}")
        if wrong := outside(float(np.abs(given).max()), VALUES):
            raise SceneError(f"a point load is {wrong}")
        acting = np.atleast_2d(given.reshape(-1))
        kind = "force" if given.ndim else "source"
        return cls(kind, points=lambda spacing: (np.array([at], dtype=np.float64), acting))

    @classmethod
    def line(cls, density: Value, start: Point, end: Point) -> Load:
        """A force (f1, f2) per length (Pa), or a source (W/m²), along a straight line.

        In the body or on its edge; carried as point loads are. A number or a function of (x, y)
        with one value is a source, two values are a force.
        """
        first, last = (np.asarray(point, dtype=np.float64) for point in (start, end))
        length = float(np.hypot(*(last - first))) if first.shape == last.shape == (2,) else 0.0
        if not (np.isfinite(length) and length > 0):
            raise SceneError(f"a line load runs between two points, not {start}–{end}")
        now = at_time(density, 0.0)
        sample = now(*first[:, None]) if callable(now) else now
        components = 2 if np.size(sample) == 2 else 1

        def points(density: Value, spacing: float) -> tuple[Array, Array]:
            count = int(np.ceil(_PER_CELL * length / spacing))
            share = ((np.arange(count) + 0.5) / count)[:, None]
            places = first + share * (last - first)
            return places, evaluate(density, places, components, "a line load") * (length / count)

        return cls._of("force" if components == 2 else "source", density, points=points)

    @classmethod
    def traction(cls, traction: Value, start: Point, end: Point) -> Load:
        """Traction (t1, t2), Pa, on the straight part of the body's edge from `start` to `end`."""

        def edge(traction: Value, outline: Outline, shift: Point, grid: float) -> Quadrature:
            rule = Quadrature.between(outline, np.array(start), np.array(end), shift, grid)
            if not len(rule):
                raise SceneError(f"no edge of the body runs along {start}–{end}")
            return rule.carrying(evaluate(traction, rule.places, 2, "a traction"))

        return cls._of("traction", traction, edge=edge)

    @classmethod
    def stress(cls, stress: Value, where: Where | None = None) -> Load:
        """The traction σ·n of a stress (σ11, σ22, σ12), Pa, on the body's outer edges and holes.

        Parameters
        ----------
        stress : triple, or function of (x, y) → (..., 3)
        where : Region or callable, optional
            The part of the edge that carries it; all of it by default. Faces of cracks never do.
        """

        def edge(stress: Value, outline: Outline, shift: Point, grid: float) -> Quadrature:
            rule = Quadrature.over(outline, where, shift, grid)
            s11, s22, s12 = evaluate(stress, rule.places, 3, "a stress at the edge").T
            n1, n2 = rule.normals.T
            return rule.carrying(np.column_stack([s11 * n1 + s12 * n2, s12 * n1 + s22 * n2]))

        return cls._of("traction", stress, edge=edge)

    @classmethod
    def flux(cls, flux: Value, where: Where | None = None) -> Load:
        """What a flux (q1, q2), W/m² (or A/m²), carries into the body through its edges: −q·n."""

        def edge(flux: Value, outline: Outline, shift: Point, grid: float) -> Quadrature:
            rule = Quadrature.over(outline, where, shift, grid)
            q = evaluate(flux, rule.places, 2, "a flux at the edge")
            return rule.carrying(-np.einsum("ki,ki->k", q, rule.normals)[:, None])

        return cls._of("inflow", flux, edge=edge)
