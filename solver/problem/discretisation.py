"""A scene as arrays and operators: shared by all analyses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from time import perf_counter

import numpy as np
from scipy.spatial import KDTree

from ..arrays import Array, Indices, Mask
from ..bonds import Bonds
from ..errors import MechanismError, SceneError
from ..geometry import (
    Body,
    Crack,
    CrackSet,
    Frame,
    Lattice,
    Outline,
    Phases,
    Quadrature,
    on_edges,
    on_particles,
    volumes,
)
from ..magnitude import STRAINS, outside
from ..material import Family, Moduli, Stability
from ..operators import BondOperator
from ..operators.eigenstrain import Eigenstrain
from . import cautions, inclusions, leads, mechanisms, thickness
from . import constraints as constraints_of
from .conditions import evaluate
from .constraints import Constraints
from .description import Description


@dataclass(frozen=True, eq=False)
class Discretisation:
    """A scene as arrays: shared by all analyses.

    Attributes
    ----------
    lattice, family, moduli, stability, bonds, operator
        The parts, see their modules. The bonds' lattice is `lattice.centred`.
    prescribed : ndarray of bool, shape (components, N)
        True for parts set aside too.
    values : ndarray, shape (components, N)
        Prescribed values (rotations times the spacing), zero where free, NaN where set aside.
    load : ndarray, shape (components, N)
        Densities of force, couple over spacing, or source, of a whole cell: what acts on the area
        that a particle stands for, over Δx².
    nodal_load : ndarray, shape (components, nodes of the outline), optional
        Loads of the surface's nodes, per volume of a particle.
    seconds : float
        Wall time that building all this took.
    constraints : Constraints, optional
        Of rigid pins and tied unknowns; slaves are among the prescribed.
    eigenstrain : Eigenstrain, optional
        Of temperatures; the loads hold what it exerts.
    acting : ndarray, shape (components, N), optional
        `load` without what temperatures exert, where there are any.
    edge_values : ndarray, shape (components, nodes of the outline), optional
        Values at which nodes are held, if others than those of the bonds: at another time.
    """

    scene: Description
    lattice: Lattice
    family: Family
    moduli: Moduli
    stability: Stability
    bonds: Bonds
    operator: BondOperator
    prescribed: Mask
    values: Array
    load: Array
    nodal_load: Array | None
    seconds: float
    constraints: Constraints | None = None
    eigenstrain: Eigenstrain | None = None
    acting: Array | None = None
    edge_values: Array | None = None

    @classmethod
    def of(
        cls,
        scene: Description,
        sharp_tips: bool = True,
        constrained: bool = False,
        free: bool = False,
    ) -> Discretisation:
        """Build it, cheap checks first.

        Parameters
        ----------
        scene : Description
        sharp_tips : bool
        constrained : bool
            Whether the caller knows rigid pins and tied unknowns. Slaves are among the
            `prescribed`: who does not ask for `constraints` would take them for clamped. Nor
            do others know that temperatures strain bonds.
        free : bool
            Whether parts that no support holds are no fault: bodies may move in time.

        Raises
        ------
        SceneError
            If the scene has constraints and the caller does not know them.
        """
        begun = perf_counter()
        family = scene.family()
        each, stability = inclusions.solids(scene, family)
        if not constrained and any(support.constrains for support in scene.supports):
            raise SceneError(
                "rigid pins and equal unknowns (Support.pin, Support.equal) are known to statics "
                "and fracture only: prescribe displacements instead"
            )
        if not constrained and any(load.strain is not None for load in scene.loads):
            raise SceneError(
                "temperatures that strain a body (Load.temperature) are known to statics and "
                "quasi-static fracture only"
            )
        lattice = Lattice(scene.region, scene.spacing, family.reach, scene.phase)
        cracks = _moved(scene.cracks, lattice)
        phases = inclusions.phases_of(scene, lattice)
        moduli = inclusions.mixed(each, phases)
        prescribed, values = _supports(scene, lattice, moduli)
        leads.check(scene, lattice, prescribed)
        relating = [support for support in scene.supports if support.constrains]
        constraints = constraints_of.build(relating, lattice, moduli, prescribed, values)
        load = _loads(scene, lattice, moduli, phases)
        sharp_tips = sharp_tips and scene.broken is None
        on_edges = edge_loads(scene, lattice, sharp_tips, phases)
        # Loads act on the nodes at which bonds end: one outline serves both.
        outline = on_edges[0].outline if on_edges else None
        broken = scene.broken(lattice, family) if scene.broken else None
        held = _held(scene, prescribed)
        aside = np.zeros(lattice.count, dtype=bool)
        while True:
            bonds = Bonds(
                lattice.centred,
                family,
                cracks,
                scene.surface,
                held,
                broken,
                sharp_tips,
                outline,
                phases,
            )
            if bonds.ended is not None:
                outline = bonds.ended.outline
            bonds = leads.rimmed(scene, bonds, moduli)
            if scene.factors is not None:
                bonds = bonds.scaled(scene.factors(bonds, moduli))
            if (thick := thickness.factors(scene, lattice, bonds)) is not None:
                bonds = bonds.scaled(thick)
            _hold_edges(scene, bonds, moduli)
            operator = BondOperator(bonds, moduli, prescribed)
            loose, why = mechanisms.find(
                bonds,
                operator,
                prescribed,
                broken is not None,
                stability.kind != "indefinite",
                constraints,
                free,
            )
            if not len(loose):
                break
            if (
                scene.loose == "refuse"
                or prescribed.all(axis=0).sum() + len(loose) == lattice.count
            ):
                raise mechanisms.refuse(why)
            if load[:, loose].any():
                raise MechanismError(
                    f"a load acts on a part that nothing holds: {why}. Hold it, or leave it out "
                    f"of the load (where=...)"
                )
            aside[loose] = True
            prescribed[:, loose] = True
            values[:, loose] = np.nan
            broken = mechanisms.without(bonds, broken, loose)
        nodal_load = _share_out(on_edges, lattice, operator, load)
        _concentrate(scene, lattice, cracks, operator, load, nodal_load)
        if load[:, aside].any():
            raise MechanismError(
                "a load on an edge acts on a part that nothing holds: hold it, or leave it out of "
                "the load (where=...)"
            )
        acting = load.copy() if any(item.strain is not None for item in scene.loads) else None
        eigenstrain = _eigenstrain(scene, lattice, operator, load, nodal_load)
        _within_range(operator, values, load, nodal_load)
        seconds = perf_counter() - begun
        return cls(
            scene,
            lattice,
            family,
            moduli,
            stability,
            bonds,
            operator,
            prescribed,
            values,
            load,
            nodal_load,
            seconds,
            constraints,
            eigenstrain,
            acting,
        )

    @property
    def held(self) -> Mask:
        """Particles whose place (or temperature) is prescribed, or which were set aside, (N,)."""
        return _held(self.scene, self.prescribed)

    @cached_property
    def volumes(self) -> Array:
        """Area of the body that each particle stands for, shape (N,), cells (Δx²).

        Loads in the body, and its mass, act on it. With ``extrapolated`` surfaces the sum is the
        area of the body (`solver.geometry.strips`); the other treatments let the body end at its
        outermost cells, and every particle is a whole one.
        """
        if self.scene.surface != "extrapolated":
            return np.ones(self.lattice.count)
        if self.bonds.phases is None:
            return volumes(self.lattice)
        found = np.zeros(self.lattice.count)
        for k, part in enumerate(self.bonds.phases.lattices):
            found[self.bonds.phases.of == k] = volumes(part)
        return found

    def storage(self, name: str) -> Array:
        """`volumes` times thickness and density (or heat capacity) over the scene's own, (N,).

        Parameters
        ----------
        name : {"density", "heat_capacity"}
        """
        found = self.volumes if self.thickness is None else self.volumes * self.thickness
        if self.bonds.phases is None:
            return found
        shares = inclusions.shares(self.scene, name)
        return np.asarray(found * shares[self.bonds.phases.of])

    @property
    def thickness(self) -> Array | None:
        """Thickness of every particle, shape (N,), m; None where all is per unit thickness."""
        if not thickness.varies(self.scene):
            return None
        return thickness.of_particles(self.scene, self.lattice)

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """What the answer leaves out or settles by a rule, one sentence each."""
        scene, lattice = self.scene, self.lattice
        translations = ~np.array(scene.physics.turning[: len(self.prescribed)])
        given = (self.prescribed & ~np.isnan(self.values))[translations].any(axis=0)
        return cautions.told(
            (
                *self.bonds.warnings,
                *cautions.left_over(lattice, scene.surface),
                *cautions.on_edges(self.bonds),
                *cautions.thin_layers(lattice, given, scene.m),
                *cautions.thin_members(lattice, scene.m, scene.surface),
            )
        )

    def overlaps(self, unknowns: Array) -> tuple[str, ...]:
        """Cracks whose faces a field of shape (components, N) moves into each other."""
        if not (self.scene.physics.breakable and self.scene.cracks):
            return ()
        cracks = _moved(self.scene.cracks, self.lattice)
        return cautions.told(cautions.overlaps(self.bonds, cracks, unknowns[:2]))

    @property
    def damaged(self) -> bool:
        """Whether single bonds are broken (cracks that were always there do not count)."""
        return self.scene.broken is not None

    def right_hand_side(self, coupling: Array | None = None) -> Array:
        """Load of the active unknowns less what the prescribed ones exert, flattened.

        `coupling` is what those exert, shape (components, active), where it is known.
        """
        operator = self.operator
        exerted = operator.coupling(self.values) if coupling is None else coupling
        rhs = self.load[:, operator.active] - exerted
        if operator.ended_stiffness is not None and self.nodal_load is not None:
            condensed = operator.ended_stiffness.condensed_load(self.nodal_load, self.edge_values)
            operator.add_at_surface(rhs, -condensed)
        if operator.identity_rows is not None:
            given = self.values[:, operator.active]
            rhs[operator.identity_rows] = operator.identity_scale * given[operator.identity_rows]
        return rhs.ravel()

    def moved(self, masters: Array) -> Discretisation:
        """The same with the free masters of its constraints known: values like any others."""
        if self.constraints is None:
            return self
        return replace(self, values=self.values + self.constraints.field(masters))

    def surface_values(self, unknowns: Array) -> Array | None:
        """Values of the surface's nodes for a field of shape (components, N), if it has nodes."""
        surface = self.operator.ended_stiffness
        if surface is None:
            return None
        near = np.nan_to_num(unknowns[:, surface.particles])
        return surface.nodal(near, self.nodal_load, self.edge_values)

    def field(self, x: Array) -> Array:
        """Values of all unknowns, shape (components, N), from a vector of the active ones."""
        values = self.values.copy()
        values[:, self.operator.active] = x.reshape(self.operator.components, -1)
        values[self.prescribed] = self.values[self.prescribed]
        return values


