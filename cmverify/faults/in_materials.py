"""Faults of materials: tensors, moduli, the strains of a bond."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from cmverify.faults.changes import argument, field, first_bond, one_nan, result, scaled, times
from cmverify.faults.fault import Fault

M = "solver.material"
Function = Callable[..., Any]


def _normal_and_shear(moduli: Any) -> Any:
    if not hasattr(moduli, "shear"):
        return moduli
    return dataclasses.replace(moduli, normal=moduli.shear, shear=moduli.normal)


def _as_strain(right: Function) -> Function:
    def wrong(cls: Any, E: float, nu: float, plane: str = "stress") -> Any:
        return right(cls, E, nu, "strain" if plane == "stress" else "stress")

    return wrong


def _poisson_transposed(right: Function) -> Function:
    """nu12 taken for nu21: ν21 = ν12 E2/E1."""

    def wrong(cls: Any, E1: float, E2: float, G12: float, nu12: float, **kwargs: Any) -> Any:
        return right(cls, E1, E2, G12, nu12 * E2 / E1, **kwargs)

    return wrong


def _assessed(family: Any, moduli: Any) -> Any:
    from solver.material import assess

    return assess(family, moduli)


FAULTS = (
    Fault(
        "normal moduli + 1 %", f"{M}.calibration.calibrate", field("normal", times(1.01)), "moduli"
    ),
    Fault(
        "shear moduli + 1 %", f"{M}.calibration.calibrate", field("shear", times(1.01)), "moduli"
    ),
    Fault(
        "shear moduli of the other sign",
        f"{M}.calibration.calibrate",
        field("shear", times(-1.0)),
        "moduli",
    ),
    Fault(
        "normal and shear moduli swapped",
        f"{M}.calibration.calibrate",
        result(_normal_and_shear),
        "moduli",
    ),
    Fault(
        "one bond stiffer by 5 %",
        f"{M}.calibration.calibrate",
        field("normal", first_bond),
        "moduli",
    ),
    Fault("one modulus NaN", f"{M}.calibration.calibrate", field("normal", one_nan), "moduli"),
    Fault(
        "conductivities + 1 %",
        f"{M}.calibration.calibrate",
        field("conductivity", times(1.01)),
        "moduli",
    ),
    Fault(
        "one bond conducts better by 5 %",
        f"{M}.calibration.calibrate",
        field("conductivity", first_bond),
        "moduli",
    ),
    Fault(
        "plane strain for plane stress",
        f"{M}.tensors.ElasticTensor.isotropic",
        _as_strain,
        "tensors",
    ),
    Fault(
        "nu12 for nu21", f"{M}.tensors.ElasticTensor.orthotropic", _poisson_transposed, "tensors"
    ),
    Fault(
        "elastic tensor turned the other way",
        f"{M}.tensors.ElasticTensor.rotated",
        argument(1, times(-1.0)),
        "tensors",
    ),
    Fault(
        "conductivity turned the other way",
        f"{M}.tensors.GradientTensor.rotated",
        argument(1, times(-1.0)),
        "tensors",
    ),
    Fault(
        "rotation of stress of the other sign",
        f"{M}.tensors.stress_rotation",
        argument(0, times(-1.0)),
        "tensors",
    ),
    Fault("compliance + 1 %", f"{M}.tensors.ElasticTensor.compliance", scaled(1.01), "tensors"),
    Fault(
        "material axis off by 1 degree",
        f"{M}.tensors.ElasticTensor.orthotropy_angle",
        result(lambda angle: None if angle is None else angle + np.radians(1.0)),
        "tensors",
    ),
    Fault(
        "principal conductivities swapped",
        f"{M}.tensors.GradientTensor.principal",
        result(lambda found: (found[1], found[0], found[2])),
        "tensors",
    ),
    Fault("influence moment + 1 %", f"{M}.influence.Influence.moment", scaled(1.01), "moduli"),
    Fault("bond weights + 1 %", f"{M}.moduli.bond_weights", scaled(1.01), "moduli"),
    Fault(
        "area fractions of bonds all one",
        f"{M}.family.Family.fraction",
        result(np.ones_like),
        "areas",
    ),
    Fault(
        "stability margin of the other sign",
        f"{M}.symbol.BulkSymbol.margins",
        scaled(-1.0),
        "stability",
    ),
    Fault(
        "all solids taken to be stable",
        f"{M}.admission.require_admissible",
        lambda right: (
            lambda family, moduli: dataclasses.replace(_assessed(family, moduli), kind="positive")
        ),
        "stability",
    ),
    Fault("strains of bonds + 1 %", "solver.material.strains.elongations", scaled(1.01), "strains"),
    Fault(
        "rotations turn bonds the other way",
        "solver.material.strains.elongations",
        argument(3, times(-1.0)),
        "strains",
    ),
    Fault(
        "rotations turn bonds 1 % too far",
        "solver.material.strains.elongations",
        argument(3, times(1.01)),
        "strains",
    ),
)
