"""One solid, one family, one calibration: what its symbol says, confirmed by bond energies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from cmverify.case import Array

if TYPE_CHECKING:
    from solver.material import AreaRule, Calibration, Family, Material, Moduli

#: Calibrations and laws that are compared; None is the default law.
CHOICES: tuple[tuple[Calibration, str | None], ...] = (
    ("continuum", None),
    ("lattice", "TwoHarmonic"),
    ("lattice", "UniformShear"),
    ("positive", None),
    ("positive", "UniformShear"),
)


@dataclass(frozen=True)
class Assessment:
    """What the symbol says of a calibrated solid.

    Attributes
    ----------
    solid, calibration, law, m
        What was judged.
    kind : str
        See `solver.material.stability.Stability`; "unrepresentable" where there are no such moduli.
    margin : float
        Smallest relative eigenvalue of the condensed symbol; NaN without moduli.
    wave_vector : pair of float
        Where, rad per cell.
    lowest, highest : float
        Extreme eigenvalues of the full symbol (rotations times the spacing as unknowns) over the
        Brillouin zone, relative to the largest entry of the stiffness over the spacing squared.
    non_negative : bool
        Whether no bond has a negative modulus.
    confirmed : bool or None
        Whether the energy of the bonds in the worst wave agrees; None where nothing is claimed.
    remark : str
        The solver's refusal, if it refuses.
    """

    solid: str
    calibration: str
    law: str | None
    m: float
    kind: str
    margin: float = np.nan
    wave_vector: tuple[float, float] = (np.nan, np.nan)
    lowest: float = np.nan
    highest: float = np.nan
    non_negative: bool = False
    confirmed: bool | None = None
    remark: str = ""

    @property
    def stable(self) -> bool:
        """Whether bodies of it can be solved at all."""
        return self.kind in ("positive", "central", "indefinite")


def material(tensor: Array) -> Material:
    """An elastic solid of a (3, 3) matrix, a conductor of a (2, 2) one."""
    from solver import ConductivityTensor, ElasticTensor

    return ElasticTensor(tensor) if tensor.shape == (3, 3) else ConductivityTensor(tensor)


def law_of(name: str | None) -> Any:
    """The angular law of that name; None stays None."""
    import solver

    return getattr(solver, name)() if name else None


def extreme_eigenvalues(family: Family, moduli: Moduli, count: int = 24) -> tuple[float, float]:
    """Smallest and largest eigenvalue of the full symbol over the zone, N/m⁴ (or W/(m³ K)).

    Rotations count as θ Δx. At k = 0 the displacements' eigenvalues vanish: that corner is left
    out, so that the smallest one of a stable solid is that of its longest wave on the grid.
    """
    from solver.material import brillouin_zone
    from solver.material.symbol import symbol

    scale = 1.0 / moduli.scales(family.spacing)
    values = symbol(family, moduli, brillouin_zone(count)) * np.outer(scale, scale)
    eigenvalues = np.linalg.eigvalsh(values)
    return float(eigenvalues.min()), float(eigenvalues.max())


def judge(
    solid: str,
    tensor: Array,
    m: float,
    calibration: Calibration,
    law: str | None = None,
    area_rule: AreaRule = "partial",
    count: int = 48,
) -> Assessment:
    """Calibrate, assess, and confirm.

    Parameters
    ----------
    solid : str
        A name for tables.
    tensor : ndarray, shape (3, 3) or (2, 2)
    m, calibration, law, area_rule
        As in `solver.Scene`; the law by name.
    count : int
        Grid points along a half axis of the Brillouin zone.
    """
    from cmverify.cases.common import bond_energies
    from solver import CalibrationError, Family
    from solver.material import ElasticModuli, assess, calibrated

    family = Family(m, 1.0, area_rule)
    try:
        moduli = calibrated(family, material(tensor), calibration, law_of(law))
    except CalibrationError as error:
        exist = calibration == "positive" and bond_energies.non_negative_moduli_exist(
            family, tensor
        )
        claimed = None if calibration != "positive" else not exist
        return Assessment(
            solid, calibration, law, m, "unrepresentable", confirmed=claimed, remark=str(error)
        )
    found = assess(family, moduli, count)
    confirmed: bool | None = None
    if isinstance(moduli, ElasticModuli):
        unstable = bond_energies.is_unstable(family, moduli, np.array(found.wave_vector))
        confirmed = unstable == (found.kind == "inadmissible")
        if not confirmed and np.isneginf(found.margin):
            confirmed = bond_energies.rotation_changes_sign(family, moduli)
    lowest, highest = extreme_eigenvalues(family, moduli)
    scale = np.abs(tensor).max()
    return Assessment(
        solid,
        calibration,
        law,
        m,
        found.kind,
        found.margin,
        found.wave_vector,
        lowest / scale,
        highest / scale,
        moduli.non_negative,
        confirmed,
    )


def compare(
    solid: str, tensor: Array, m: float, area_rule: AreaRule = "partial"
) -> list[Assessment]:
    """Every calibration and law of `CHOICES` for one solid (conduction has no shear laws)."""
    choices = CHOICES if tensor.shape == (3, 3) else tuple((c, None) for c, law in CHOICES)
    unique = dict.fromkeys(choices)
    return [judge(solid, tensor, m, c, law, area_rule) for c, law in unique]
