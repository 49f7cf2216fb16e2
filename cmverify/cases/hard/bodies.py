"""What the hard cases of elasticity share: a square with exact fields in its prescribed layer."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from cmverify.case import Array, Check, Level, Measurement, Method, OrderBand
from cmverify.cases.common import adapters, warm
from cmverify.judge.norms import relative_l2, worst

if TYPE_CHECKING:
    from references.analytic.elasticity import PolynomialDisplacement
    from solver.material import Calibration

SEED = 2022
TOLERANCE = 1e-13
LADDER = {
    Level.QUICK: (24,),
    Level.STANDARD: (24, 48, 96),
    Level.PAPER: (24, 48, 96, 160),
}
QUANTITIES = {
    "displacement": "relative L2 error of the displacement, quadratic field (exact on the lattice)",
    "rotation": "relative L2 error of the rotation, quadratic field (exact on the lattice)",
    "quartic": "relative L2 error of the displacement, equilibrium field of degrees 3 and 4",
    "iterations": "Krylov iterations to a residual of 1e-13, the more of both fields",
    "residual": "relative residual at the end, the larger of both fields",
    "margin": "stability margin: smallest relative eigenvalue of the condensed symbol",
}
SOURCE = "rounding: a quadratic field is exact on the lattice's own sums"
#: Of verdicts on refusals.
CONFIRMED = "energies of waves, linear programming, inertia"
# The prescribed layer takes up less of the body as it is refined, so that the error falls faster
# than with the second order of the lattice at first.
ORDER = OrderBand(1.7, 3.4, since=48)


@dataclass(frozen=True)
class Solid:
    """A tensor and how its bonds are calibrated.

    `distortion` is a factor on the C11 that the solver is given: tests see that it is noticed.
    """

    voigt: Callable[[], Array]
    calibration: Calibration = "lattice"
    m: float = 5
    distortion: float = 1.0


def field_of(voigt: Array, degrees: tuple[int, ...]) -> PolynomialDisplacement:
    """A random equilibrium field with every basis field of these degrees."""
    from references.analytic.elasticity import combine, equilibrium_polynomials

    fields = [f for degree in degrees for f in equilibrium_polynomials(voigt, degree)]
    weights = np.random.default_rng([SEED, *degrees]).normal(size=len(fields))
    return combine(fields, weights.tolist())


class Kinematics(Protocol):
    """Displacement (..., 2) and rotation of a field."""

    def displacement(self, x: Any, y: Any) -> Array:
        """u, m."""

    def rotation(self, x: Any, y: Any) -> Array:
        """Half the curl, rad."""


def solve(voigt: Array, exact: Kinematics, n: int, m: float = 5, **scene: Any) -> Any:
    """Solution of the square of side 1 at spacing 1/n with a field in its outer layer."""
    from solver import ElasticTensor, Scene, Support, rectangle

    tolerance = scene.pop("tolerance", TOLERANCE)
    settings: dict[str, Any] = {"region": rectangle(1.0, 1.0), "spacing": 1.0 / n, **scene}
    return Scene(
        material=ElasticTensor(voigt),
        m=m,
        supports=[
            # A family with partial areas reaches less than m + 1/2 cells.
            Support.layer(cells=m + 0.5, displacement=exact.displacement, rotation=exact.rotation)
        ],
        **settings,
    ).solve(tolerance=tolerance)


def errors(solution: Any, exact: Kinematics) -> dict[str, float]:
    """Relative L2 errors of displacement and (where there is one) rotation, free particles."""
    free = ~solution.prescribed
    x, y = solution.points[free].T
    found = {"displacement": relative_l2(solution.displacement[free], exact.displacement(x, y))}
    if len(solution.unknowns) == 3:
        found["rotation"] = relative_l2(solution.rotation[free], exact.rotation(x, y))
    return found


def measure(solid: Solid, n: int) -> Measurement:
    """Both fields of one solid: rounding for the quadratic one, discretisation for the other."""
    voigt = solid.voigt()
    voigt = voigt / np.linalg.norm(voigt)
    given = voigt.copy()
    given[0, 0] *= solid.distortion
    fields = field_of(voigt, (1, 2)), field_of(voigt, (3, 4))
    solutions = [solve(given, f, n, solid.m, calibration=solid.calibration) for f in fields]
    found = errors(solutions[0], fields[0])
    found["quartic"] = errors(solutions[1], fields[1])["displacement"]
    statistics = [s.statistics for s in solutions]
    found["iterations"] = float(max(s.iterations for s in statistics))
    found["residual"] = worst(s.residual for s in statistics)
    found["margin"] = statistics[0].margin
    return Measurement(
        statistics[0].unknowns,
        found,
        statistics={**adapters.solver_statistics(statistics[0]), "kind": statistics[0].kind},
    )


@dataclass(frozen=True)
class Expected:
    """One solid as a method, with what was measured for it at 24, 48, 96 and 160 cells.

    Bounds are these figures with room for half as much again.
    """

    name: str
    solid: Solid
    quartic: tuple[float, ...]
    iterations: tuple[int, ...]
    rotation: bool = True
    #: Of the error of what is exact but for rounding; near the limit it grows by 1/margin.
    floor: float = 1e-11
    ladder: Mapping[Level, tuple[int, ...]] = field(default_factory=lambda: LADDER)

    @property
    def method(self) -> Method:
        """The solid as a method."""
        run = partial(measure, self.solid)
        name = f"bond/{self.solid.calibration} {self.name}"
        return Method(name, "bond", run, self.ladder, warm.statics)

    @property
    def checks(self) -> tuple[Check, ...]:
        """What must hold for it."""
        name, room = self.method.name, 1.5
        quartic = {n: room * e for n, e in zip(self.ladder[Level.PAPER], self.quartic, strict=True)}
        steps = {
            n: room * i for n, i in zip(self.ladder[Level.PAPER], self.iterations, strict=True)
        }
        found = [
            Check(name, "displacement", {24: self.floor}, source=SOURCE, exact=True),
            Check(name, "residual", {24: TOLERANCE}, source="the tolerance asked for", exact=True),
            Check(
                name,
                "quartic",
                quartic,
                order=ORDER,
                source="measured with half as much again; second order",
            ),
            Check(name, "iterations", steps, source="measured with half as much again"),
        ]
        if self.rotation:
            found.append(Check(name, "rotation", {24: 10 * self.floor}, source=SOURCE, exact=True))
        return tuple(found)
