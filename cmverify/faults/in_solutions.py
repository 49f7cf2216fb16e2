"""Faults of what is read from a solution: fields, recovery, reactions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from cmverify.faults.changes import one_nan, result, scaled, swapped
from cmverify.faults.fault import Fault

Function = Callable[..., Any]


def _inside_the_body(right: Function) -> Function:
    """Neighbours whose bond is cut are taken for joined."""

    def wrong(bonds: Any, offset: tuple[int, int]) -> Any:
        number = np.asarray(bonds.lattice.number())
        rows, columns = bonds.lattice.rows_columns
        return number[rows + offset[1], columns + offset[0]] >= 0

    return wrong


def _shear_sign(stress: Any) -> Any:
    stress = np.array(stress)
    stress[:, 0, 1] *= -1.0
    stress[:, 1, 0] *= -1.0
    return stress


FAULTS = (
    Fault("displacement + 1 %", "solver.state.State.displacement", scaled(1.01), "solution"),
    Fault(
        "displacement with its components swapped",
        "solver.state.State.displacement",
        result(swapped()),
        "solution",
    ),
    Fault("one displacement NaN", "solver.state.State.displacement", result(one_nan), "solution"),
    Fault("rotation + 1 %", "solver.state.State.rotation", scaled(1.01), "solution"),
    Fault("rotation of the other sign", "solver.state.State.rotation", scaled(-1.0), "solution"),
    Fault("one rotation NaN", "solver.state.State.rotation", result(one_nan), "solution"),
    Fault("temperature + 1 %", "solver.state.State.temperature", scaled(1.01), "solution"),
    Fault("one temperature NaN", "solver.state.State.temperature", result(one_nan), "solution"),
    Fault(
        "surface displacement + 1 %",
        "solver.state.State.surface_displacement",
        scaled(1.01),
        "solution",
    ),
    Fault("stress + 1 %", "solver.recovery.stress", scaled(1.01), "recovery"),
    Fault(
        "shear stress of the other sign", "solver.recovery.stress", result(_shear_sign), "recovery"
    ),
    Fault("one stress NaN", "solver.recovery.stress", result(one_nan), "recovery"),
    Fault("flux + 1 %", "solver.recovery.flux", scaled(1.01), "recovery"),
    Fault("flux of the other sign", "solver.recovery.flux", scaled(-1.0), "recovery"),
    Fault("one flux NaN", "solver.recovery.flux", result(one_nan), "recovery"),
    Fault(
        "strain energy density + 1 %",
        "solver.recovery.strain_energy_density",
        scaled(1.01),
        "recovery",
    ),
    Fault(
        "one energy density NaN",
        "solver.recovery.strain_energy_density",
        result(one_nan),
        "recovery",
    ),
    Fault(
        "displacement gradient + 1 %",
        "solver.recovery.displacement_gradient",
        scaled(1.01),
        "recovery",
    ),
    Fault(
        "displacement gradient transposed",
        "solver.recovery.displacement_gradient",
        result(lambda g: np.swapaxes(g, 1, 2)),
        "recovery",
    ),
    Fault(
        "macrorotation of the other sign", "solver.recovery.macrorotation", scaled(-1.0), "recovery"
    ),
    Fault("strain at places + 1 %", "solver.edge_recovery.edge_strain", scaled(1.01), "recovery"),
    Fault(
        "values at corners of cells + 1 %",
        "solver.bonds.cells.Cells.at_corners",
        scaled(1.01),
        "recovery",
    ),
    Fault(
        "cells joined across cracks",
        "solver.bonds.cells._whole",
        _inside_the_body,
        "recovery",
    ),
)
