"""What is prescribed and what acts, as arrays over particles and the surface's nodes.

`supports` and `loads` say what a support or a load is; here those of a scene are laid on its
lattice, once for statics (`discretisation`), at every time for what is driven (`forcing`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.spatial import KDTree

from ..arrays import Array, Indices, Mask
from ..bonds import Bonds
from ..errors import SceneError
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
    on_nearest,
    on_particles,
)
from ..magnitude import STRAINS, outside
from ..material import Moduli
from ..operators import BondOperator
from ..operators.eigenstrain import Eigenstrain
from . import thickness
from .description import Description
from .values import evaluate


def prescribed_values(scene: Description, lattice: Lattice, moduli: Moduli) -> tuple[Mask, Array]:
    """Which unknowns of the particles supports prescribe, and at what, both (components, N)."""
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


def hold_edges(scene: Description, bonds: Bonds, moduli: Moduli) -> None:
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


def require_range(
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


def body_loads(
    scene: Description, lattice: Lattice, moduli: Moduli, phases: Phases | None
) -> Array:
    """What loads in the body exert on the particles, per volume, (components, N)."""
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


def held_particles(scene: Description, prescribed: Mask) -> Mask:
    """Particles that are held, shape (N,): a matter of displacement (or temperature) alone.

    Whether its particles may turn or not, a clamp is no free surface.
    """
    turning = np.array(scene.physics.turning[: len(prescribed)])
    return np.asarray(prescribed[~turning].all(axis=0))


def centred_cracks(cracks: Sequence[Crack], lattice: Lattice) -> list[Crack]:
    """Cracks in the coordinates of the centred lattice."""
    x, y = lattice.centred.shift
    return [
        crack if (x, y) == (0.0, 0.0) else crack.moved((-x, -y), lattice.grid) for crack in cracks
    ]


def edge_loads(
    scene: Description, lattice: Lattice, sharp_tips: bool = True, phases: Phases | None = None
) -> list[Quadrature]:
    """Loads on the body's edges, evaluated, in the order of the scene's loads."""
    if all(item.edge is None for item in scene.loads):
        return []
    near = lattice.centred
    moved = centred_cracks(scene.cracks, lattice)
    if phases is not None:
        outline = phases.outline(moved, sharp_tips)
    else:
        cracks = CrackSet.joined(Frame.of(near), moved, Body.of(near))
        outline = Outline.of(near.region, cracks, near.spacing, sharp_tips)
    return on_outline(scene, outline, lattice)


def on_outline(scene: Description, outline: Outline, lattice: Lattice) -> list[Quadrature]:
    """Loads on the edges of an outline that is known."""
    near = lattice.centred
    edges = [item.edge for item in scene.loads if item.edge is not None]
    return [thickness.loaded(scene, edge(outline, near.shift, near.grid)) for edge in edges]


def share_out(
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
        for which, particle, share in _nearest(
            lattice, operator.bonds.phases, rule, np.asarray(~felt)
        ):
            for component, values in enumerate(force):
                np.add.at(load[component], particle, share * values[which])
    return nodal


def _nearest(
    lattice: Lattice, phases: Phases | None, rule: Quadrature, which: Mask
) -> Iterator[tuple[Indices, Indices, Array]]:
    """Points of a rule, particles that carry them (of the edge's own phase), and their shares."""
    chosen, near = np.nonzero(which)[0], lattice.centred
    if phases is None or rule.outline.phase is None:
        point, particle, share = on_nearest(near.tree, rule.points[chosen], near.spacing)
        yield chosen[point], particle, share
        return
    phase = rule.outline.phase[rule.edge[chosen]]
    for k in np.unique(phase):
        own, mine = np.nonzero(phases.of == k)[0], chosen[phase == k]
        tree = KDTree(near.points[own])
        point, particle, share = on_nearest(tree, rule.points[mine], near.spacing)
        yield mine[point], own[particle], share


def concentrate(
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


def eigenstrain(
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
    warming = np.sum([item.warming(lattice.places) for item in scene.loads], axis=0)
    found = Eigenstrain(operator.bonds, operator.moduli, particles, nodes, warming)
    load += found.load()
    if surface is not None and nodal_load is not None:
        on_particles, on_nodes = found.surface_load(surface)
        load += on_particles
        nodal_load += on_nodes
    return found