def _supports(scene: Description, lattice: Lattice, moduli: Moduli) -> tuple[Mask, Array]:
    prescribed = np.zeros((moduli.components, lattice.count), dtype=bool)
    values = np.zeros((moduli.components, lattice.count))
    scales = moduli.scales(scene.spacing)
    for support in scene.supports:
        if support.constrains or support.nodes is not None:
            continue
        columns = support.columns(scene.physics)
        selected = support.select(lattice)
        if not selected.any():
            raise SceneError("a support holds no particle: its layer or region is empty")
        evaluated: dict[tuple[int, int], Array] = {}
        for unknown, value, component, width in columns:
            if unknown >= moduli.components:
                # No bond resists it, it is no unknown; prescribing it is moot.
                continue
            key = id(value), width
            if key not in evaluated:
                what = "a prescribed value"
                evaluated[key] = evaluate(value, lattice.places[selected], width, what)
            prescribed[unknown, selected] = True
            values[unknown, selected] = scales[unknown] * evaluated[key][:, component]
    return prescribed, values


def _hold_edges(scene: Description, bonds: Bonds, moduli: Moduli) -> None:
    """Prescribe the nodes of the outline that supports of the edge hold, in `bonds`."""
    if all(support.nodes is None for support in scene.supports):
        return
    if scene.surface != "extrapolated":
        raise SceneError(
            f"the body's edge has no nodes to hold with surface={scene.surface!r}: use "
            f"surface='extrapolated', or hold a layer of particles"
        )
    if bonds.ended is None:
        raise SceneError("a support of the edge holds nothing: no bond ends at the body's edge")
    bonds.ended = bonds.ended.holding(
        *edge_values(scene, bonds.ended.outline, bonds.lattice, moduli)
    )


