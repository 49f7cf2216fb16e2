"""CPU seconds to one error, beside quadratic finite elements: a smooth field, and a crack tip.

exp(x1 − 2 x2) cos x2 in the disc is no polynomial, so that both converge at their orders, two and
three. At the tip of a crack calibrated bonds meet meshes that are graded towards it. Each
takes the coarsest resolution that reaches the error over the same particles; then both are timed
in turns, so that a drifting machine drifts for both.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from time import process_time
from typing import Any

import numpy as np

from cmverify.cases import disc
from cmverify.cases.common import adapters
from cmverify.cases.crack_tip.measure import displacement_error
from cmverify.cases.crack_tip.problem import Problem, scene_of
from cmverify.judge.norms import relative_l2
from cmverify.studies.speed.measure import Timing

#: Spacings a/n that are tried, coarse ones first; elements have twice the size, as in the case.
RESOLUTIONS = tuple(range(20, 160, 5))
#: The same at a crack tip, of bonds and of elements far from it. At the tip these are smaller by
#: so much, and grow by so much over n a length: of what was tried the least time to 4e-4 and 1e-4.
TIP_RESOLUTIONS = (20, 25, 30, 40, 50, 60, 75, 90, 105, 120)
TIP_ELEMENTS = (8, 10, 13, 16, 20, 25, 30)
_FINER, _GROWTH = 200, 4.0
#: Of the bonds: a hundredth of the error or less.
RESIDUAL = 1e-8
#: From a resolution to what solves at it, and what judges its answer.
Way = Callable[[int], tuple[Callable[[], Any], Callable[[Any], float]]]


def bonds(n: int) -> tuple[Callable[[], Any], Callable[[Any], float]]:
    """What solves by bonds at spacing a/n, scene and set-up included, and what judges that."""
    exact = disc.EXPONENTIAL.exact()

    def solve() -> Any:
        return disc.scene_of(disc.EXPONENTIAL, "positive", n).solve(tolerance=RESIDUAL)

    def error(solution: Any) -> float:
        free = ~solution.prescribed
        return relative_l2(solution.temperature[free], exact.value(*solution.points[free].T))

    return solve, error


def elements(n: int) -> tuple[Callable[[], Any], Callable[[Any], float]]:
    """What solves by scikit-fem on a mesh that is there, and what judges that."""
    from references.fem import conduction, mesh

    exact, conductivity = disc.EXPONENTIAL.exact(), disc.EXPONENTIAL.conductivity
    body, _ = adapters.timed_mesh(mesh.disc, 2 / n)
    points = adapters.free_points(n)

    def solve() -> Any:
        return conduction.steady_conduction(body, conductivity, exact.value, order=2)

    def error(solution: Any) -> float:
        return relative_l2(solution.at(points), exact.value(*points.T))

    return solve, error


def to_an_error(error: float = 1e-6, rounds: int = 15) -> list[Timing]:
    """CPU seconds of bonds and of quadratic elements until the temperature errs by no more.

    The bonds' set-up, the elements' assembly and factorisation count; meshing, compilation and
    the evaluation of errors do not.

    Returns
    -------
    list of Timing
        Values: ``unknowns``, ``error``, ``cpu_s`` (median), ``slower`` (median over the rounds of
        the ratio to the bonds' CPU seconds) with its quartiles ``from`` and ``to``.

    Raises
    ------
    ValueError
        If one of them does not get there.
    """
    ways = {"bond/positive": (bonds, RESOLUTIONS), "fem/P2": (elements, RESOLUTIONS)}
    return _race(ways, error, rounds)


def at_a_tip(errors: Sequence[float] = (4e-4, 1e-4), rounds: int = 7) -> list[Timing]:
    """The same of the displacement around a crack tip: calibrated tips and graded meshes.

    In modes I and II. That a tip has been calibrated is counted as compilation is: it serves every
    spacing and every body with such a tip.
    """
    rows = []
    for mode, problem in (("I", Problem(1.0, 0.0)), ("II", Problem(0.0, 1.0))):
        ways = {
            f"mode {mode}, bond/calibrated tip": (partial(tip_bonds, problem), TIP_RESOLUTIONS),
            f"mode {mode}, fem/P2 graded": (partial(tip_elements, problem), TIP_ELEMENTS),
        }
        for error in errors:
            found = _race(ways, error, rounds)
            rows += [Timing(f"{row.name}, to {error:g}", row.values) for row in found]
    return rows


def tip_bonds(problem: Problem, n: int) -> tuple[Callable[[], Any], Callable[[Any], float]]:
    """What solves by bonds with a calibrated tip at spacing a/n, and what judges that."""

    def solve() -> Any:
        scene = scene_of(problem, "lattice", "extrapolated", n, "calibrated")
        return scene.solve(tolerance=RESIDUAL)

    return solve, partial(displacement_error, problem)


def tip_elements(problem: Problem, n: int) -> tuple[Callable[[], Any], Callable[[Any], float]]:
    """What solves by scikit-fem on a mesh that is graded towards the tip, and what judges that."""
    from references.fem import elasticity, mesh

    size = 2 / n
    body, _ = adapters.timed_mesh(
        mesh.crack_tip_disc, size, tip_size=size / _FINER, growth=_GROWTH / n
    )
    points = adapters.free_points(60)

    def solve() -> Any:
        return elasticity.solve_elasticity(
            body, problem.voigt, displacement=problem.displacement, order=2
        )

    def error(solution: Any) -> float:
        return relative_l2(solution.at(points), problem.displacement(*points.T))

    return solve, error


def _race(ways: Mapping[str, tuple[Way, Sequence[int]]], error: float, rounds: int) -> list[Timing]:
    """Several ways to one error, each at the first resolution that gets there, timed in turns."""
    found = {name: _coarsest(name, *way, error) for name, way in ways.items()}
    times = np.array([[_cpu(solve) for _, _, _, solve in found.values()] for _ in range(rounds)])
    ratios = times / times[:, :1]
    rows = []
    for k, (name, (n, unknowns, reached, _)) in enumerate(found.items()):
        low, middle, high = np.percentile(ratios[:, k], (25, 50, 75))
        values = {
            "unknowns": unknowns,
            "error": reached,
            "cpu_s": float(np.median(times[:, k])),
            "slower": float(middle),
            "from": float(low),
            "to": float(high),
        }
        rows.append(Timing(f"{name}, a/{n}", values))
    return rows


def _coarsest(
    name: str, way: Way, resolutions: Sequence[int], error: float
) -> tuple[int, int, float, Callable[[], Any]]:
    """Resolution, unknowns, error and solve of the first that is good enough."""
    for n in resolutions:
        solve, judge = way(n)
        solution = solve()
        reached = judge(solution)
        if reached <= error:
            unknowns = getattr(solution, "unknowns", None)
            if not isinstance(unknowns, int):  # a field of all of them, in ours
                unknowns = solution.statistics.unknowns
            return n, unknowns, reached, solve
    raise ValueError(f"{name} does not err by {error:g} or less at a/{resolutions[-1]}")


def _cpu(solve: Callable[[], Any]) -> float:
    begun = process_time()
    solve()
    return process_time() - begun
