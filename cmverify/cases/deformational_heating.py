"""Deformational heating and cooling (Sect. 5, after Eq. 176): adiabatic changes, damping, energy.

Each end of a pair receives −T₀ ½ |ξ| α Λ Δv² (k_n a_n ṡ + k_t a_t γ̇), the adjoint of the thermal
force. A uniform strain then changes the temperature by −T₀ β:ε/c, waves that leave heat no time run
at the adiabatic speed, ρc² = C11 + T₀ β11²/c, and a strip in bending is damped as Zener and, more
closely, Lifshitz and Roukes say.
"""

from __future__ import annotations

from functools import cache, partial
from typing import Any

import numpy as np

from cmverify.case import Array, Case, Check, Level, Measurement, Method
from cmverify.cases.thermoelastic import random_solid
from cmverify.faults.changes import scaled
from cmverify.faults.fault import Fault
from cmverify.judge.norms import relative_l2, worst

M = 2
YOUNG, POISSON, ALPHA = 1.0, 0.25, 0.2
#: Absolute temperature and heat capacity.
T0, CAPACITY = 1.0, 1.0
#: Thickness of the strip over its length, and ωτ of Zener's peak.
SLENDER, PEAK = 0.1, 1.0
#: Steps a period, and periods after the first, in which the initial temperature settles.
STEPS, PERIODS = 40, 2


def uniform(n: int) -> float:
    """Temperature of a random solid in a uniform strain, over its own."""
    from references.analytic.thermoelastic import adiabatic_change
    from solver import Scene, Support, rectangle
    from solver.analyses.thermoelastic import adiabatic_temperature

    solid, expands = random_solid(3)
    slope = np.array([[0.1, -0.3], [0.2, 0.4]])
    solution = Scene(
        rectangle(1.0, 1.0),
        1.0 / n,
        solid,
        [
            Support.layer(
                M + 0.5,
                displacement=lambda x, y: np.stack([x, y], axis=-1) @ slope.T,
                rotation=0.5 * (slope[1, 0] - slope[0, 1]),
            )
        ],
        m=M,
    ).solve(tolerance=1e-12)
    inside = np.abs(solution.points).max(axis=1) < 0.5 - (M + 0.6) / n
    found = adiabatic_temperature(solution, expands, 300.0, CAPACITY)[inside]
    strain = slope[0, 0], slope[1, 1], slope[0, 1] + slope[1, 0]
    wanted = adiabatic_change(solid.voigt, expands.voigt, strain, 300.0, CAPACITY)
    return relative_l2(found, np.full_like(found, wanted))


def moved(solid: Any, height: float, spacing: float, conductivity: float, **options: Any) -> Any:
    """A coupled motion of a bar or strip of length one, its surface insulated."""
    from solver import ConductivityTensor, Scene, rectangle
    from solver.analyses import thermoelastic

    region = rectangle(1.0, height)
    supports = options.pop("supports", [])
    expansion = options.pop("expansion")
    return thermoelastic.run(
        Scene(region, spacing, solid, supports, m=M, density=1.0),
        Scene(
            region,
            spacing,
            ConductivityTensor.isotropic(conductivity),
            m=M,
            heat_capacity=CAPACITY,
        ),
        expansion,
        T0,
        **options,
    )


def frequency(signal: Array, step: float) -> tuple[float, float]:
    """ω and 1/Q of a damped oscillation at every step, the midpoint rule's stretch taken out."""
    before = np.stack([signal[1:-1], -signal[:-2]], axis=1)
    a, b = np.linalg.lstsq(before, signal[2:], rcond=None)[0]
    turn = float(np.arccos(0.5 * a / np.sqrt(b)))
    return 2.0 / step * np.tan(0.5 * turn), -float(np.log(b)) / turn


def wave(scale: float, n: int) -> tuple[float, float]:
    """Error of the stiffening of a standing P wave, and the imbalance of energy."""
    from references.analytic.thermoelastic import adiabatic_voigt
    from solver import ElasticTensor, ExpansionTensor, Support

    solid = ElasticTensor.isotropic(YOUNG, POISSON, "strain")
    first = float(solid.voigt[0, 0])
    found, last = [], None
    for alpha in (1e-9, 1.5 * ALPHA):
        step = 2.0 / np.sqrt(first) / STEPS
        expansion = ExpansionTensor.isotropic(alpha, "strain", POISSON)
        last = moved(
            solid,
            0.3,
            1.0 / (3 * n),
            1e-9,
            supports=[Support.where(lambda x, y: x == x, u2=0.0, rotation=0.0)],
            expansion=expansion,
            step=step,
            steps=STEPS,
            velocity=lambda x, y: np.stack([np.sin(np.pi * x), 0 * x], axis=-1),
        )
        shape = np.sin(np.pi * last.points[:, 0])
        found.append(frequency(last.displacement[:, 0] @ shape, step)[0])
    gain = (found[1] / found[0]) ** 2 - 1
    adiabatic = adiabatic_voigt(solid.voigt, expansion.voigt, scale * T0, CAPACITY)
    return abs(gain / (adiabatic[0, 0] / first - 1) - 1), balance(last)