def edge_values(
    scene: Description, outline: Outline, lattice: Lattice, moduli: Moduli
) -> tuple[Mask, Array]:
    """Components of the outline's nodes that are held, and at what, both (components, nodes)."""
    shift = lattice.shift
    held = np.zeros((moduli.components, len(outline.nodes)), dtype=bool)
    given, scales = np.zeros(held.shape), moduli.scales(scene.spacing)
    for support in scene.supports:
        if support.nodes is None:
            continue
        chosen = support.nodes(outline, shift)
        if not chosen.any():
            raise SceneError("a support of the edge holds no node: its region misses the edge")
        for unknown, value, component, width in support.columns(scene.physics):
            if unknown >= moduli.components:
                continue
            places = outline.nodes[chosen] + shift
            found = evaluate(value, places, width, "a prescribed value")
            held[unknown, chosen] = True
            given[unknown, chosen] = scales[unknown] * found[:, component]
    return held, given


def _within_range(
    operator: BondOperator, values: Array, load: Array, nodal_load: Array | None
) -> None:
    """Refuse loads and prescribed values whose squares are no numbers any more."""
    spacing = operator.bonds.family.spacing
    stiffness = float(np.abs(operator.bulk_blocks).max())
    for what, array, unit in (
        ("what is prescribed", values, spacing),
        ("the load", load, stiffness * spacing),
        ("the load on the edge", nodal_load, stiffness * spacing),
    ):
        if array is None:
            continue
        largest = float(np.nanmax(np.abs(array), initial=0.0))
        if wrong := outside(largest / unit, STRAINS):
            raise SceneError(f"{what} strains cells by amounts {wrong}")


