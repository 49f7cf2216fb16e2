"""Thermal strain in statics (Eq. 176 completed): free expansion, clamped bodies, a heated disc.

A bond is strained by s − n·A·n T̄ and γ − n·A·t T̄, T̄ the mean of its ends. A free body then
expands without stress for every uniform and linear temperature; a clamped one bears −C A T; a disc
hottest at its centre has the stress of the closed form.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from cmverify.case import Array, Case, Check, Field, FieldSet, Level, Measurement, Method, OrderBand
from cmverify.cases.common import adapters, warm
from cmverify.cases.surfaces.bodies import displacement_errors, held, symmetric
from cmverify.faults.changes import result, scaled, swapped
from cmverify.faults.fault import Fault
from cmverify.judge.norms import relative_l2, worst

M = 3
CELLS = 12
SEED = 176
TREATMENTS = ("none", "volume", "extrapolated")
#: Of the heated disc: a solid in plane strain, so that its plane constants matter.
YOUNG, POISSON, ALPHA = 2.0, 0.2, 0.01
#: Radius within which stress is judged apart: at a/20 two families from the edge.
INSIDE = 0.7


def oblique(x: Array, y: Array) -> Array:
    """A temperature along an oblique line."""
    return np.asarray(0.3 + x - 2.0 * y)


def random_solid(seed: int) -> tuple[Any, Any]:
    """An elastic tensor with C66 > C12 and an expansion tensor, neither with an axis."""
    from solver import ElasticTensor, ExpansionTensor

    rng = np.random.default_rng(SEED + seed)
    root = rng.normal(size=(3, 3))
    a, b, c = rng.normal(size=3)
    voigt = root @ root.T + np.diag([3.0, 3.0, 4.0])
    return ElasticTensor(voigt), ExpansionTensor([[a, c], [c, b]])


def load_of_bonds(solution: Any) -> float:
    """Energy of the most loaded bond, as fracture sees it, over that of its total strain."""
    from solver.fracture.breaking import Breakable

    # Random solids have bonds of either sign, which fracture refuses.
    body = replace(solution.discretisation, moduli=solution.discretisation.moduli.absolute())
    tough = np.ones(body.family.size)
    mechanical, total = (
        float(Breakable(b, tough, tension_only=False).utilisation(solution.unknowns).max())
        for b in (body, replace(body, eigenstrain=None))
    )
    return mechanical / total


def expansion(scale: float, n: int) -> Measurement:
    """Stress of free bodies, over that of clamped ones; and that of clamped ones.

    `scale` is, for tests, a factor on what the clamped body is expected to bear.
    """
    from solver import Load, Scene, Support, recovery, rectangle

    names = "uniform", "linear", "clamped", "strain", "loaded"
    found: dict[str, list[float]] = {name: [] for name in names}
    common: dict[str, Any] = {"spacing": 1.0 / n, "m": M}
    for seed, surface in enumerate(TREATMENTS):
        solid, expands = random_solid(seed)
        size = float(np.linalg.norm(solid.voigt @ expands.voigt))
        changes: dict[str, Any] = {"uniform": 1.3, "linear": oblique}
        for name, change in changes.items():
            solution = Scene(
                rectangle(1.0, 1.0),
                material=solid,
                supports=held((0.5 / n, 0.5 / n), (0.25 + 0.5 / n, 0.5 / n)),
                loads=[Load.temperature(change, expands)],
                surface=surface,  # type: ignore[arg-type]
                **common,
            ).solve(tolerance=1e-12)
            found[name].append(float(np.abs(recovery.stress(solution)).max()) / size)
            if surface != "extrapolated":
                found["loaded"].append(load_of_bonds(solution))
            if name == "uniform":
                gradient = recovery.displacement_gradient(solution)
                strain = 0.5 * (gradient + gradient.swapaxes(1, 2))
                wanted = np.broadcast_to(change * expands.matrix, strain.shape)
                found["strain"].append(relative_l2(strain.reshape(-1), wanted.reshape(-1)))
    solution = Scene(
        rectangle(1.0, 1.0),
        material=solid,
        supports=[Support.layer(M + 0.5, displacement=(0.0, 0.0), rotation=0.0)],
        loads=[Load.temperature(2.0, expands)],
        **common,
    ).solve(tolerance=1e-12)
    inside = np.abs(solution.points).max(axis=1) < 0.5 - (M + 1.5) / n
    stress = symmetric(recovery.stress(solution)[inside])
    bears = -2.0 * scale * solid.voigt @ expands.voigt
    found["clamped"].append(relative_l2(stress, np.broadcast_to(bears, stress.shape)))
    return Measurement(
        solution.statistics.unknowns,
        {name: worst(values) for name, values in found.items()},
        statistics=adapters.solver_statistics(solution.statistics),
    )


def heated(scale: float, n: int) -> Measurement:
    """Displacement and stress of a free disc that is hottest at its centre, in plane strain."""
    from references.analytic.thermal import HeatedDisc
    from solver import ElasticTensor, ExpansionTensor, Load, Scene, disc, recovery

    exact = HeatedDisc(YOUNG, POISSON, scale * ALPHA, plane_strain=True)
    solution = Scene(
        disc(1.0),
        1.0 / n,
        ElasticTensor.isotropic(YOUNG, POISSON, "strain"),
        held((0.5 / n, 0.5 / n), (0.5 + 0.5 / n, 0.5 / n)),
        [Load.temperature(exact.temperature, ExpansionTensor.isotropic(ALPHA, "strain", POISSON))],
        m=M,
        surface="extrapolated",
    ).solve(tolerance=1e-11)
    points = solution.points
    wanted = exact.stress(*points.T)
    stress = symmetric(recovery.stress(solution))
    inside = np.hypot(*points.T) < INSIDE
    items = {
        f"s{name}": Field(f"$\\sigma_{{{name}}}$", "Pa", stress[:, k], wanted[:, k])
        for k, name in enumerate(("11", "22", "12"))
    }
    displacement = exact.displacement(*points.T)
    return Measurement(
        solution.statistics.unknowns,
        {
            **displacement_errors(points, solution.displacement, displacement),
            "stress": relative_l2(stress[inside], wanted[inside]),
            "stress, edge included": relative_l2(stress, wanted),
        },
        adapters.solver_seconds(solution.statistics),
        adapters.solver_statistics(solution.statistics),
        FieldSet(points, items, spacing=1.0 / n),
    )


CASES = (
    Case(
        name="thermal-expansion",
        title="Free expansion without stress, and clamped bodies that bear it all",
        section="Sect. 5",
        equations=("Eq. 176",),
        tags=("thermoelastic", "elasticity"),
        shows=(
            "Random anisotropic solids with random anisotropic expansion stay free of stress "
            "under every uniform and linear temperature, and bear −C A T when they are clamped."
        ),
        methods=(
            Method("bond/lattice", "bond", partial(expansion, 1.0),
                   dict.fromkeys(Level, (CELLS,)), partial(warm.statics, "extrapolated")),
        ),
        checks=tuple(
            Check(
                "bond/lattice",
                quantity,
                {CELLS: 1e-10},
                source="rounding: no bond is strained beyond what expands it",
                exact=True,
            )
            for quantity in ("uniform", "linear", "clamped", "strain", "loaded")
        ),
        quantities={
            "uniform": "largest stress under a uniform temperature, all surfaces, over |C A|",
            "linear": "the same under a linear temperature",
            "clamped": "stress of a clamped body",
            "strain": "strain of free bodies",
            "loaded": "what loads a bond of a free body to break, over what its total strain would",
        },
        primary="uniform",
        featured="bond/lattice",
        length="L",
        timed=False,
    ),
    Case(
        name="heated-disc",
        title="A free disc that is hottest at its centre, plane strain",
        section="Sect. 5",
        equations=("Eq. 176",),
        tags=("thermoelastic", "elasticity", "disc"),
        shows=(
            "Displacement and stress are Timoshenko's, at second order; beside the edge, where the "
            "surface's own displacement is a chord, stress errs by a few per cent of it."
        ),
        methods=(
            Method("bond/extrapolated", "bond", partial(heated, 1.0),
                   {Level.QUICK: (20,), Level.STANDARD: (20, 40), Level.PAPER: (20, 40, 80)},
                   partial(warm.statics, "extrapolated")),
        ),
        checks=(
            *(
                Check(
                    "bond/extrapolated",
                    quantity,
                    bounds,
                    order=OrderBand(1.5, 2.5, fitted=True),
                    source="closed form; measured with half as much again, second order of bonds "
                    "and of their mean temperature",
                )
                for quantity, bounds in (
                    ("displacement", {20: 5e-3, 40: 1.3e-3, 80: 3.3e-4}),
                    ("stress", {20: 7.3e-3, 40: 1.8e-3, 80: 5.2e-4}),
                )
            ),
            Check(
                "bond/extrapolated",
                "largest",
                {20: 1.03e-2, 40: 2.8e-3},
                source="closed form; measured with half as much again",
            ),
            Check(
                "bond/extrapolated",
                "stress, edge included",
                {20: 4.5e-2, 40: 1.4e-2},
                source="closed form; measured with half as much again (the edge cuts the cells "
                "differently at every spacing)",
            ),
        ),
        quantities={
            "displacement": "relative L2 error of the displacement, rigid motion aside",
            "largest": "largest error of the displacement over the largest displacement",
            "stress": "relative L2 error of the stress within 0.7 of the radius",
            "stress, edge included": "the same of all particles",
        },
        primary="stress",
        featured="bond/extrapolated",
    ),
)  # fmt: skip

E = "solver.operators.eigenstrain.Eigenstrain"
FAULTS = (
    Fault("thermal strain of whole bonds + 1 %", f"{E}.of_offset", scaled(1.01), "thermal"),
    Fault("thermal strain of ended bonds + 1 %", f"{E}.of_ended", scaled(1.01), "thermal"),
    Fault("thermal forces at particles + 1 %", f"{E}.load", scaled(1.01), "thermal"),
    Fault("thermal forces at surfaces + 1 %", f"{E}.surface_load", scaled(1.01), "thermal"),
    Fault(
        "total strain breaks bonds",
        "solver.fracture.breaking.free_strains",
        result(lambda free: free[:, :, :0]),
        "thermal",
    ),
    Fault(
        "expansion along 1 and 2 swapped",
        "solver.material.expansion.ExpansionTensor.voigt",
        result(swapped()),
        "thermal",
    ),
    Fault(
        "plane stress expansion in plane strain",
        "solver.material.expansion.ExpansionTensor.isotropic",
        lambda right: lambda cls, alpha, plane="stress", nu=None: right(cls, alpha),
        "thermal",
    ),
    Fault(
        "stress of the heated disc + 1 %",
        "references.analytic.thermal.HeatedDisc.stress",
        scaled(1.01),
        "closed forms",
    ),
)
