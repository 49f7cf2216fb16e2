"""Energy of a homogeneous strain while the material turns (Fig. 4).

The bonds of a regular grid have few directions. Moduli calibrated for the integral over all
directions therefore store an energy that depends on how the material lies in the grid, which a
homogeneous strain shows: W(ζ) over the exact ½ ε·C(ζ)·ε, the figure's abscissa being ζ. Here the
resolution is m itself, Δx = δ/m.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from cmverify.case import (
    Array,
    Case,
    Check,
    Curve,
    Level,
    LinePlot,
    Measurement,
    Method,
    OrderBand,
)
from cmverify.cases.common import materials
from cmverify.cases.common.bond_energies import energy_of_strain
from cmverify.judge.norms import worst

if TYPE_CHECKING:
    from solver.material import Calibration

#: The solids of Fig. 4, C1111 = C2222 = 1; the second is also that of Fig. 2.
SOLIDS = {
    "square": np.array([[1.0, 0.2, 0.0], [0.2, 1.0, 0.0], [0.0, 0.0, 1.0 / 3.0]]),
    "anisotropic": materials.TENSORS["Fig. 2"],
}
#: Engineering strains (ε11, ε22, 2 ε12) of the figure's two columns.
STRAINS = {"extension": np.array([1.0, 0.0, 0.0]), "shear": np.array([0.0, 0.0, 1.0])}
DEGREES = np.arange(0.0, 180.1, 5.0)
EVERY = {
    Level.QUICK: (2, 3, 4, 5),
    Level.STANDARD: (2, 3, 4, 5, 6, 7, 8),
    Level.PAPER: (2, 3, 4, 5, 6, 7, 8),
}
SOURCE = "rounding: Fig. 4's ratio is 1 on the lattice's own sums"


@dataclass(frozen=True)
class Turning:
    """How bonds are calibrated; for tests, a factor on the C11 they are calibrated to."""

    calibration: Calibration
    distortion: float = 1.0


def energy_ratio(voigt: Array, turning: Turning, m: float) -> Array:
    """Lattice energy over the exact one, (angles of `DEGREES`, strains of `STRAINS`).

    The rotation of the particles is that of the strain, zero: relaxing it would change nothing,
    for no calibration couples it to homogeneous strain.
    """
    from solver import ElasticTensor, Family
    from solver.material import ElasticModuli, calibrate

    family = Family(m, 1.0 / m)
    given = voigt.copy()
    given[0, 0] *= turning.distortion
    rows = []
    for degrees in DEGREES:
        exact = materials.turned(voigt, degrees)
        # Turned by the solver: the reference turns the exact one.
        solid = ElasticTensor(given).rotated(float(np.radians(degrees)))
        moduli = calibrate(family, solid, turning.calibration)
        assert isinstance(moduli, ElasticModuli)
        energy = energy_of_strain(family, moduli)[:3, :3]
        rows.append([(e @ energy @ e) / (e @ exact @ e) for e in STRAINS.values()])
    return np.array(rows)


def turn(turning: Turning, m: int) -> Measurement:
    """Deviation from the exact energy and ripple over ζ, for both solids and both strains."""
    from solver import Family

    found: dict[str, float] = {"deviation": 0.0, "ripple": 0.0}
    lines = []
    for solid, voigt in SOLIDS.items():
        ratio = energy_ratio(voigt, turning, m)
        for strain, values in zip(STRAINS, ratio.T, strict=True):
            deviation = float(np.abs(values - 1.0).max())
            found[f"{solid}, {strain}"] = deviation
            found["deviation"] = worst((found["deviation"], deviation))
            found["ripple"] = worst((found["ripple"], np.ptp(values)))
            curve = Curve("energy", DEGREES, values, np.ones_like(values))
            lines.append(
                LinePlot(
                    f"{strain.capitalize()} of the {solid} solid, {turning.calibration} (Fig. 4)",
                    "orientation of the material, ζ (degrees)",
                    "$W/W_\\mathrm{exact}$",
                    (curve,),
                    over_resolutions=True,
                    joined=True,
                    reference_label="exact",
                )
            )
    bonds = Family(m, 1.0 / m).size
    return Measurement(bonds, found, statistics={"bonds of a family": bonds}, lines=tuple(lines))


CASES = (
    Case(
        name="turned-energy",
        title="Macroelastic energy of a homogeneous strain as the material turns",
        section="Sect. 2.2.1",
        equations=("Eqs. 43–51", "Eqs. 65–70", "Eqs. 77–78"),
        figures=("Fig. 4",),
        tags=("energy", "elasticity"),
        shows=(
            "The paper's calibration makes a lattice stiffer or softer as the material turns, by "
            "15 % at m = 2 and by 2 % at m = 5, as its Fig. 4 says; calibrated on the lattice's "
            "own sums the energy is exact at every angle and every m from 2 to 8."
        ),
        methods=tuple(
            Method(f"bond/{c}", "bond", partial(turn, Turning(c)), EVERY)
            for c in materials.CALIBRATIONS
        ),
        checks=(
            Check("bond/lattice", "deviation", {2: 1e-12}, source=SOURCE, exact=True),
            Check("bond/positive", "deviation", {2: 1e-12}, source=SOURCE, exact=True),
            Check(
                "bond/continuum",
                "deviation",
                {2: 0.155, 3: 0.053, 4: 0.025, 6: 0.0115, 7: 0.014, 8: 0.0075},
                source="Fig. 4: 15 % at m = 2, 2 % at m = 5; measured elsewhere, a fifth more",
            ),
            # A quadrature error: about third order in the bonds' number of directions, but it
            # jumps from m to m with the offsets that enter. Measured 0.21 … 0.0045, order 2.9.
            Check(
                "bond/continuum",
                "ripple",
                {2: 0.25, 3: 0.08, 4: 0.04, 5: 0.015, 8: 0.006},
                order=OrderBand(2.2, 3.6, fitted=True),
                source="Sect. 2.2.1: m > 3 represents the energy correctly",
            ),
        ),
        quantities={
            "deviation": "largest deviation of W/W_exact from 1, both solids and strains",
            "ripple": "largest minus smallest W/W_exact over the angles, the worst of the four",
            **{
                f"{solid}, {strain}": f"largest deviation, {solid} solid in {strain}"
                for solid in SOLIDS
                for strain in STRAINS
            },
        },
        primary="deviation",
        featured="bond/continuum",
        length="δ",
        timed=False,
    ),
)