def balance(run: Any) -> float:
    """Largest imbalance over the largest energy."""
    total = run.kinetic + run.elastic + run.thermal
    return float(np.abs(run.imbalance).max() / np.abs(total).max())


def strip(scale: float, n: int) -> tuple[float, float]:
    """Error of the loss of a free strip in its first bending mode, and the imbalance."""
    from references.analytic.thermoelastic import bending_loss, relaxation
    from solver import ElasticTensor, ExpansionTensor, Scene, modes, rectangle

    solid = ElasticTensor.isotropic(YOUNG, POISSON)
    h = SLENDER / n
    mode = modes.solve(Scene(rectangle(1.0, SLENDER), h, solid, m=M, density=1.0), 1)
    omega, shape = float(mode.frequencies[0]), mode.unknowns[0][:2]
    _, capacity = relaxation(YOUNG, POISSON, ALPHA, T0, CAPACITY)
    conductivity = SLENDER**2 * capacity * omega / (np.pi**2 * PEAK)
    step = 2.0 * np.pi / omega / STEPS
    run = moved(
        solid,
        SLENDER,
        h,
        conductivity,
        expansion=ExpansionTensor.isotropic(ALPHA),
        step=step,
        steps=(1 + PERIODS) * STEPS,
        displacement=shape.T,
    )
    signal = np.einsum("kin,in->k", run.displacement, shape)[STEPS:]
    found, loss = frequency(signal, step)
    wanted = float(
        bending_loss(YOUNG, POISSON, ALPHA, scale * T0, CAPACITY, conductivity, SLENDER, found)
    )
    return abs(loss / wanted - 1), balance(run)


def heating(scale: float, n: int) -> Measurement:
    """Everything at n cells across the strip; `scale` on T₀ of the closed forms, for tests."""
    gain, first = wave(scale, n)
    loss, second = strip(scale, n)
    return Measurement(
        round(40 * n * n),
        {
            "uniform": uniform(14),
            "waves": gain,
            "loss": loss,
            "balance": worst([first, second]),
        },
    )


@cache
def warm_up() -> None:
    """Compile the kernels."""
    strip(1.0, 4)


CASES = (
    Case(
        name="deformational-heating",
        title="Temperatures of strained bodies, adiabatic waves and thermoelastic damping",
        section="Sect. 5",
        equations=("Eq. 176",),
        tags=("thermoelastic", "elasticity"),
        shows=(
            "Straining a body heats and cools it by the adjoint of the thermal force: exactly in a "
            "uniform strain, adiabatic in fast waves, lossy in a strip that vibrates; energy is "
            "kept to rounding."
        ),
        methods=(
            Method(
                "bond/volume",
                "bond",
                partial(heating, 1.0),
                {Level.QUICK: (6,), Level.STANDARD: (6, 12), Level.PAPER: (6, 12, 18)},
                warm_up,
            ),
        ),
        checks=(
            Check("bond/volume", "uniform", {6: 1e-10},
                  source="rounding: the sums over bonds are β = C A", exact=True),
            Check("bond/volume", "balance", {6: 1e-10},
                  source="rounding: the midpoint rule keeps the energy of linear equations",
                  exact=True),
            Check("bond/volume", "waves", {6: 3e-2, 12: 9e-3},
                  source="adiabatic stiffness C11 + T₀ β11²/c; measured with half as much again"),
            Check("bond/volume", "loss", {6: 0.12, 12: 6.3e-2},
                  source="Lifshitz and Roukes; measured with half as much again (a strip of a few "
                  "cells whose surfaces are the volume method's, of first order)"),
        ),
        quantities={
            "uniform": "temperature of a uniform strain, random solid",
            "waves": "stiffening of a standing P wave over the adiabatic one",
            "loss": "1/Q of a strip in its first bending mode, ωτ = 1",
            "balance": "energy not accounted for over the energy",
        },
        primary="loss",
        featured="bond/volume",
        length="h",
        timed=False,
    ),
)  # fmt: skip

R = "references.analytic.thermoelastic"
FAULTS = (
    Fault("thermal forces and their adjoint + 2 %",
          "solver.operators.thermal_force.thermal_force", scaled(1.02), "thermal"),
    Fault("adiabatic temperature + 1 %",
          "solver.analyses.thermoelastic.adiabatic_temperature", scaled(1.01), "thermal"),
    Fault("adiabatic temperature of the other sign", f"{R}.adiabatic_change", scaled(-1.0),
          "closed forms"),
    Fault("thermoelastic loss - 15 %", f"{R}.bending_loss", scaled(0.85), "closed forms"),
)  # fmt: skip