def _loads(scene: Description, lattice: Lattice, moduli: Moduli, phases: Phases | None) -> Array:
    load = np.zeros((moduli.components, lattice.count))
    scales, physics = moduli.scales(scene.spacing), scene.physics
    for item in scene.loads:
        if item.density is None:
            continue
        mask, density = item.density(lattice, scene.surface == "extrapolated", phases)
        density = thickness.scaled(density, scene, lattice, np.nonzero(mask)[0])
        for column, unknown in enumerate(physics.loads[item.kind]):
            if unknown >= moduli.components:
                raise SceneError(f"a body {item.kind} {physics.missing[unknown]}")
            load[unknown, mask] += density[:, column] / scales[unknown]
    return load


def _held(scene: Description, prescribed: Mask) -> Mask:
    """Particles that are held, shape (N,): a matter of displacement (or temperature) alone.

    Whether its particles may turn or not, a clamp is no free surface.
    """
    turning = np.array(scene.physics.turning[: len(prescribed)])
    return np.asarray(prescribed[~turning].all(axis=0))


def _moved(cracks: Sequence[Crack], lattice: Lattice) -> list[Crack]:
    """Cracks in the coordinates of the centred lattice."""
    x, y = lattice.centred.shift
    return [
        crack if (x, y) == (0.0, 0.0) else crack.moved((-x, -y), lattice.grid) for crack in cracks
    ]


def edge_loads(
    scene: Description, lattice: Lattice, sharp_tips: bool = True, phases: Phases | None = None
) -> list[Quadrature]:
    """Loads on the body's edges, evaluated, in the order of the scene's loads."""
    edges = [item.edge for item in scene.loads if item.edge is not None]
    if not edges:
        return []
    near = lattice.centred
    moved = _moved(scene.cracks, lattice)
    if phases is not None:
        outline = phases.outline(moved, sharp_tips)
    else:
        cracks = CrackSet.joined(Frame.of(near), moved, Body.of(near))
        outline = Outline.of(near.region, cracks, near.spacing, sharp_tips)
    return [thickness.loaded(scene, edge(outline, near.shift)) for edge in edges]


