"""A strip of two solids that is heated evenly: it bends as finite elements and Timoshenko say.

Each solid expands by its own tensor; at the interface bonds of both end at shared nodes. Free of
supports but for a rigid motion, plane stress.
"""

from __future__ import annotations

from functools import cache, partial
from typing import Any

import numpy as np

from cmverify.case import Case, Check, Level, Measurement, Method, OrderBand
from cmverify.cases.common import adapters, warm
from cmverify.cases.surfaces.bodies import displacement_errors, held
from cmverify.faults.changes import scaled
from cmverify.faults.fault import Fault

M = 3
LENGTH = 4.0
#: Young's modulus, Poisson's ratio and expansion of the lower and the upper layer.
LOWER, UPPER = (1.0, 0.3, 0.01), (3.0, 0.2, 0.003)
#: Elements across the thickness of the reference: eight err by less than a tenth of what twelve
#: cells do.
ACROSS = {12: 8, 20: 16, 30: 16}


@cache
def layers(scale: float = 1.0) -> Any:
    """The strip of the reference; `scale`, for tests, is a factor on the lower expansion."""
    from references.analytic.voigt import isotropic_voigt
    from references.fem.bimetal import Layers

    (e1, nu1, a1), (e2, nu2, a2) = LOWER, UPPER
    strains = [(a, a, 0.0) for a in (scale * a1, a2)]
    return Layers(
        LENGTH, 1.0, isotropic_voigt(e1, nu1), isotropic_voigt(e2, nu2), strains[0], strains[1]
    )


def heated(scale: float, n: int) -> Measurement:
    """Displacement against finite elements, and the middle's curvature against Timoshenko's."""
    from references.fem.bimetal import displacement
    from solver import ElasticTensor, ExpansionTensor, Inclusion, Load, Scene, rectangle

    solids = [ElasticTensor.isotropic(E, nu) for E, nu, _ in (LOWER, UPPER)]
    expansions = [ExpansionTensor.isotropic(alpha) for *_, alpha in (LOWER, UPPER)]
    h = 1.0 / n
    solution = Scene(
        rectangle(LENGTH, 1.0),
        h,
        solids[0],
        held((0.5 * h, 0.5 * h), (1 + 0.5 * h, 0.5 * h)),
        [Load.temperature(1.0, expansions[0])],
        m=M,
        surface="extrapolated",
        inclusions=[
            Inclusion(rectangle(LENGTH, 0.5, (0.0, 0.25)), solids[1], expansion=expansions[1])
        ],
    ).solve()
    points, found = solution.points, solution.displacement
    wanted = displacement(layers(scale), points, ACROSS[n])
    middle = (np.abs(points[:, 1]) < h) & (np.abs(points[:, 0]) < 1.0)
    curvature = 2.0 * np.polyfit(points[middle, 0], found[middle, 1], 2)[0]
    return Measurement(
        solution.statistics.unknowns,
        {
            **displacement_errors(points, found, wanted),
            "curvature": abs(curvature / layers(scale).curvature() - 1),
        },
        adapters.solver_seconds(solution.statistics),
        adapters.solver_statistics(solution.statistics),
    )


CASES = (
    Case(
        name="bimetal-strip",
        title="A strip of two solids bends when it is heated",
        section="Sect. 5",
        equations=("Eq. 176",),
        tags=("thermoelastic", "elasticity"),
        shows=(
            "Two solids that expand differently bend a strip as quadratic finite elements say, at "
            "second order, and with Timoshenko's curvature."
        ),
        methods=(
            Method(
                "bond/extrapolated",
                "bond",
                partial(heated, 1.0),
                {Level.QUICK: (12,), Level.STANDARD: (12, 20), Level.PAPER: (12, 20, 30)},
                partial(warm.statics, "extrapolated"),
            ),
        ),
        checks=(
            Check("bond/extrapolated", "displacement", {12: 3e-3, 20: 9e-4, 30: 3.7e-4},
                  order=OrderBand(1.5, 3.0, fitted=True),
                  source="finite elements of second degree; measured with half as much again"),
            Check("bond/extrapolated", "largest", {12: 9.4e-3, 20: 5.2e-3, 30: 3.5e-3},
                  source="the same, at the corners of the interface, where stress is singular"),
            Check("bond/extrapolated", "curvature", {12: 5e-3},
                  source="Timoshenko's beam, whose layers do not hinder each other across the "
                  "strip; within half a per cent of it for strips four times as long as thick"),
        ),
        quantities={
            "displacement": "relative L2 error of the displacement, rigid motion aside",
            "largest": "largest error of the displacement over the largest displacement",
            "curvature": "curvature of the middle",
        },
        primary="displacement",
        featured="bond/extrapolated",
        length="H",
    ),
)  # fmt: skip

FAULTS = (
    Fault("finite elements of the bimetal + 1 %", "references.fem.bimetal.displacement",
          scaled(1.01), "finite elements"),
    Fault("curvature of a bimetal + 1 %", "references.fem.bimetal.Layers.curvature",
          scaled(1.01), "closed forms"),
)  # fmt: skip
