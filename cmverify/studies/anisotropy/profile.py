"""One elastic solid: its bonds by calibration, which are stable, and what to expect of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from cmverify.case import Array
from cmverify.studies.stability.assessments import CHOICES, Assessment, compare, law_of
from cmverify.studies.stability.polar import Polar, micromoduli, polar

if TYPE_CHECKING:
    from solver.material import Calibration

#: Horizons, in cells, at which stability is told.
HORIZONS = (2, 3, 4, 5, 6, 7)
#: Mixities atan(K_II/K_I) at which kinks are told, degrees.
MIXITIES = np.linspace(0.0, 90.0, 19)
#: Directions, rad.
DIRECTIONS = np.linspace(0.0, np.pi, 73)


@dataclass(frozen=True, eq=False)
class Profile:
    """What is known of a solid.

    Attributes
    ----------
    solid : str
    voigt : (3, 3) array, Pa
    density : float, kg/m³
    m : float
        Horizon in cells at which bonds are judged.
    micromoduli : dict
        The six of Eqs. 65–70 for a horizon of 1 m, N/m⁵.
    polar : Polar
        Moduli over the direction, in closed form and of the bonds.
    assessments : list of Assessment
        Of every calibration and law at m.
    margins : dict of (calibration, law) to array
        Margins at `HORIZONS`; NaN where there are no such moduli, −∞ where rotations lose their
        stiffness.
    admissible : tuple of int
        Those of `HORIZONS` at which there are exact moduli none of which is negative.
    energies : dict of calibration to (angles (deg), W/W_exact (angles, 2))
        Of an extension and a shear as the material turns (Fig. 4).
    kinks : array, degrees
        Of a crack along axis 1 by the hoop criterion, at `MIXITIES`.
    speeds : (directions, 2) array, m/s
        Of the two plane waves along `DIRECTIONS`.
    hole : array
        Largest hoop stress around a round hole over the remote tension along `DIRECTIONS`.
    crack : array, Pa
        K_I²/G of cracks along `DIRECTIONS`.
    advice : str
        Which calibration to use, and why.
    """

    solid: str
    voigt: Array
    density: float
    m: float
    micromoduli: Mapping[str, float]
    polar: Polar
    assessments: list[Assessment]
    margins: Mapping[tuple[Calibration, str | None], Array]
    admissible: tuple[int, ...]
    energies: Mapping[Calibration, tuple[Array, Array]]
    kinks: Array
    speeds: Array
    hole: Array
    crack: Array
    advice: str

    def as_dict(self) -> dict[str, Any]:
        """Plain values, for JSON; None for what is not finite."""

        def plain(values: Any) -> Any:
            array = np.asarray(values, dtype=float)
            if array.ndim:
                return [plain(value) for value in array]
            return float(array) if np.isfinite(array) else None

        return {
            "solid": self.solid,
            "voigt": self.voigt.tolist(),
            "density": self.density,
            "m": self.m,
            "micromoduli": dict(self.micromoduli),
            "assessments": [
                {k: (plain(v) if isinstance(v, float) else v) for k, v in vars(one).items()}
                for one in self.assessments
            ],
            "margins": {
                "horizons": list(HORIZONS),
                **{named(*choice): plain(values) for choice, values in self.margins.items()},
            },
            "non-negative at m": list(self.admissible),
            "ripple": {name: ripple(ratio) for name, (_, ratio) in self.energies.items()},
            "kinks": {"mixity": MIXITIES.tolist(), "angle": self.kinks.tolist()},
            "directions": np.degrees(DIRECTIONS).tolist(),
            "speeds": self.speeds.tolist(),
            "hole": self.hole.tolist(),
            "crack modulus": self.crack.tolist(),
            "advice": self.advice,
        }


def named(calibration: str, law: str | None) -> str:
    """A calibration and its law, as tables say them."""
    return calibration if law is None else f"{calibration}, {law}"


@dataclass(frozen=True)
class Line:
    """A calibration in a table: words and numbers as they are printed."""

    name: str
    kind: str
    stable: bool
    margin: str
    negative: str
    margins: tuple[str, ...]


def lines(found: Profile) -> list[Line]:
    """Every calibration and law of a solid, as tables show them."""
    return [
        Line(
            named(one.calibration, one.law),
            one.kind,
            one.stable,
            _spelt(one.margin, ".3g"),
            "none" if one.non_negative else "–" if one.kind == "unrepresentable" else "some",
            tuple(_spelt(v) for v in found.margins[one.calibration, one.law]),  # type: ignore[index]
        )
        for one in found.assessments
    ]


def _spelt(value: float, form: str = ".2f") -> str:
    if value != value:
        return "none"
    return "−∞" if value == float("-inf") else f"{value:{form}}"


def ripple(ratio: Array) -> float:
    """Largest deviation of energies from the exact ones."""
    return float(np.abs(ratio - 1.0).max())


def profile(solid: str, voigt: Array, m: float = 5, density: float = 1.0) -> Profile:
    """Everything about a solid.

    Parameters
    ----------
    solid : str
        A name for tables.
    voigt : (3, 3) array, Pa
    m : float
        Horizon in cells.
    density : float, kg/m³

    Raises
    ------
    ValueError
        If the stiffness is not positive definite, m < 1 or the density is not positive.
    """
    from references.analytic.christoffel import wave_speeds
    from references.analytic.hole import edge_hoop_stress
    from references.analytic.kinking import hoop_kink_angle
    from references.analytic.lekhnitskii import energy_release_rate
    from solver import ElasticTensor, Family
    from solver.material import representable

    solid_tensor = ElasticTensor(voigt)
    voigt = np.array(solid_tensor.voigt)
    if not 1 <= m <= 20:
        raise ValueError(f"the horizon must be from 1 to 20 cells, not {m:g}")
    if not (np.isfinite(density) and density > 0):
        raise ValueError(f"the density must be positive, not {density:g}")
    assessments = compare(solid, voigt, m)
    mixity = np.radians(MIXITIES)
    around = np.linspace(0.0, 2 * np.pi, 361)
    energies = _energies(voigt, m)
    return Profile(
        solid,
        voigt,
        density,
        m,
        micromoduli(voigt),
        polar(solid, voigt, m),
        assessments,
        _margins(voigt),
        tuple(h for h in HORIZONS if representable(Family(h), solid_tensor)),
        energies,
        np.degrees([hoop_kink_angle(voigt, np.cos(a), np.sin(a)) for a in mixity]),
        wave_speeds(voigt, density, DIRECTIONS),
        np.array(
            [edge_hoop_stress(voigt, around, tension_angle=float(a)).max() for a in DIRECTIONS]
        ),
        np.array([1.0 / energy_release_rate(voigt, 1.0, 0.0, float(a)) for a in DIRECTIONS]),
        advice(voigt, m, assessments, energies),
    )


def _margins(voigt: Array) -> dict[tuple[Calibration, str | None], Array]:
    from solver import CalibrationError, ElasticTensor, Family
    from solver.material import assess, calibrate

    found = {}
    for calibration, law in CHOICES:
        values = []
        for m in HORIZONS:
            family = Family(m)
            try:
                moduli = calibrate(family, ElasticTensor(voigt), calibration, law_of(law))
                values.append(assess(family, moduli, 12).margin)
            except CalibrationError:
                values.append(np.nan)
        found[calibration, law] = np.array(values)
    return found


def _energies(voigt: Array, m: float) -> dict[Calibration, tuple[Array, Array]]:
    """W/W_exact over the turn of the material, of the calibrations that exist at every angle."""
    from cmverify.cases.common.materials import CALIBRATIONS
    from cmverify.cases.turned_energy import DEGREES, Turning, energy_ratio
    from solver import CalibrationError

    found = {}
    for calibration in CALIBRATIONS:
        try:
            found[calibration] = (DEGREES, energy_ratio(voigt, Turning(calibration), m))
        except CalibrationError:
            continue
    return found


def advice(
    voigt: Array,
    m: float,
    assessments: list[Assessment],
    energies: Mapping[Calibration, tuple[Array, Array]],
) -> str:
    """Which calibration and law to use, and why, in sentences.

    Exact ones come first, of these those without negative bonds, which any analysis takes; then
    stable ones with negative bonds, by their margins.
    """
    from solver import ElasticTensor, Family
    from solver.material.admission import remedy

    exact = [a for a in assessments if a.calibration != "continuum" and a.stable]
    without = [a for a in exact if a.non_negative]
    reasons = []
    if without:
        best = without[0]
        reasons.append(
            "homogeneous strains are exact at every angle and no bond has a negative modulus: "
            "every analysis takes it, fracture with criterion = 'total' too"
        )
    elif exact:
        # A positive operator before an indefinite one, then the larger margin.
        best = max(exact, key=lambda a: (a.kind != "indefinite", a.margin))
        reasons.append(
            "homogeneous strains are exact at every angle, but some bonds have negative moduli: "
            "fracture needs criterion = 'axial'"
        )
        if best.kind == "indefinite":
            reasons.append(
                "rotations have negative stiffness: solved in condensed form, and bodies with free "
                "corners, cracks and holes more often turn out unstable"
            )
    else:
        other = remedy(Family(m), ElasticTensor(voigt))
        return f"No exact calibration is stable at m = {m:g}. {other}"
    law = "" if best.law is None else f", law = {best.law}"
    said = f"Use calibration = {best.calibration!r}{law} (margin {best.margin:.2g}): "
    said += "; ".join(reasons) + "."
    paper = next(a for a in assessments if a.calibration == "continuum")
    if not paper.stable:
        said += " The paper's ('continuum') is unstable."
    elif "continuum" in energies:
        error = ripple(energies["continuum"][1])
        said += f" The paper's ('continuum') errs by up to {error:.1%} in energy at m = {m:g}."
    return said
