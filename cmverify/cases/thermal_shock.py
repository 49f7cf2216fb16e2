"""A quenched ceramic plate (Jiang et al. 2012; Bourdin et al. 2014): the jump at which flaws run.

C. P. Jiang, X. F. Wu, J. Li, F. Song, Y. F. Shao, X. H. Xu, P. Yan (2012, *Acta Materialia* 60)
dropped hot alumina plates, 10 mm wide, into water; B. Bourdin, J.-J. Marigo, C. Maurini and P.
Sicsic (2014, *Phys. Rev. Lett.* 112) computed their cracks. Their bodies have no flaws, and where
the first cracks start is a matter of the strength, which in bonds the horizon makes. What does not
depend on it is when a crack that is there goes on: the energy release rate of an edge crack under
the temperatures of an instant, against Bueckner's weight function with the stress of a free strip,

    ΔT_c(a) = √(G_c/𝒢(a)),      𝒢(a) = −dU/da at a jump of one degree,

U the energy of the bonds' mechanical strain at fixed temperatures. ΔT_c grows with a: such cracks
run in, and stop. That only mechanical strain breaks bonds is tested bond by bond in
`tests/solver/fracture`.
"""

from __future__ import annotations

from functools import cache, partial
from typing import Any

import numpy as np

from cmverify.case import Array, Case, Check, Curve, Level, LinePlot, Measurement, Method
from cmverify.cases.common import adapters
from cmverify.faults.changes import scaled
from cmverify.faults.fault import Fault

M = 3
#: An alumina, as in computations of these tests: Pa, 1, 1/K, J/m², W/(m K), J/(m³ K).
YOUNG, POISSON, EXPANSION, TOUGHNESS = 370e9, 0.3, 7.5e-6, 42.47
CONDUCTIVITY, CAPACITY = 31.0, 3980.0 * 880.0
#: Width, m, length over width, and the time after the quench, s.
WIDTH, LENGTH, TIME = 10e-3, 4, 0.05
#: ℓ = √(κ t), m, and a/W of the cracks.
DEPTH = float(np.sqrt(CONDUCTIVITY / CAPACITY * TIME))
RATIOS = (0.2, 0.4)


def jump(crack: float, scale: float = 1.0) -> float:
    """ΔT_c of the weight function, K; `scale` on it for tests."""
    from references.analytic.edge_crack import intensity, quenched, thermal_stress

    def stress(x: Array) -> Array:
        return thermal_stress(x, WIDTH, lambda d: quenched(d, WIDTH, DEPTH), YOUNG, EXPANSION)

    return scale * float(np.sqrt(YOUNG * TOUGHNESS)) / intensity(stress, crack, WIDTH)


def stored(crack: float, n: int, surface: Any) -> tuple[float, Any]:
    """U of the plate cracked to `crack`, per degree squared, J/m, and the solution."""
    from references.analytic.edge_crack import quenched
    from solver import (
        Crack,
        ElasticTensor,
        ExpansionTensor,
        Load,
        Scene,
        Support,
        recovery,
        rectangle,
    )

    h = WIDTH / n

    def near(row: float) -> Any:
        return lambda x, y: np.hypot(x - 0.25 * WIDTH - 0.5 * h, y - row * h) < 0.1 * h

    change = Load.temperature(
        lambda x, y: quenched(x + 0.5 * WIDTH, WIDTH, DEPTH), ExpansionTensor.isotropic(EXPANSION)
    )
    solution = Scene(
        rectangle(WIDTH, LENGTH * WIDTH),
        h,
        ElasticTensor.isotropic(YOUNG, POISSON),
        [Support.where(near(0.5), u1=0.0, u2=0.0), Support.where(near(2.5), u1=0.0)],
        [change],
        cracks=[Crack((-WIDTH, 0.0), (crack - 0.5 * WIDTH, 0.0))],
        m=M,
        surface=surface,
    ).solve(tolerance=1e-9)
    return float(recovery.strain_energy_density(solution).sum()) * h * h, solution


