"""A finite crack in an infinite anisotropic plane: calibrated tips on what they have not seen.

The disc of radius R = 1 holds a crack of half length a = 0.51 R, along the lattice or at 27° to it.
Far away there are σ22 = 1, σ12 = 1/2 and σ11 = −1 in the crack's axes: both modes and a stress
along the crack. Displacement and rotation of Lekhnitskii's closed form are prescribed in
the outer layer. Tips are calibrated on the singular field of a single tip in a small disc; here
they are two, with whatever places in their cells, and with all higher terms of the field.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from cmverify.case import Array, Case, Check, Level, Measurement, Method
from cmverify.cases.common import adapters, materials, sif, warm
from cmverify.faults.changes import scaled
from cmverify.faults.fault import Fault
from cmverify.judge.norms import relative_l2

if TYPE_CHECKING:
    from references.analytic.finite_crack import FiniteCrack
    from solver import Scene
    from solver.problem.tips import Tip

STIFFNESS = materials.TENSORS["fully anisotropic"] / 100.0
#: No tip lies on a border of cells.
HALF_LENGTH = 0.51
ANGLES = {"along rows": 0.0, "27°": float(np.radians(27.0))}
#: σ22, σ12 and σ11 far away, in the crack's axes.
REMOTE = (1.0, 0.5, -1.0)
M = 3
Ladder = Mapping[Level, tuple[int, ...]]
#: The ring in which stress intensity factors are measured.
RING = 0.45


@dataclass(frozen=True)
class Problem:
    """The crack's angle, rad, and for tests a factor on the reference."""

    angle: float = 0.0
    scale: float = 1.0

    @property
    def axes(self) -> Array:
        """Columns along and across the crack, shape (2, 2)."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.array([[c, -s], [s, c]])

    @property
    def field(self) -> FiniteCrack:
        """In the crack's axes."""
        from references.analytic.finite_crack import FiniteCrack
        from references.analytic.voigt import turned_axes

        return FiniteCrack(turned_axes(STIFFNESS, self.angle), HALF_LENGTH, *REMOTE)

    def _local(self, x: Array, y: Array) -> tuple[Array, Array]:
        own = np.stack([x, y], axis=-1) @ self.axes
        return own[..., 0], own[..., 1]

    def displacement(self, x: Array, y: Array) -> Array:
        """(..., 2), in σ R/C."""
        return self.field.displacement(*self._local(x, y)) @ self.axes.T

    def rotation(self, x: Array, y: Array) -> Array:
        """Half the curl, in σ/C."""
        return self.field.rotation(*self._local(x, y))


def scene_of(problem: Problem, tip: Tip, n: int) -> Scene:
    """The disc at spacing R/n."""
    from solver import Crack, ElasticTensor, Scene, Support, disc

    along = HALF_LENGTH * problem.axes[:, 0]
    return Scene(
        region=disc(1.0),
        spacing=1.0 / n,
        material=ElasticTensor(STIFFNESS),
        m=M,
        surface="extrapolated",
        cracks=[Crack(_point(-along), _point(along))],
        supports=[
            Support.layer(
                cells=M + 0.5, displacement=problem.displacement, rotation=problem.rotation
            )
        ],
        tip=tip,
    )


def _point(at: Array) -> tuple[float, float]:
    return float(at[0]), float(at[1])


def measure(problem: Problem, tip: Tip, n: int) -> Measurement:
    """Solve at spacing R/n and compare with the closed form."""
    from references.analytic.finite_crack import intensities

    solution = scene_of(problem, tip, n).solve(tolerance=1e-10)
    free = ~solution.prescribed
    exact = problem.scale * problem.displacement(*solution.points[free].T)
    right = _point(HALF_LENGTH * problem.axes[:, 0])
    wanted = problem.scale * np.array(intensities(HALF_LENGTH, *REMOTE[:2]))
    found = sif.interaction_integral(
        solution, right, problem.angle, RING, max(0.4, 1.02 * M / n / RING)
    )
    return Measurement(
        unknowns=solution.statistics.unknowns,
        quantities={
            "displacement": relative_l2(solution.displacement[free], exact),
            "K": float(np.hypot(*(found - wanted)) / np.hypot(*wanted)),
            "left as drawn": float(len(solution.discretisation.tips_left)),
            "iterations": float(solution.statistics.iterations),
        },
        seconds=adapters.solver_seconds(solution.statistics),
        statistics=adapters.solver_statistics(solution.statistics),
    )


