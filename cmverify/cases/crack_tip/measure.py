"""What is measured of the crack tip, by bonds and by finite elements."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from cmverify.case import Array, Measurement
from cmverify.cases.common import adapters, sif
from cmverify.cases.crack_tip.drawn import fields, lines
from cmverify.cases.crack_tip.problem import HORIZON_CELLS, Problem, solve
from cmverify.judge.norms import relative_l2

if TYPE_CHECKING:
    from solver import Solution
    from solver.bonds import Surface
    from solver.material import Calibration
    from solver.problem.tips import Tip

#: The ring in which stress intensity factors are measured, from 0.4 of it on.
RING = 0.8


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
        fields=fields(points, free, solution.displacement, displacement, stress, stress22, n),
        lines=lines(
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


def warm_fem(order: int) -> None:
    fem(Problem(1.0, 0.0), order, False, 12)
