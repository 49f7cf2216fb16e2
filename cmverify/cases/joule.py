"""Resistive heating that feeds thermal expansion (Sects. 4 and 5 chained), with its energy.

What two electrodes supply, what the bonds make of it and what leaves through the sinks are one
number, for anisotropic conductors and every treatment of surfaces. Where contacts are electrodes
and sinks at once, temperature and potential of an isotropic conductor are tied to each other in
any body (F. Kohlrausch, Ann. Phys. 306 (1900) 132):

    T = σ/(2κ) φ (V − φ),

held against a plate with a hole; and a bar between such contacts grows by α σ V² L/(12 κ).
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from cmverify.case import Case, Check, Level, Measurement, Method, OrderBand
from cmverify.cases.common import adapters, warm
from cmverify.cases.surfaces.bodies import held
from cmverify.faults.changes import result, scaled
from cmverify.faults.fault import Fault
from cmverify.judge.norms import relative_l2

M = 3
VOLTAGE, SIGMA, KAPPA, ALPHA = 2.0, 3.0, 0.5, 0.01
LENGTH, WIDTH = 2.0, 1.0
TREATMENTS = ("none", "volume", "extrapolated")


def balanced(surface: Any, n: int) -> Measurement:
    """Powers of an anisotropic plate with a crack."""
    from solver import Crack, ElasticTensor, Scene, rectangle
    from solver.analyses import joule

    body = Scene(
        rectangle(LENGTH, WIDTH),
        1.0 / n,
        ElasticTensor.isotropic(1.0, 0.2),
        held((-0.2, 0.5 / n), (0.2, 0.5 / n)),
        m=M,
        surface=surface,
        cracks=[Crack((0.0, -0.6), (0.02, 0.1))],
    )
    chain = joule.run(
        body,
        plus=rectangle(0.2, 0.2, (0.7, 0.1)),
        minus=rectangle(0.2, 0.2, (-0.7, -0.1)),
        sink=lambda x, y: np.abs(y) > 0.5 * WIDTH - 1.5 / n,
        voltage=VOLTAGE,
        resistivities=(1.0, 3.0),
        conductivities=(2.0, 0.7),
        expansions=(0.01, 0.02),
        angle_degrees=25.0,
        tolerance=1e-11,
    )
    return Measurement(chain.heat.statistics.unknowns, {"imbalance": chain.imbalance})


def contacts(scale: float, n: int) -> Measurement:
    """Temperature over potential around a hole, and how a bar grows.

    `scale` is, for tests, a factor on what is expected.
    """
    from scipy.integrate import trapezoid

    from solver import (
        ConductivityTensor,
        ElasticTensor,
        ElectricConductivityTensor,
        ExpansionTensor,
        Scene,
        Support,
        disc,
        rectangle,
    )
    from solver.analyses.joule import expanded, heated

    def end(side: int) -> Any:
        return lambda x, y: side * x > 0.5 * LENGTH - 1e-6

    def chain(region: Any) -> tuple[Any, Any, Any]:
        common: dict[str, Any] = {
            "region": region, "spacing": 1.0 / n, "m": M, "surface": "extrapolated",
        }  # fmt: skip
        current = Scene(
            material=ElectricConductivityTensor.isotropic(SIGMA),
            supports=[Support.edge(end(1), potential=VOLTAGE), Support.edge(end(-1), potential=0)],
            **common,
        ).solve(tolerance=1e-11)
        cold = [Support.edge(end(side), temperature=0.0) for side in (1, -1)]
        thermal = Scene(material=ConductivityTensor.isotropic(KAPPA), supports=cold, **common)
        return common, current, heated(thermal, current).solve(tolerance=1e-11)

    _, current, heat = chain(rectangle(LENGTH, WIDTH) - disc(0.25, (0.1, 0.05)))
    phi = current.potential
    exact = scale * SIGMA / (2 * KAPPA) * phi * (VOLTAGE - phi)
    common, _, warm_bar = chain(rectangle(LENGTH, 0.5 * WIDTH))
    body = Scene(
        material=ElasticTensor.isotropic(1.0, 0.2),
        supports=held((-0.2, 0.5 / n), (0.2, 0.5 / n)),
        **common,
    )
    grown = expanded(body, warm_bar, ExpansionTensor.isotropic(ALPHA)).solve(tolerance=1e-11)
    at, u = grown.surface_points, grown.surface_displacement[:, 0]
    ends = []
    for side in (1, -1):
        face = np.abs(at[:, 0] - side * 0.5 * LENGTH) < 1e-6
        order = np.argsort(at[face, 1])
        ends.append(float(trapezoid(u[face][order], at[face, 1][order])) / (0.5 * WIDTH))
    longer = scale * ALPHA * SIGMA * VOLTAGE**2 * LENGTH / (12 * KAPPA)
    return Measurement(
        heat.statistics.unknowns,
        {
            "temperature": relative_l2(heat.temperature, exact),
            "elongation": abs((ends[0] - ends[1]) / longer - 1.0),
        },
        adapters.solver_seconds(heat.statistics),
        adapters.solver_statistics(heat.statistics),
    )


_BALANCES = tuple(
    Method(f"bond/{surface}", "bond", partial(balanced, surface),
           ({Level.QUICK: (10,)} if surface == "extrapolated" else {})
           | {Level.STANDARD: (10, 20), Level.PAPER: (10, 20)}, warm.conduction)
    for surface in TREATMENTS
)  # fmt: skip

CASES = (
    Case(
        name="joule",
        title="Joule's heat and the expansion that it feeds",
        section="Sects. 4 and 5",
        equations=("Eq. 112", "Eq. 119", "Eq. 176"),
        tags=("joule", "electrical", "thermoelastic", "conduction"),
        shows=(
            "What electrodes supply, what bonds make and what leaves are one number; around a hole "
            "temperature follows potential as Kohlrausch says, and a bar grows as in closed form."
        ),
        methods=(
            *_BALANCES,
            Method("bond/contacts", "bond", partial(contacts, 1.0),
                   {Level.STANDARD: (10, 20, 40), Level.PAPER: (10, 20, 40, 80)},
                   warm.conduction),
        ),
        checks=(
            *(Check(m.name, "imbalance", {10: 1e-8}, exact=True,
                    source="energy is conserved: the solver's tolerance")
              for m in _BALANCES),
            *(
                Check("bond/contacts", quantity, bounds, order=OrderBand(1.5, 2.5, fitted=True),
                      source="closed form; measured with half as much again, second order of both "
                      "fields")
                for quantity, bounds in (
                    ("temperature", {10: 1.6e-2, 20: 4.2e-3, 40: 1.1e-3}),
                    ("elongation", {10: 1e-2, 20: 2.8e-3, 40: 7.5e-4}),
                )
            ),
        ),
        quantities={
            "imbalance": "largest difference of the powers supplied, made and removed",
            "temperature": "relative L2 difference from Kohlrausch's σ φ (V − φ)/(2κ)",
            "elongation": "relative error of the bar's elongation",
        },
        primary="imbalance",
        featured="bond/extrapolated",
        length="W",
        timed=False,
    ),
)  # fmt: skip
FAULTS = (
    Fault("heat of bonds + 1 %", "solver.recovery.dissipation", scaled(1.01), "recovery"),
    Fault("energies at the surface + 1 %",
          "solver.operators.surface_stiffness.SurfaceStiffness.energies",
          result(lambda found: (1.01 * found[0], found[1])), "recovery"),
)  # fmt: skip
