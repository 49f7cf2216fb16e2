"""A hole in the one isotropic solid that pairs of forces can make: plane strain, ν = 1/4.

Peridynamic codes with central forces in three dimensions have this Poisson ratio and no other, so
that this is a problem that they can be asked too (`cmverify export isotropic-hole`). The
displacement of the infinite plate with a hole (Kirsch) is held in a layer around a square; the hole
is free. Nothing depends on the stiffness, so that what shows is the lattice's isotropy, Poisson's
ratio and the free edge.
"""

from __future__ import annotations

from functools import cache, partial
from typing import Any

import numpy as np

from cmverify.case import Array, Case, Check, Field, FieldSet, Level, Measurement, Method
from cmverify.cases.common import adapters, materials, warm
from cmverify.cases.surfaces import bodies
from cmverify.cases.surfaces.bodies import Treatment
from cmverify.exchange.statement import Pose, Statement, Target, free_particles
from cmverify.judge.norms import relative_l2

#: Of the hole and the square, in units of five radii: at 1/40 the hole has 8 cells a radius.
RADIUS, WIDTH = 0.2, 1.4
REMOTE = (1.0, 0.0, 0.0)
HORIZON_CELLS = 3
#: Twice what a family at m = 3 reaches: state-based models see their neighbours' families too.
LAYER_CELLS = 6.5
LADDER = {Level.QUICK: (20, 40), Level.STANDARD: (20, 40), Level.PAPER: (20, 40, 80)}
BESIDE = {**LADDER, Level.QUICK: ()}


@cache
def stiffness() -> Array:
    """Plane strain, ν = 1/4, E = 1: C66 = C12."""
    return materials.isotropic(0.25, "strain")


def displacement(x: Array, y: Array) -> Array:
    """Of the infinite plate, (..., 2); within the hole, where chords lie, at its edge."""
    from references.analytic.hole import hole_displacement

    r = np.hypot(x, y)
    push = np.where(r < RADIUS, RADIUS / np.maximum(r, 1e-300), 1.0)
    return hole_displacement(stiffness(), x * push, y * push, RADIUS, RADIUS, REMOTE)


def scene_of(treatment: Treatment, n: int, distortion: float = 1.0) -> Any:
    """The square at spacing 1/n; tests give the solver another C11."""
    from solver import ElasticTensor, Scene, Support, disc, rectangle

    # Of Young's modulus and Poisson's ratio by the solver; the reference has its own.
    given = ElasticTensor.isotropic(1.0, 0.25, "strain").voigt.copy()
    given[0, 0] *= distortion

    def layer(x: Array, y: Array) -> np.ndarray:
        return np.maximum(np.abs(x), np.abs(y)) > 0.5 * WIDTH - LAYER_CELLS / n

    return Scene(
        region=rectangle(WIDTH, WIDTH) - disc(RADIUS),
        spacing=1.0 / n,
        m=HORIZON_CELLS,
        material=ElasticTensor(given),
        surface=treatment,
        supports=[Support.where(layer, displacement=displacement)],
    )


def state(n: int) -> Statement:
    """The square, and what is judged of an answer."""
    scene = scene_of("extrapolated", n)
    points = free_particles(scene)
    u = displacement(*points.T)
    return Statement(
        scene,
        (Target("displacement", "displacement", "σL/E", u, points=points, columns=("u1", "u2")),),
        remarks=("Plane strain, ν = 1/4, E = 1; the stiffness does not matter, only its form.",),
    )


def bond(treatment: Treatment, m: float, n: int, distortion: float = 1.0) -> Measurement:
    """Solve at spacing 1/n and compare with the closed form."""
    assert m == HORIZON_CELLS
    solution = scene_of(treatment, n, distortion).solve(tolerance=bodies.TOLERANCE)
    free = ~solution.prescribed
    points, computed = solution.points[free], solution.displacement[free]
    wanted = displacement(*points.T)
    near = np.hypot(*points.T) < RADIUS + HORIZON_CELLS / n
    items = {
        f"u{i + 1}": Field(f"$u_{i + 1}$", "σL/E", computed[:, i], wanted[:, i]) for i in (0, 1)
    }
    return Measurement(
        solution.statistics.unknowns,
        {
            "displacement": relative_l2(computed, wanted),
            "near the hole": relative_l2(computed[near], wanted[near]),
        },
        adapters.solver_seconds(solution.statistics),
        bodies.statistics_of(solution),
        FieldSet(points, items, spacing=1.0 / n),
    )


#: Measured, with half as much again; a hole of four cells a radius (20) is coarse.
BOUNDS = {20: 2.4e-2, 40: 1.3e-3, 80: 3.7e-4}

CASES = (
    Case(
        name="isotropic-hole",
        title="A hole in plane strain at ν = 1/4, a problem for any peridynamic code",
        section="Sect. 2.2.1 (surface correction)",
        tags=("surface", "elasticity", "hole"),
        shows=(
            "At the Poisson's ratio that central forces have, bonds that end at the surface come "
            "near Kirsch's closed form; codes that leave or stiffen cut families keep an error of "
            "first order at the hole. Other programs' answers stand in docs/howto/other_codes."
        ),
        methods=tuple(
            Method(
                f"bond/{t}",
                "bond",
                partial(bond, t, HORIZON_CELLS),
                LADDER if t == "extrapolated" else BESIDE,
                partial(warm.statics, t),
            )
            for t in reversed(bodies.TREATMENTS)
        ),
        checks=(
            bodies.converging("displacement", BOUNDS, since=40),
            Check(
                "bond/volume",
                "displacement",
                {20: 2e-2, 40: 6.2e-3, 80: 3.5e-3},
                source="closed form; measured with half as much again",
            ),
        ),
        quantities={
            "displacement": "relative L2 error of the displacement",
            "near the hole": "relative L2 error of the displacement within a horizon of the hole",
        },
        primary="displacement",
        featured="bond/extrapolated",
        length="L",
        poses=(Pose("bond/extrapolated", state),),
    ),
)