def _share_out(
    on_edges: list[Quadrature], lattice: Lattice, operator: BondOperator, load: Array
) -> Array | None:
    """Give loads on edges to the surface's nodes, or to the nearest particles (into `load`).

    Returns the loads of the outline's nodes, (components, nodes), None if no bond ends at them.
    """
    surface = operator.ended_stiffness
    nodal = None
    if surface is not None:
        nodal = np.zeros((load.shape[0], len(surface.ended.outline.nodes)))
    for rule in on_edges:
        force = rule.force.T / lattice.spacing**2
        ends = rule.outline.edges[rule.edge].T
        share = np.stack([1 - rule.position, rule.position])
        known = np.zeros(len(rule.outline.nodes), dtype=bool)
        if surface is not None:
            known[surface.nodes] = True
        felt = known[ends].all(axis=0)
        if nodal is not None:
            for node, part in zip(ends, share, strict=True):
                for component, values in enumerate(force):
                    np.add.at(nodal[component], node[felt], (part * values)[felt])
        # Edges without nodes: no treatment that has any, or held particles behind them.
        if felt.all():
            continue
        nearest = _nearest(lattice, operator.bonds.phases, rule, np.asarray(~felt))
        for component, values in enumerate(force):
            np.add.at(load[component], nearest, values[~felt])
    return nodal


def _nearest(lattice: Lattice, phases: Phases | None, rule: Quadrature, which: Mask) -> Indices:
    """The particle that is nearest to each of some points of a rule, of the edge's own phase."""
    points, near = rule.points[which], lattice.centred
    if phases is None or rule.outline.phase is None:
        return np.asarray(near.tree.query(points)[1])
    phase = rule.outline.phase[rule.edge[which]]
    found = np.zeros(len(points), dtype=np.int64)
    for k in np.unique(phase):
        own = np.nonzero(phases.of == k)[0]
        _, place = KDTree(near.points[own]).query(points[phase == k])
        found[phase == k] = own[place]
    return found


def _concentrate(
    scene: Description,
    lattice: Lattice,
    cracks: list[Crack],
    operator: BondOperator,
    load: Array,
    nodal_load: Array | None,
) -> None:
    """Give loads at points to the surface's nodes (into `nodal_load`) or to particles (`load`)."""
    near, surface = lattice.centred, operator.ended_stiffness
    for item in scene.loads:
        if item.points is None:
            continue
        places, force = item.points(scene.spacing)
        if thickness.varies(scene):
            force = force * thickness.at(scene, places)[:, None]
        places, force = places - near.shift, force.T / scene.spacing**2
        unknowns = scene.physics.loads[item.kind]
        inside = np.ones(len(places), dtype=bool)
        if surface is not None and nodal_load is not None:
            outline = surface.ended.outline
            edge, position = on_edges(outline, places, scene.spacing)
            ends = outline.edges[edge]
            at_edge = (edge >= 0) & np.isin(ends, surface.nodes).all(axis=1)
            inside = ~at_edge
            for node, share in zip(ends.T, (1 - position, position), strict=True):
                for unknown, values in zip(unknowns, force, strict=True):
                    part = (share * values)[at_edge]
                    np.add.at(nodal_load[unknown], node[at_edge], part)
        if inside.any():
            point, particle, share = on_particles(near, cracks, places[inside])
            for unknown, values in zip(unknowns, force, strict=True):
                np.add.at(load[unknown], particle, share * values[inside][point])


def _eigenstrain(
    scene: Description,
    lattice: Lattice,
    operator: BondOperator,
    load: Array,
    nodal_load: Array | None,
) -> Eigenstrain | None:
    """What temperatures strain; their forces are added to `load` and `nodal_load`."""
    acting = [item.strain for item in scene.loads if item.strain is not None]
    if not acting:
        return None
    surface, phases = operator.ended_stiffness, operator.bonds.phases
    solids = [None, *(inclusion.expansion for inclusion in scene.inclusions)]
    each = [sum(strain(lattice.places, False, own).T for strain in acting) for own in solids]
    particles = np.asarray(each[0])
    if phases is not None:
        particles = np.stack(each)[phases.of, :, np.arange(lattice.count)].T
    nodes = None
    if surface is not None:
        at = surface.ended.outline.nodes + lattice.centred.shift
        # Nodes at which no bond ends feel nothing: a value a node is one of those that do.
        nodes = np.zeros((len(solids), 3, len(at)))
        for k, own in enumerate(solids):
            felt = sum(strain(at[surface.nodes], True, own).T for strain in acting)
            nodes[k][:, surface.nodes] = felt
    found = Eigenstrain(operator.bonds, operator.moduli, particles, nodes)
    load += found.load()
    if surface is not None and nodal_load is not None:
        on_particles, on_nodes = found.surface_load(surface)
        load += on_particles
        nodal_load += on_nodes
    return found
