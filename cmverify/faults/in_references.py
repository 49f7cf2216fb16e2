"""Faults of the references: closed forms, finite elements, stored tables, the block lattice."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from cmverify.faults.changes import argument, one_nan, result, scaled
from cmverify.faults.fault import Fault

A, F = "references.analytic", "references.fem"
Function = Callable[..., Any]


def _stiffer(voigt: Any) -> Any:
    """C11 1 % too large."""
    voigt = np.array(voigt, dtype=float)
    voigt[0, 0] *= 1.01
    return voigt


def _modes_swapped(right: Function) -> Function:
    def wrong(voigt: Any, x: Any, y: Any, KI: float, KII: float) -> Any:
        return right(voigt, x, y, KII, KI)

    return wrong


def _planes_swapped(right: Function) -> Function:
    def wrong(young: float, poisson: float, plane: str = "stress") -> Any:
        return right(young, poisson, "strain" if plane == "stress" else "stress")

    return wrong


def _stored(factor: float, *names: str) -> Callable[[Function], Function]:
    """Arrays of stored references whose names are among these (all for none) times a factor."""

    def change(right: Function) -> Function:
        def wrong(*args: Any, **kwargs: Any) -> Any:
            found = right(*args, **kwargs)
            arrays = {
                key: factor * value if key in names else value
                for key, value in found.arrays.items()
            }
            return dataclasses.replace(found, arrays=arrays)

        return wrong

    return change


_turn = result(lambda angle: angle + np.radians(5.0))

FAULTS = (
    # ---- closed forms -------------------------------------------------------------------
    Fault(
        "K of a pair of cracks + 25 %",
        f"{A}.crack_pair.intensities",
        scaled(1.25),
        "closed forms",
    ),
    Fault(
        "crack-tip displacement + 1 %",
        f"{A}.lekhnitskii.crack_tip_displacement",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "crack-tip displacement with C11 + 1 %",
        f"{A}.lekhnitskii.crack_tip_displacement",
        argument(0, _stiffer),
        "closed forms",
    ),
    Fault(
        "crack-tip modes swapped",
        f"{A}.lekhnitskii.crack_tip_displacement",
        _modes_swapped,
        "closed forms",
    ),
    Fault(
        "one crack-tip displacement NaN",
        f"{A}.lekhnitskii.crack_tip_displacement",
        result(one_nan),
        "closed forms",
    ),
    Fault(
        "crack-tip gradient + 1 %",
        f"{A}.lekhnitskii.crack_tip_gradient",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "crack-tip stress + 1 %", f"{A}.lekhnitskii.crack_tip_stress", scaled(1.01), "closed forms"
    ),
    Fault(
        "crack-tip rotation + 1 %",
        f"{A}.lekhnitskii.crack_tip_rotation",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "crack-tip rotation of the other sign",
        f"{A}.lekhnitskii.crack_tip_rotation",
        scaled(-1.0),
        "closed forms",
    ),
    Fault(
        "energy release rate + 1 %",
        f"{A}.lekhnitskii.energy_release_rate",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "characteristic roots + 1 %",
        f"{A}.lekhnitskii.characteristic_roots",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "terms of the tip's series + 1 %",
        f"{A}.crack_series.crack_tip_term",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "interaction integral + 1 %", f"{A}.interaction.intensities", scaled(1.01), "closed forms"
    ),
    Fault(
        "displacement about a hole + 1 %",
        f"{A}.hole.hole_displacement",
        scaled(1.01),
        "closed forms",
    ),
    Fault("stress about a hole + 1 %", f"{A}.hole.hole_stress", scaled(1.01), "closed forms"),
    Fault(
        "hoop stress of a hole + 1 %", f"{A}.hole.edge_hoop_stress", scaled(1.01), "closed forms"
    ),
    Fault(
        "hoop intensity factors + 1 %", f"{A}.kinking.hoop_factors", scaled(1.01), "closed forms"
    ),
    Fault("hoop kink angle + 5 degrees", f"{A}.kinking.hoop_kink_angle", _turn, "closed forms"),
    Fault(
        "polynomial displacement + 1 %",
        f"{A}.elasticity.PolynomialDisplacement.displacement",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "polynomial stress + 1 %",
        f"{A}.elasticity.PolynomialDisplacement.stress",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "polynomial rotation + 1 %",
        f"{A}.elasticity.PolynomialDisplacement.rotation",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "body force of a polynomial + 1 %",
        f"{A}.elasticity.PolynomialDisplacement.body_force",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "equilibrium fields of C11 + 1 %",
        f"{A}.elasticity.equilibrium_polynomials",
        argument(0, _stiffer),
        "closed forms",
    ),
    Fault(
        "polynomial temperature + 1 %",
        f"{A}.conduction.Polynomial.value",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "temperature gradient + 1 %",
        f"{A}.conduction.Polynomial.gradient",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "flux of closed forms + 1 %",
        f"{A}.conduction.SteadyField.flux",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "flux of closed forms of the other sign",
        f"{A}.conduction.SteadyField.flux",
        scaled(-1.0),
        "closed forms",
    ),
    Fault(
        "source of closed forms + 1 %",
        f"{A}.conduction.SteadyField.source",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "exponential temperature + 1 %",
        f"{A}.conduction.Exponential.value",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "temperature of a point source + 1 %",
        f"{A}.conduction.PointSource.value",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "temperature of a heat pulse + 1 %",
        f"{A}.conduction.InstantaneousSource.value",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "two-lobe constants + 1 %",
        f"{A}.toughness.two_lobe_constants",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "fourfold constants + 1 %",
        f"{A}.toughness.fourfold_constants",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "quadrature of Eq. 92 + 1 %", f"{A}.toughness.fracture_energy", scaled(1.01), "closed forms"
    ),
    Fault(
        "continuum's effective energy + 1 %",
        f"{A}.toughness.effective_energy",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "axes turned the other way",
        f"{A}.voigt.turned_axes",
        argument(1, lambda angle: -angle),
        "closed forms",
    ),
    Fault(
        "stiffness of isotropic solids + 1 %",
        f"{A}.voigt.isotropic_voigt",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "plane stress and strain swapped",
        f"{A}.voigt.isotropic_voigt",
        _planes_swapped,
        "closed forms",
    ),
    Fault("wave speeds + 1 %", f"{A}.christoffel.wave_speeds", scaled(1.01), "closed forms"),
    Fault(
        "compact tension shape factor + 1 %",
        f"{A}.compact_tension.shape_factor",
        scaled(1.01),
        "closed forms",
    ),
    Fault("potential drop + 1 %", f"{A}.potential_drop.johnson", scaled(1.01), "closed forms"),
    Fault(
        "homogenised block lattice + 1 %",
        f"{A}.tetrachiral.effective_voigt",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "stiffness of interfaces + 1 %",
        f"{A}.tetrachiral.interface_stiffness",
        scaled(1.01),
        "closed forms",
    ),
    # ---- finite elements, stored or solved ----------------------------------------------
    Fault(
        "finite-element values + 1 %", f"{F}.evaluation.Field.at", scaled(1.01), "finite elements"
    ),
    Fault(
        "one finite-element value NaN",
        f"{F}.evaluation.Field.at",
        result(one_nan),
        "finite elements",
    ),
    Fault(
        "finite-element gradients + 1 %",
        f"{F}.evaluation.Field.gradient_at",
        scaled(1.01),
        "finite elements",
    ),
    Fault(
        "finite-element stress + 1 %",
        f"{F}.elasticity.ElasticSolution.stress_at",
        scaled(1.01),
        "finite elements",
    ),
    Fault(
        "finite-element flux + 1 %",
        f"{F}.conduction.ConductionSolution.flux_at",
        scaled(1.01),
        "finite elements",
    ),
    Fault("mass of finite elements + 1 %", f"{F}.body.Body.mass", scaled(1.01), "finite elements"),
    Fault(
        "motion of finite elements without damping",
        f"{F}.motion.moved",
        argument(3, lambda damping: (0.0, 0.0)),
        "finite elements",
    ),
    Fault(
        "heat capacity of finite elements in time + 1 %",
        f"{F}.in_time.warmed",
        argument(2, lambda capacities: [1.01 * one for one in capacities]),
        "finite elements",
    ),
    Fault(
        "finite elements' tractions + 1 %",
        f"{F}.elasticity._traction_load",
        scaled(1.01),
        "finite elements",
    ),
    Fault(
        "kink angle of largest release + 5 degrees",
        f"{F}.kinks.KinkTable.kink_angle",
        _turn,
        "finite elements",
    ),
    Fault(
        "release rate of kinks + 1 %",
        f"{F}.kinks.KinkTable.energy_release_rate",
        scaled(1.01),
        "finite elements",
    ),
    Fault(
        "stored displacement at a hole + 1 %",
        "references.provenance.load",
        _stored(1.01, "edge_displacement"),
        "stored tables",
    ),
    Fault(
        "stored stress at a hole + 1 %",
        "references.provenance.load",
        _stored(1.01, "section_stress"),
        "stored tables",
    ),
    Fault(
        "stored intensities + 1 %",
        "references.provenance.load",
        _stored(1.01, "isotropic", "bone", "anisotropic"),
        "stored tables",
    ),
    Fault(
        "stored stiffness of pinned bodies + 8 %",
        "references.provenance.load",
        _stored(1.08, "stiffness"),
        "stored tables",
    ),
    Fault(
        "stored K_I of pinned bodies + 10 %",
        "references.provenance.load",
        _stored(1.1, "KI"),
        "stored tables",
    ),
    Fault(
        "stored kink factors + 1 %",
        "references.provenance.load",
        _stored(1.01, "matrices"),
        "stored tables",
    ),
)
