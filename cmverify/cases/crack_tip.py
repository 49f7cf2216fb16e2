"""The crack tip in a fully anisotropic body (Sect. 2.3.1).

A disc of radius a with a slit from (-a, 0) to the centre. Displacement *and rotation* of the
asymptotic field are prescribed in a layer of 5.5 cells; faces of the slit are free: by
the volume method, as in the paper, unless a method's name has another treatment. Units: a = 1,
C = 1, stress intensity factor 1, so displacements are in K sqrt(a)/C and stresses in K/sqrt(a).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from cmverify.case import (
    Array,
    Case,
    Check,
    Curve,
    Field,
    FieldSet,
    Level,
    LinePlot,
    Measurement,
    Method,
    OrderBand,
)
from cmverify.cases.common import adapters, materials, sif, warm
from cmverify.cases.common.scenes import cracked_disc
from cmverify.exchange.statement import Pose, Statement, Target, free_particles
from cmverify.judge.norms import relative_l2

if TYPE_CHECKING:
    from solver import Scene, Solution
    from solver.bonds import Surface
    from solver.material import Calibration
    from solver.problem.tips import Tip

#: C1111 = C, C2222 = 4C/5, C1122 = C/5, C1212 = C/3, C1112 = C/10, C2212 = C/6; order 11, 22, 12.
STIFFNESS = tuple(map(tuple, (materials.TENSORS["fully anisotropic"] / 100.0).tolist()))
HORIZON_CELLS = 5  # m
SOURCE = "closed form of Sih, Paris and Irwin; measured with a margin, order by u ~ √r"
INTENSITY_SOURCE = "the K prescribed; measured with half as much again"
LADDER = {Level.QUICK: (30, 60), Level.STANDARD: (30, 60, 90), Level.PAPER: (30, 60, 120)}
#: Of everything beside the paper's treatment with exact lattice sums.
BESIDE = {**LADDER, Level.QUICK: (30,)}
#: The ring in which stress intensity factors are measured, from 0.4 of it on.
RING = 0.8


@dataclass(frozen=True)
class Problem:
    """Stress intensity factors of the field, and the stiffness that the solver is given.

    Tests perturb `voigt` and `scale` (of the reference); the closed form keeps the true ones.
    """

    KI: float
    KII: float
    voigt: tuple[tuple[float, ...], ...] = STIFFNESS
    scale: float = 1.0

    def displacement(self, x: Array, y: Array) -> Array:
        """(..., 2), in K sqrt(a)/C."""
        from references.analytic import lekhnitskii

        return lekhnitskii.crack_tip_displacement(STIFFNESS, x, y, self.KI, self.KII)

    def rotation(self, x: Array, y: Array) -> Array:
        """Half the curl, rad over K/(C sqrt(a))."""
        from references.analytic import lekhnitskii

        return lekhnitskii.crack_tip_rotation(STIFFNESS, x, y, self.KI, self.KII)

    def stress22(self, x: Array, y: Array) -> Array:
        """In K/sqrt(a)."""
        from references.analytic import lekhnitskii

        return lekhnitskii.crack_tip_stress(STIFFNESS, x, y, self.KI, self.KII)[..., 1]


def stress_ahead(
    problem: Problem, points: Array, stress22: Callable[[np.ndarray], Array], n: int
) -> dict[str, float]:
    """The quantity "stress ahead", if the mode has a stress there.

    The largest relative deviation over the two rows of particles beside the crack's line, from
    2 delta to a/2 ahead of the tip; NaN if there are none. Pure mode II has no sigma22 on the
    line itself, so that a relative deviation says nothing.

    Parameters
    ----------
    stress22 : callable
        Takes indices into `points` and returns the computed stress there.
    """
    if problem.KI == 0.0:
        return {}
    x, y = points.T
    inside = (x >= 2 * HORIZON_CELLS / n) & (x <= 0.5)
    near = np.flatnonzero((np.abs(y) < 0.75 / n) & inside)
    if near.size == 0:
        return {"stress ahead": float("nan")}
    reference = problem.scale * problem.stress22(x[near], y[near])
    return {"stress ahead": float(np.max(np.abs(stress22(near) / reference - 1.0)))}


def scene_of(
    problem: Problem, calibration: Calibration, surface: Surface, n: int, tip: Tip = "drawn"
) -> Scene:
    """The cracked disc at spacing a/n."""
    from solver import ElasticTensor, Support

    layer = Support.layer(
        cells=adapters.LAYER_CELLS,
        displacement=problem.displacement,
        rotation=problem.rotation,
    )
    return cracked_disc(
        ElasticTensor(problem.voigt),
        n,
        layer,
        m=HORIZON_CELLS,
        calibration=calibration,
        surface=surface,
        tip=tip,
    )


def solve(
    problem: Problem, calibration: Calibration, surface: Surface, n: int, tip: Tip = "drawn"
) -> Solution:
    """The bond solution at spacing a/n."""
    return scene_of(problem, calibration, surface, n, tip).solve(tolerance=1e-10)


def state(problem: Problem, n: int) -> Statement:
    """The cracked disc, and what is judged of an answer."""
    scene = scene_of(problem, "lattice", "volume", n)
    points = free_particles(scene)
    u, rotation = problem.displacement(*points.T), problem.rotation(*points.T)
    wanted = np.array([problem.KI, problem.KII])
    return Statement(
        scene,
        (
            Target("displacement", "displacement", "K√a/C", u, points=points, columns=("u1", "u2")),
            Target("rotation", "rotation", "K/(C√a)", rotation, points=points, needed=False),
            Target("K", "K", "K", wanted, needed=False),
        ),
        remarks=("Units: a = 1, C = 1, K = 1.",),
    )


def displacement_error(problem: Problem, solution: Solution) -> float:
    """Relative L2 over the particles that are not prescribed."""
    free = ~solution.prescribed
    exact = problem.scale * problem.displacement(*solution.points[free].T)
    return relative_l2(solution.displacement[free], exact)


def intensities(problem: Problem, solution: Solution, n: int) -> dict[str, float]:
    """Errors of K by interaction integral and by series, and where the series sees the tip."""
    wanted = problem.scale * np.array([problem.KI, problem.KII])
    size = float(np.hypot(*wanted))
    integral = sif.interaction_integral(solution, (0.0, 0.0), 0.0, RING)
    series = sif.tip_series(solution, (0.0, 0.0), 0.0, RING)
    return {
        "K": float(np.hypot(*(integral - wanted))) / size,
        "K by series": float(np.hypot(*((series.KI, series.KII) - wanted))) / size,
        "shift": series.shift * n,
        "misfit": series.residual,
    }


def bond(
    problem: Problem,
    calibration: Calibration,
    n: int,
    surface: Surface = "volume",
    tip: Tip = "drawn",
) -> Measurement:
    """Solve with the bond solver at spacing a/n and compare with the closed form."""
    from solver import recovery

    solution = solve(problem, calibration, surface, n, tip)
    seconds = adapters.solver_seconds(solution.statistics)
    with adapters.stopwatch(seconds, "recovery"):
        stress = recovery.stress(solution, rule="plane")[:, 1, 1]
        found = intensities(problem, solution, n)
        if surface == "extrapolated":
            other = displacement_error(problem, solve(problem, calibration, "volume", n))
            found["over volume"] = displacement_error(problem, solution) / other
    points, free = solution.points, ~solution.prescribed
    x, y = points.T
    displacement = problem.scale * problem.displacement(x, y)
    rotation = problem.scale * problem.rotation(x, y)
    stress22 = problem.scale * problem.stress22(x, y)
    face = adapters.row(points, 0.0, 1.0 / n)
    face = face[(points[face, 0] < 0.0) & free[face]]
    return Measurement(
        unknowns=solution.statistics.unknowns,
        quantities={
            "displacement": displacement_error(problem, solution),
            "rotation": relative_l2(solution.rotation[free], rotation[free]),
            "upper face": relative_l2(solution.displacement[face], displacement[face]),
            **stress_ahead(problem, points, lambda near: stress[near], n),
            **found,
            "iterations": float(solution.statistics.iterations),
        },
        seconds=seconds,
        statistics=adapters.solver_statistics(solution.statistics),
        fields=_fields(points, free, solution.displacement, displacement, stress, stress22, n),
        lines=_lines(
            problem, points, free, solution.displacement, displacement, stress, stress22, n
        ),
    )


def fem(problem: Problem, order: int, graded: bool, n: int) -> Measurement:
    """Solve with scikit-fem on a mesh with the slit as two faces.

    P2 takes elements of twice the size, so that unknowns compare; `graded` refines towards the
    tip, as one would who knows the solution. Errors are taken at the bond solver's particles.
    """
    from references.fem import elasticity, mesh

    size = order / n
    options = {"tip_size": size / 20} if graded else {}
    body, meshing = adapters.timed_mesh(mesh.crack_tip_disc, size, **options)
    solution = elasticity.solve_elasticity(
        body, problem.voigt, displacement=problem.displacement, order=order
    )
    points = adapters.free_points(n)
    x, y = points.T
    displacement = problem.scale * problem.displacement(x, y)
    computed = solution.at(points)
    gradient = solution.gradient_at(points)
    rotation = 0.5 * (gradient[:, 1, 0] - gradient[:, 0, 1])
    face = adapters.row(points, 0.0, 1.0 / n)
    face = face[points[face, 0] < 0.0]
    return Measurement(
        unknowns=solution.unknowns,
        quantities={
            "displacement": relative_l2(computed, displacement),
            "rotation": relative_l2(rotation, problem.scale * problem.rotation(x, y)),
            "upper face": relative_l2(computed[face], displacement[face]),
            **stress_ahead(problem, points, lambda near: solution.stress_at(points[near])[:, 1], n),
        },
        seconds=adapters.fem_seconds(meshing, solution.seconds),
        statistics=adapters.fem_statistics(body, order),
    )


def _fields(
    points: Array,
    free: np.ndarray,
    computed: Array,
    reference: Array,
    stress: Array,
    stress22: Array,
    n: int,
) -> FieldSet:
    length, tension = "K√a/C", "K/√a"
    items = {
        "u1": Field("$u_1$", length, computed[free, 0], reference[free, 0]),
        "u2": Field("$u_2$", length, computed[free, 1], reference[free, 1]),
        "stress22": Field("$\\sigma_{22}$", tension, stress[free], stress22[free]),
    }
    return FieldSet(points[free], items, spacing=1.0 / n)


def _lines(
    problem: Problem,
    points: Array,
    free: np.ndarray,
    computed: Array,
    reference: Array,
    stress: Array,
    stress22: Array,
    n: int,
) -> tuple[LinePlot, ...]:
    inner, spacing = points[free], 1.0 / n
    plots = [
        LinePlot(
            f"Displacement $u_{i + 1}$ along three abscissae (Fig. 7)",
            "$x_1/a$",
            f"$u_{i + 1}$ (K√a/C)",
            adapters.curves_along_rows(
                inner, computed[free, i], reference[free, i], (-0.5, 0.0, 0.5), spacing
            ),
        )
        for i in (0, 1)
    ]
    upper = adapters.row(inner, 0.0, spacing)
    front = upper[(inner[upper, 0] > 0.0) & (inner[upper, 0] <= 0.5)]
    face = upper[inner[upper, 0] < 0.0]
    x = inner[:, 0]
    # The closed form is steep: draw it finely, from the first particle on.
    dense = np.linspace(0.5 * spacing, 1.0, 800)
    row = np.full_like(dense, inner[upper[0], 1])
    if problem.KI:
        near = dense <= 0.5
        exact = problem.scale * problem.stress22(dense[near], row[near])
        plots.append(
            LinePlot(
                "Stress $\\sigma_{22}$ ahead of the tip (Fig. 8)",
                "$x_1/a$",
                "$\\sigma_{22}$ (K/√a)",
                (Curve("$x_2 = 0$", x[front], stress[free][front], exact, dense[near]),),
                over_resolutions=True,
            )
        )
    # Mode I opens the crack, mode II slides its faces: the component that is not small.
    i = 1 if problem.KI else 0
    behind = -dense[dense < 1.0 - adapters.LAYER_CELLS / n]
    exact = problem.scale * problem.displacement(behind, row[: len(behind)])[:, i]
    plots.append(
        LinePlot(
            f"Displacement $u_{i + 1}$ along the crack's upper face (Fig. 9)",
            "$x_1/a$",
            f"$u_{i + 1}$ (K√a/C)",
            (Curve("upper face", x[face], computed[free, i][face], exact, behind),),
            over_resolutions=True,
        )
    )
    return tuple(plots)


def _warm_fem(order: int) -> None:
    fem(Problem(1.0, 0.0), order, False, 12)


CALIBRATED = "bond/lattice calibrated tip"
TREATMENTS: tuple[Surface, ...] = ("none", "extrapolated")
WARM_FEM = {p: partial(_warm_fem, p) for p in (1, 2)}


def methods(problem: Problem) -> tuple[Method, ...]:
    """Three calibrations, three surface treatments, and finite elements of three kinds."""
    bonds = [
        Method(
            f"bond/{c}",
            "bond",
            partial(bond, problem, c),
            LADDER if c == "lattice" else BESIDE,
            warm.statics,
        )
        for c in materials.CALIBRATIONS
    ]
    bonds += [
        Method(
            f"bond/lattice {t}",
            "bond",
            partial(bond, problem, "lattice", surface=t),
            BESIDE,
            partial(warm.statics, t),
        )
        for t in TREATMENTS
    ]
    bonds.append(
        Method(
            CALIBRATED,
            "bond",
            partial(bond, problem, "lattice", surface="extrapolated", tip="calibrated"),
            {level: ladder for level, ladder in LADDER.items() if level != Level.QUICK},
            partial(warm.statics, "extrapolated"),
        )
    )
    elements = [
        Method(name, "fem", partial(fem, problem, p, graded), BESIDE, WARM_FEM[p])
        for name, p, graded in (
            ("fem/P1", 1, False),
            ("fem/P2", 2, False),
            ("fem/P2 graded", 2, True),
        )
    ]
    return (*bonds, *elements)


KINDS = ("K", "K by series")
#: What was reached at a/30, a/60, a/120, with room for half as much again.
INTENSITY_BOUNDS = {
    "I": {
        "bond/lattice": (8e-3, 4e-3, 2e-3),
        "bond/lattice none": (1.2e-2, 6e-3, 4e-3),
        "bond/lattice extrapolated": (6e-3, 3e-3, 1.5e-3),
    },
    "II": {
        "bond/lattice": (4e-2, 1.5e-2, 6e-3),
        "bond/lattice none": (4.5e-2, 2.5e-2, 1e-2),
        "bond/lattice extrapolated": (2.5e-2, 1e-2, 5e-3),
    },
}
QUANTITIES = {
    "iterations": "Krylov iterations to a residual of 1e-10",
    "displacement": "relative L2 error of the displacement",
    "rotation": "relative L2 error of the rotation against half the curl (Eq. 85)",
    "upper face": "relative L2 error of the displacement along the crack's upper face",
    "K": "relative error of (K_I, K_II) by the interaction integral",
    "K by series": "relative error of (K_I, K_II) by a fit of the tip's series",
    "shift": "cells by which the tip seems to lie ahead, from the term r^(−1/2)",
    "misfit": "relative L2 misfit of the displacement and the tip's series, 0.32 a ≤ r ≤ 0.8 a",
    "over volume": "error of the displacement over that of the volume method",
    "stress ahead": "largest relative deviation of σ₂₂ ahead of the tip, 2δ ≤ x₁ ≤ a/2 (Eq. 83)",
}


def _case(mode: str, problem: Problem, bounds: dict[int, float], shows: str) -> Case:
    checks = [
        Check(
            "bond/lattice",
            "displacement",
            bounds,
            # u ~ sqrt(r) limits a uniform grid to order 1 in L2; the free faces add their own
            # first-order error. Beyond 2 something would cancel that ought not to.
            order=OrderBand(1.1, 2.0, since=30),
            source=SOURCE,
        ),
        # Order 1 on a uniform mesh, twice the strength of the singularity.
        Check(
            "fem/P1", "displacement", order=OrderBand(0.7, 1.6, fitted=True), source="u ~ r^(1/2)"
        ),
        Check(
            "fem/P2", "displacement", order=OrderBand(0.7, 1.6, fitted=True), source="u ~ r^(1/2)"
        ),
    ]
    for method, at_most in INTENSITY_BOUNDS[mode].items():
        limits = dict(zip((30, 60, 120), at_most, strict=True))
        checks += [Check(method, k, limits, source=INTENSITY_SOURCE) for k in KINDS]
    checks.append(
        Check(
            "bond/lattice extrapolated",
            "over volume",
            {30: 1.0},
            source="better than the paper's volume method",
        )
    )
    checks += [
        Check(
            CALIBRATED,
            "displacement",
            {30: 5e-4, 60: 1.7e-4, 120: 6e-5},
            # √r itself, in the cells next to the tip: order 3/2 in L2.
            order=OrderBand(1.2, 1.8),
            source="closed form; measured with half as much again",
        ),
        Check(
            CALIBRATED,
            "K",
            {30: 1.5e-3, 60: 7e-4, 120: 5e-4},
            source="0.05 % at a/120; measured with a margin",
        ),
    ]
    graded = "graded elements resolve the tip; measured with half as much again"
    checks += [
        Check("fem/P2 graded", "displacement", {30: 4e-4}, source=graded),
        Check("bond/lattice", "iterations", {30: 20.0}, source="measured with half as much again"),
    ]
    if problem.KI:
        # sigma22 ahead is K_I/sqrt(2 pi x): in pure mode II it vanishes.
        seen = "Fig. 8: drawn on the closed form; measured 9e-4"
        checks += [
            Check("bond/lattice", "stress ahead", {30: 3e-3}, source=seen),
            Check(
                "fem/P2 graded",
                "stress ahead",
                {30: 1e-3, 90: 1.7e-3, 120: 5e-3},
                # The median falls (1.6e-4, 1.2e-4, 5.5e-5); the largest is that next to the tip.
                source=f"{graded}. 2δ falls with the spacing, and close to the tip elements are "
                "0.15 of their distance from it however many there are: 1.1e-3 at a/90, 3.3e-3 at "
                "a/120",
            ),
        ]
    return Case(
        name=f"crack-tip-{mode}",
        title=f"Crack tip in a fully anisotropic body, mode {mode}",
        section="Sect. 2.3.1",
        equations=("Eqs. 79–83", "Eq. 85"),
        figures=("Fig. 6", "Fig. 7", "Fig. 8", "Fig. 9"),
        tags=("crack-tip", "elasticity", "fracture", *(["work-precision"] if mode == "I" else [])),
        shows=shows,
        methods=methods(problem),
        checks=tuple(checks),
        quantities=QUANTITIES,
        primary="displacement",
        featured="bond/lattice",
        poses=(Pose("bond/lattice", partial(state, problem)),),
    )


CASES = (
    _case(
        "I",
        Problem(1.0, 0.0),
        {30: 5.5e-3, 60: 2.2e-3, 120: 9e-4},
        "The bond lattice gives the opening field of Sih, Paris and Irwin with an error of one "
        "part in a thousand at the paper's resolution, singular tip and free faces included.",
    ),
    _case(
        "II",
        Problem(0.0, 1.0),
        {30: 1.5e-2, 60: 6.2e-3, 120: 2.5e-3},
        "The sliding mode converges at the same rate with about three times the error, which sits "
        "at the tip and along the free faces.",
    ),
)
