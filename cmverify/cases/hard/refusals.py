"""Refusals: of the named kind, for a reason that other means confirm, with advice that works."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from cmverify.case import Array, Case, Check, Level, Measurement, Method
from cmverify.cases.common import bond_energies, materials, warm
from cmverify.cases.hard import bodies
from cmverify.cases.hard.tensors import forty_to_one, tensor
from cmverify.judge.norms import worst

LADDER = dict.fromkeys(Level, (24,))


@dataclass(frozen=True)
class Refusal:
    """A tensor, settings with which it must be refused, and what the refusal must be.

    Attributes
    ----------
    error : name of the exception's class in `solver`
    says : part of its message
    remedy : whether it can recommend something
    """

    name: str
    voigt: Callable[[], Array]
    settings: dict[str, Any]
    error: str
    says: str
    remedy: bool


def _confirmed(refusal: Refusal, voigt: Array, m: float, message: str) -> bool:
    """Whether the reason holds by other means than the solver's."""
    from solver import ElasticTensor, Family
    from solver.material import ElasticModuli, calibrate

    family, settings = Family(m), refusal.settings
    if refusal.error == "CalibrationError":
        horizons = range(2, 9) if "at any m" in message else (m,)
        return not any(bond_energies.non_negative_moduli_exist(Family(k), voigt) for k in horizons)
    calibration = settings.get("calibration", "lattice")
    moduli = calibrate(family, ElasticTensor(voigt), calibration, _law(settings))
    assert isinstance(moduli, ElasticModuli)
    if "passes through zero" in message:
        return bond_energies.rotation_changes_sign(family, moduli)
    wave = bond_energies.named_wave(message)
    return wave is not None and bond_energies.is_unstable(family, moduli, wave)


def _law(settings: dict[str, Any]) -> Any:
    import solver

    return getattr(solver, settings["law"])() if "law" in settings else None


def refuse(refusal: Refusal, n: int) -> Measurement:
    """Ask for what must be refused, confirm the reason, and follow the advice."""
    import solver

    voigt = refusal.voigt()
    voigt = voigt / np.linalg.norm(voigt)
    exact = bodies.field_of(voigt, (1, 2))
    settings = {**refusal.settings}
    m = settings.pop("m", 5)
    settings["law"] = _law(refusal.settings)
    found = {"refused": 0.0, "confirmed": 0.0}
    unknowns = 0
    try:
        bodies.solve(voigt, exact, n, m, **settings)
    except getattr(solver, refusal.error) as error:
        message = str(error)
        found["refused"] = float(refusal.says in message)
        found["confirmed"] = float(_confirmed(refusal, voigt, m, message))
        advice = bond_energies.named_remedy(message)
        found["advice"] = float((advice is not None) == refusal.remedy)
        if advice is not None:
            solution = bodies.solve(voigt, exact, n, advice.pop("m", m), **advice)
            found["field"] = worst(bodies.errors(solution, exact).values())
            unknowns = solution.statistics.unknowns
    return Measurement(unknowns, found)


def unreachable() -> Array:
    """C66 > C12 and yet no sum of non-negative bonds, in however many directions."""
    return np.array([[2.25, -1.05, 0.87], [-1.05, 0.96, -0.28], [0.87, -0.28, 1.45]])


REFUSALS = (
    Refusal(
        "strain ν = 0.40", partial(materials.isotropic, 0.40, "strain"), {},
        "InadmissibleMaterialError", "condensed symbol is not positive", False,
    ),
    Refusal(
        "strain ν = 0.38, m = 3", partial(materials.isotropic, 0.38, "strain"), {"m": 3},
        "InadmissibleMaterialError", "condensed symbol is not positive", True,
    ),
    Refusal(
        "stress ν = 1/3, two-harmonic", partial(materials.isotropic, 1 / 3), {"law": "TwoHarmonic"},
        "InadmissibleMaterialError", "passes through zero", True,
    ),
    Refusal(
        "carbon/epoxy, two-harmonic", partial(tensor, "carbon/epoxy"), {"law": "TwoHarmonic"},
        "InadmissibleMaterialError", "passes through zero", True,
    ),
    Refusal(
        "carbon/epoxy 30°, uniform shear", partial(tensor, "carbon/epoxy", 30.0),
        {"law": "UniformShear"},
        "InadmissibleMaterialError", "condensed symbol is not positive", True,
    ),
    Refusal(
        "40 : 1, positive, m = 3", forty_to_one, {"calibration": "positive", "m": 3},
        "InadmissibleMaterialError", "a pattern of rotations strains no shear bond", True,
    ),
    Refusal(
        "stress ν = 0.40, positive", partial(materials.isotropic, 0.40),
        {"calibration": "positive"},
        "CalibrationError", "no non-negative bond moduli exist for this solid at any m", True,
    ),
    Refusal(
        "C66 > C12 out of reach, positive", unreachable, {"calibration": "positive", "m": 3},
        "CalibrationError", "at any m", True,
    ),
    Refusal(
        "strain ν = 0.40, positive", partial(materials.isotropic, 0.40, "strain"),
        {"calibration": "positive"}, "CalibrationError", "Use finite elements", False,
    ),
)  # fmt: skip

_NAMES = {r.name: f"bond/{r.settings.get('calibration', 'lattice')} {r.name}" for r in REFUSALS}

CASES = (
    Case(
        name="hard-refusals",
        title="What cannot be solved is refused, by name and with advice that works",
        section="Sect. 2.2.1",
        tags=("hard", "elasticity", "stability"),
        shows=(
            "Unstable and unrepresentable solids are refused before any work, for reasons that the "
            "energy of a wave and linear programs confirm; the calibration, law or m that the "
            "message recommends then gives the exact field."
        ),
        methods=tuple(
            Method(_NAMES[r.name], "bond", partial(refuse, r), LADDER, warm.statics)
            for r in REFUSALS
        ),
        checks=tuple(
            check
            for r in REFUSALS
            for check in (
                *(
                    Check(_NAMES[r.name], q, equals={24: 1.0}, source=bodies.CONFIRMED)
                    for q in ("refused", "confirmed", "advice")
                ),
                *(
                    (Check(_NAMES[r.name], "field", {24: 1e-9}, source=bodies.SOURCE, exact=True),)
                    * r.remedy
                ),
            )
        ),
        quantities={
            "refused": "1 if the error is of the named kind and gives the named reason",
            "confirmed": "1 if another method confirms the reason",
            "advice": "1 if it recommends something exactly where something is stable",
            "field": "relative L2 error of the quadratic field, solved as recommended",
        },
        primary="refused",
        featured=_NAMES[REFUSALS[0].name],
        length="L",
        timed=False,
    ),
)
