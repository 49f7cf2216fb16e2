"""Three bonds in ten removed at random: solved like a direct solver would, or refused rightly."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from cmverify.case import Case, Check, Level, Measurement, Method
from cmverify.cases.common import adapters, materials, warm
from cmverify.cases.hard import broken
from cmverify.cases.hard.tensors import tensor
from cmverify.judge.norms import relative_l2

if TYPE_CHECKING:
    from solver.material import Material

TOLERANCE = 1e-12
# The sparse factorisation that judges takes a minute at 120.
LADDER = {Level.QUICK: (20,), Level.STANDARD: (20, 60), Level.PAPER: (20, 60)}


@dataclass(frozen=True)
class Body:
    """A material whose bonds break.

    `spared` says whether the body can spare them; None where that depends on chance, which a
    larger body has more of.
    """

    name: str
    material: Callable[[], Material]
    m: float = 3
    calibration: str = "lattice"
    spared: bool | None = True
    share: float = 0.3


def _elastic(make: Callable[[], Any]) -> Callable[[], Material]:
    from solver import ElasticTensor

    return lambda: ElasticTensor(make())


def solve(body: Body, n: int) -> Measurement:
    """Solve, and compare with a factorisation; or be refused, and look at the spectrum."""
    from solver import NegativeCurvatureError
    from solver.analyses.statics import solve as solve_statics

    material = body.material()
    discretisation = broken.scene(
        material, n, broken.at_random(body.share), body.m, calibration=body.calibration
    ).discretise()
    unknowns = discretisation.operator.shape[0]
    negative = broken.negative_directions(discretisation)
    found = {"negative": float(negative)}
    try:
        solution = solve_statics(discretisation, tolerance=TOLERANCE)
    except NegativeCurvatureError:
        found |= {"refused": 1.0, "misjudged": float(negative == 0)}
        return Measurement(unknowns, found)
    s = solution.statistics
    wanted = broken.direct_solution(discretisation)
    found |= {
        "refused": 0.0,
        "misjudged": float(negative > 0),
        "difference": relative_l2(solution.unknowns[:, discretisation.operator.active], wanted),
        "energy": broken.energy_defect(solution),
        "iterations": float(s.iterations),
        "residual": s.residual,
    }
    if body.share:
        found["damage"] = _damage_error(body, n, solution)
    return Measurement(s.unknowns, found, statistics=adapters.solver_statistics(s))


def _damage_error(body: Body, n: int, solution: Any) -> float:
    """Of the damage (Eq. 105) against the bonds that were taken away, where families are whole."""
    from solver import recovery

    d = solution.discretisation
    lattice, family = d.lattice, d.family
    number, (rows, columns) = lattice.number(), lattice.rows_columns
    gone = broken.at_random(body.share)(lattice, family)
    lost = np.zeros(lattice.count)
    for o, (dx, dy) in enumerate(family.offsets[: family.size // 2]):
        other = number[rows + dy, columns + dx]
        both = gone[o] & (other >= 0)
        lost[both] += family.fraction[o]
        lost[other[both]] += family.fraction[o]
    whole = np.abs(lattice.points).max(axis=1) < 0.5 - (body.m + 0.5) / n
    return relative_l2(recovery.damage(solution)[whole], lost[whole] / family.fraction.sum())


def _isotropic(poisson: float, plane: Any = "stress") -> Callable[[], Material]:
    return lambda: _elastic(partial(materials.isotropic, poisson, plane))()


def _conductor() -> Material:
    from solver import ConductivityTensor

    return ConductivityTensor(materials.conductivity(34.0, np.pi / 8))


BODIES = (
    Body("stress ν = 0.2", _isotropic(0.2)),
    Body("stress ν = 1/3", _isotropic(1 / 3)),
    Body("stress ν = 0.4", _isotropic(0.4)),
    Body("stress ν = 0.49", _isotropic(0.49), spared=None),
    Body("stress ν = 0.49, m = 5", _isotropic(0.49), m=5),
    Body("strain ν = 0.36", _isotropic(0.36, "strain"), spared=False),
    # Whole, with a bulk margin of 0.0035: at 60 cells the clamped edge is too much for it.
    Body("strain ν = 0.3796, whole", _isotropic(0.3796, "strain"), spared=None, share=0.0),
    Body(
        "carbon/epoxy 30°",
        lambda: _elastic(partial(tensor, "carbon/epoxy", 30.0))(),
        calibration="positive",
    ),
    Body("conduction 34 : 1 at π/8", _conductor, calibration="positive"),
)


def _name(body: Body) -> str:
    return f"bond/{body.calibration} {body.name}"


def _checks(body: Body) -> tuple[Check, ...]:
    name = _name(body)
    judged = Check(name, "misjudged", equals=dict.fromkeys((20, 60), 0.0), source="signs of pivots")
    if body.spared is None:
        return (judged,)
    return (
        judged,
        Check(
            name,
            "refused",
            equals=dict.fromkeys((20, 60), 1.0 - body.spared),
            source="inertia",
        ),
        *(
            (
                Check(name, "difference", {20: 1e-9}, source="sparse factorisation", exact=True),
                Check(name, "energy", {20: 1e-9}, source="sum over bonds", exact=True),
                Check(name, "damage", {20: 1e-12}, source="bonds counted one by one", exact=True),
                Check(
                    name, "residual", {20: TOLERANCE}, source="the tolerance asked for", exact=True
                ),
            )
            if body.spared
            else ()
        ),
    )


CASES = (
    Case(
        name="hard-damage",
        title="Thirty per cent of the bonds removed at random",
        section="Sect. 3",
        equations=("Eq. 105",),
        tags=("hard", "elasticity", "conduction", "damage"),
        shows=(
            "Damaged bodies of every sign are solved like a direct solver would, with the energy "
            "of the bonds that are left in balance; where damage makes a direction of negative "
            "energy the solver says so instead of returning numbers."
        ),
        methods=tuple(
            Method(_name(b), "bond", partial(solve, b), LADDER, warm.both) for b in BODIES
        ),
        checks=tuple(check for b in BODIES for check in _checks(b)),
        quantities={
            "refused": "1 if a direction of negative energy was met (NegativeCurvatureError)",
            "negative": "independent displacements of negative energy, from the signs of pivots",
            "misjudged": "1 if there are such displacements but no refusal, or the reverse",
            "difference": "relative L2 difference from a sparse factorisation",
            "energy": "twice the energy of the bonds against the work of the load, relative",
            "damage": "relative L2 error of the damage (Eq. 105), particles with whole families",
            "iterations": "Krylov iterations to a residual of 1e-12",
            "residual": "relative residual at the end",
        },
        primary="difference",
        featured=_name(BODIES[0]),
        length="L",
        timed=False,
    ),
)