LADDER: Ladder = {Level.QUICK: (30,), Level.STANDARD: (30, 60), Level.PAPER: (30, 60, 120)}
#: Of the others: the quick level has no time for them.
BESIDE: Ladder = {level: ladder for level, ladder in LADDER.items() if level != Level.QUICK}
MEASURED = "closed form of Lekhnitskii; measured with half as much again"


BOUNDS = (
    Check("drawn/along rows", "displacement", {30: 5e-3, 60: 2.7e-3, 120: 1e-3}, source=MEASURED),
    Check(
        "calibrated/along rows",
        "displacement",
        {30: 2.1e-4, 60: 9e-5, 120: 4.3e-5},
        source=MEASURED,
    ),
    Check("calibrated/along rows", "K", {30: 2.2e-3, 60: 2e-4, 120: 1e-4}, source=MEASURED),
    Check("drawn/27°", "displacement", {30: 4.3e-3, 60: 1.8e-3, 120: 1.2e-3}, source=MEASURED),
    Check("calibrated/27°", "displacement", {30: 9.6e-4, 60: 3.2e-4, 120: 7.1e-5}, source=MEASURED),
    *(
        Check(name, "left as drawn", equals={30: 0.0, 60: 0.0, 120: 0.0}, source="none has to be")
        for name in ("calibrated/along rows", "calibrated/27°")
    ),
)


def _case() -> Case:
    tips: tuple[Tip, ...] = ("drawn", "calibrated")
    return Case(
        name="finite-crack",
        title="Finite crack, both modes and a stress along it",
        section="Sect. 2.3.1 (crack problems)",
        equations=("Eqs. 79–83",),
        tags=("elasticity", "fracture"),
        shows=(
            "Tips that were calibrated on their singular fields make the error several times "
            "smaller on a problem that the calibration did not see."
        ),
        methods=tuple(
            Method(
                f"{tip}/{where}",
                "bond",
                partial(measure, Problem(angle), tip),
                LADDER if tip == "calibrated" and not angle else BESIDE,
                partial(warm.statics, "extrapolated"),
            )
            for where, angle in ANGLES.items()
            for tip in tips
        ),
        checks=BOUNDS,
        quantities={
            "displacement": "relative L2 error of the displacement",
            "K": "relative error of (K_I, K_II) by the interaction integral",
            "left as drawn": "tips that are not calibrated",
            "iterations": "Krylov iterations to a residual of 1e-10",
        },
        primary="displacement",
        featured="calibrated/along rows",
        length="R",
    )


CASES = (_case(),)


def _changed(factor: float) -> Any:
    """The stiffness that is added around a tip times a factor."""

    def change(right: Any) -> Any:
        def wrong(self: Any, values: Any) -> Any:
            return factor * right(self, values)

        return wrong

    return change


FAULTS = (
    Fault(
        "calibrated tips with half their stiffness",
        "solver.operators.tip_stiffness.TipStiffness.force",
        _changed(0.5),
        "bonds",
    ),
    Fault(
        "calibrated tips of the other sign",
        "solver.operators.tip_stiffness.TipStiffness.force",
        _changed(-1.0),
        "bonds",
    ),
    Fault(
        "displacement around a finite crack + 1 %",
        "references.analytic.finite_crack.FiniteCrack.displacement",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "K of a finite crack + 2 %",
        "references.analytic.finite_crack.intensities",
        lambda right: lambda *given: tuple(1.02 * k for k in right(*given)),
        "closed forms",
    ),
)
