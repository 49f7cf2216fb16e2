"""Whatever is not finite is refused by every closed form, not handed on."""

from collections.abc import Callable

import numpy as np
import pytest

from references.analytic import (
    compact_tension,
    conduction,
    elasticity,
    hole,
    kinking,
    lekhnitskii,
    potential_drop,
    tetrachiral,
    voigt,
)

C = np.array([[1.0, 0.2, 0.1], [0.2, 0.8, 1 / 6], [0.1, 1 / 6, 1 / 3]])
D = np.array([[5.0, 2.0], [2.0, 1.0]])
ONE = elasticity.equilibrium_polynomials(C, 1)[:1]

FORMS: dict[str, Callable[[float], object]] = {
    "displacement KI": lambda v: lekhnitskii.crack_tip_displacement(C, 1.0, 0.5, v, 0.0),
    "displacement KII": lambda v: lekhnitskii.crack_tip_displacement(C, 1.0, 0.5, 0.0, v),
    "gradient": lambda v: lekhnitskii.crack_tip_gradient(C, 1.0, 0.5, v, 0.0),
    "stress": lambda v: lekhnitskii.crack_tip_stress(C, 1.0, 0.5, v, 0.0),
    "stress KII": lambda v: lekhnitskii.crack_tip_stress(C, 1.0, 0.5, 0.0, v),
    "rotation": lambda v: lekhnitskii.crack_tip_rotation(C, 1.0, 0.5, 1.0, v),
    "energy release": lambda v: lekhnitskii.energy_release_rate(C, v, 0.0),
    "hoop factors": lambda v: kinking.hoop_factors(C, 0.1, v, 1.0),
    "hoop angle": lambda v: kinking.hoop_factors(C, v, 1.0, 1.0),
    "turned axes": lambda v: voigt.turned_axes(C, v),
    "isotropic": lambda v: voigt.isotropic_voigt(v, 0.3),
    "compact load": lambda v: compact_tension.stress_intensity(v, 1.0, 1.0, 0.5),
    "compact thickness": lambda v: compact_tension.stress_intensity(1.0, v, 1.0, 0.5),
    "compact width": lambda v: compact_tension.stress_intensity(1.0, 1.0, v, 0.5),
    "toughness": lambda v: compact_tension.critical_load(v, 1.0, 1.0, 0.5),
    "interface": lambda v: tetrachiral.interface_stiffness(1.0, 0.3, v, 1.0),
    "cell": lambda v: tetrachiral.cell_geometry(v, 0.3),
    "spring": lambda v: tetrachiral.effective_voigt(v, 1.0, 0.3),
    "weights": lambda v: elasticity.combine(ONE, [v]),
    "hole angle": lambda v: hole.edge_hoop_stress(C, v),
    "hole tension": lambda v: hole.edge_hoop_stress(C, 0.0, tension_angle=v),
    "hole ratio": lambda v: hole.eccentric_angle(0.3, v),
    "hole eccentric": lambda v: hole.eccentric_angle(v),
    "hole remote": lambda v: hole.hole_stress(C, 2.0, 0.0, 1.0, 1.0, (v, 0.0, 0.0)),
    "exponential": lambda v: conduction.harmonic_exponential(D, v),
    "amplitude": lambda v: conduction.harmonic_exponential(D, 1.0, v),
    "source power": lambda v: conduction.PointSource(D, v),
    "source position": lambda v: conduction.PointSource(D, 1.0, (0.0, v)),
    "instantaneous heat": lambda v: conduction.InstantaneousSource(D, v),
    "instantaneous capacity": lambda v: conduction.InstantaneousSource(D, 1.0, v),
    "instantaneous position": lambda v: conduction.InstantaneousSource(D, 1.0, 1.0, (v, 0.0)),
    "strip width": lambda v: potential_drop.strip_potential(0.1, 0.1, 0.5, v),
    "conductivity": lambda v: potential_drop.johnson(0.5, 1.0, kx=v),
    "probe": lambda v: potential_drop.johnson(0.5, v),
}


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("form", list(FORMS))
def test_non_finite_arguments_are_refused(form: str, value: float) -> None:
    with pytest.raises(ValueError, match=r"finite|positive|between|stable|inside the strip"):
        FORMS[form](value)
