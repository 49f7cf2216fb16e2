"""What can be known of a scene without solving it: its cost, and values where they are needed."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import dist
from typing import TYPE_CHECKING

import numpy as np
import shapely

from cmverify.exchange import budget
from cmverify.exchange.model import SceneFile
from cmverify.exchange.output import along
from cmverify.exchange.refusal import SceneFileError, Source

if TYPE_CHECKING:
    from solver import Scene
    from solver.geometry import Region

#: Chords of curves, as a share of the body's size, and the turn (rad) that makes a corner.
_CHORD, _TURN = 0.02, 0.2


class CostError(SceneFileError):
    """A scene that would take more than may be spent here and now: the model has no part in it."""


def afford(
    file: SceneFile, scene: Scene, source: Source, memory: float | None, seconds: float
) -> budget.Cost:
    """What it will take; refuse what would take too much memory or time.

    Raises
    ------
    CostError
    """
    x0, y0, x1, y1 = scene.region.bounds
    if not scene.m >= 1:
        raise source.error(
            ("discretisation", "m"), f"the horizon is at least one cell, not {scene.m:g}"
        )
    inner = [_edge(inclusion.region) for inclusion in scene.inclusions]
    cost = budget.estimate(
        x1 - x0,
        y1 - y0,
        scene.spacing,
        float(scene.m),
        len(scene.physics.unknowns),
        scene.surface,
        sum(dist(a, b) for crack in file.crack for a, b in pairwise(crack.path)),
        any(getattr(file, name, None) is not None for name in ("fracture", "sensing", "quench")),
        _edge(scene.region),
        # From either side; a corner of one of the two is none of the other.
        budget.Edge(2 * sum(one.length for one in inner), sum(one.corners for one in inner)),
    )
    free = budget.SHARE * budget.free_memory() if memory is None else memory
    if too_much := cost.refusal(free, seconds):
        # Whichever of the two numbers is the unusual one.
        key = "m" if cost.family > cost.particles else "spacing"
        error = source.error(("discretisation", key), f"{too_much}: ask for less or allow more")
        raise CostError(str(error))
    return cost


def _edge(region: Region) -> budget.Edge:
    """Length of a region's edge, and its corners that turn inwards."""
    x0, y0, x1, y1 = region.bounds
    outline = region.outline(_CHORD * max(x1 - x0, y1 - y0))
    corners = 0
    for part in shapely.get_parts(outline):
        if not isinstance(part, shapely.Polygon):
            continue
        for number, ring in enumerate((part.exterior, *part.interiors)):
            points = shapely.get_coordinates(ring)[:-1]
            body_left = shapely.is_ccw(ring) == (number == 0)
            along = np.diff(np.vstack([points, points[:1]]), axis=0)
            before = np.roll(along, 1, axis=0)
            cross = before[:, 0] * along[:, 1] - before[:, 1] * along[:, 0]
            turn = np.arctan2(cross, (before * along).sum(axis=1))
            corners += int((turn > _TURN).sum() if body_left else (turn < -_TURN).sum())
    return budget.Edge(float(outline.length), corners)


def try_on_lattice(file: SceneFile, scene: Scene, source: Source, start: float) -> None:
    """Evaluate conditions, and values at the start, where they will be needed."""
    from solver.geometry import Lattice, select
    from solver.problem import thickness
    from solver.problem.inclusions import phases_of
    from solver.problem.loading import edge_loads
    from solver.problem.values import at_time, evaluate

    with source.at("discretisation"):
        family = scene.family()
    with source.at("discretisation", "spacing"):
        lattice = Lattice(scene.region, scene.spacing, family.reach)
    if scene.inclusions:
        with source.at("inclusion"):
            phases_of(scene, lattice)
    if thickness.varies(scene):
        with source.at("thickness"):
            thickness.of_particles(scene, lattice)
    for i, (table, support) in enumerate(zip(file.support, scene.supports, strict=True)):
        key = "where" if table.layer_cells is None else "layer_cells"
        with source.at("support", i):
            support.columns(scene.physics)
        if table.kind == "edge":
            continue  # nodes of the surface, which there are none of yet
        with source.at("support", i, key):
            chosen = support.select(lattice)
            if not chosen.any():
                raise ValueError("the support holds no particle")
        for name, value in table.values.items():
            with source.at("support", i, name):
                width = 2 if name == "displacement" else 1
                evaluate(at_time(value, start), lattice.places[chosen], width, "it")
    for i, (entry, acting) in enumerate(zip(file.load, scene.loads, strict=True)):
        load = acting.at(start)
        where = getattr(entry, "where", None)
        if where is not None and load.density is not None:
            with source.at("load", i, "where"):
                if not select(lattice, where).any():
                    raise ValueError("the load acts on no particle")
        if load.density is not None:
            with source.at("load", i, "value"):
                load.density(lattice, scene.surface == "extrapolated", None)
        if load.strain is not None:
            with source.at("load", i, "value"):
                load.strain(lattice.places, False)
        if load.edge is not None:
            with source.at("load", i):
                edge_loads(replace(scene, loads=[load]), lattice)
    for i, line in enumerate(file.output.line):
        with source.at("output", "line", i):
            along(lattice.places, {}, line, scene.spacing)
    if file.fracture is not None and file.fracture.no_fail is not None:
        with source.at("fracture", "no_fail"):
            select(lattice, file.fracture.no_fail)