def jumps(surface: Any, n: int) -> tuple[list[float], Any]:
    """ΔT_c from the bonds, K, one a crack, and the last solution."""
    h, found, solution = WIDTH / n, [], None
    for ratio in RATIOS:
        before, _ = stored(ratio * WIDTH - h, n, surface)
        after, solution = stored(ratio * WIDTH + h, n, surface)
        found.append(float(np.sqrt(TOUGHNESS * 2 * h / (before - after))))
    return found, solution


def quench(scale: float, surface: Any, n: int) -> Measurement:
    """ΔT_c from the bonds over the weight function's; `scale` on that, for tests."""
    return beside(*jumps(surface, n), scale)


def beside(found: list[float], solution: Any, scale: float = 1.0) -> Measurement:
    """What `jumps` gives beside the weight function."""
    wanted = [jump(ratio * WIDTH, scale) for ratio in RATIOS]
    fine = np.linspace(0.02, 0.5, 100)
    at = np.array(RATIOS)
    return Measurement(
        solution.statistics.unknowns,
        {
            f"jump at {ratio:g} W": abs(one / other - 1)
            for ratio, one, other in zip(RATIOS, found, wanted, strict=True)
        },
        adapters.solver_seconds(solution.statistics),
        adapters.solver_statistics(solution.statistics),
        lines=(
            LinePlot(
                "Jump of temperature at which an edge crack goes on",
                "a/W",
                "ΔT_c (K)",
                (
                    Curve("bonds", at, np.array(found),
                          np.array([jump(r * WIDTH) for r in fine]), fine),
                ),
            ),
        ),
    )  # fmt: skip


@cache
def warm_up() -> None:
    """Compile the kernels."""
    stored(0.25 * WIDTH, 8, "extrapolated")


def checks(surface: str, bounds: dict[str, dict[int, float]]) -> tuple[Check, ...]:
    """Of one treatment of surfaces."""
    return tuple(
        Check(f"bond/{surface}", quantity, bound,
              source="Bueckner's weight function, itself good to 1 %; measured with half as much "
              "again (with the volume method the strip is too stiff at its edges, where it is "
              "cold)")
        for quantity, bound in bounds.items()
    )  # fmt: skip


CASES = (
    Case(
        name="thermal-shock",
        title="A quenched ceramic plate: the temperature jump at which an edge crack goes on",
        section="Sect. 5",
        equations=("Eq. 176",),
        tags=("thermoelastic", "elasticity", "fracture"),
        shows=(
            "Fifty milliseconds after alumina is dropped into water an edge crack of a fifth of "
            "the width goes on at a jump of 78 K, one of twice that at 115 K: cracks run in and "
            "stop. The bonds' energy release rate gives the jumps of the weight function."
        ),
        methods=(
            Method("bond/extrapolated", "bond", partial(quench, 1.0, "extrapolated"),
                   {Level.QUICK: (20,), Level.STANDARD: (20, 40), Level.PAPER: (20, 40, 80)},
                   warm_up),
            Method("bond/volume", "bond", partial(quench, 1.0, "volume"),
                   {Level.STANDARD: (20, 40), Level.PAPER: (20, 40, 80)},
                   warm_up),
        ),
        checks=(
            *checks("extrapolated", {
                "jump at 0.2 W": {20: 5.2e-2, 40: 2e-2, 80: 2e-2},
                "jump at 0.4 W": {20: 1e-2, 40: 1.1e-2, 80: 1.1e-2},
            }),
            *checks("volume", {
                "jump at 0.2 W": {20: 6e-2, 40: 6.6e-2, 80: 5.1e-2},
                "jump at 0.4 W": {20: 2.3e-2, 40: 2.9e-2, 80: 2.6e-2},
            }),
        ),
        quantities={f"jump at {r:g} W": f"ΔT_c of a crack of {r:g} W" for r in RATIOS},
        primary="jump at 0.2 W",
        featured="bond/extrapolated",
        length="W",
    ),
)  # fmt: skip

FAULTS = (
    Fault("intensity of edge cracks + 2 %", "references.analytic.edge_crack.intensity",
          scaled(1.02), "closed forms"),
)  # fmt: skip
