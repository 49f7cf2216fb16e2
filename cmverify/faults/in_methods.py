"""Faults of linear solvers, calibrated tips, surfaces' stiffness, laws and paths of cracks."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from cmverify.faults.changes import argument, result, scaled
from cmverify.faults.fault import Fault

Function = Callable[..., Any]
_FIVE = np.radians(5.0)
_TURN = np.array([[np.cos(_FIVE), -np.sin(_FIVE)], [np.sin(_FIVE), np.cos(_FIVE)]])


def _other_axis(found: Any) -> Any:
    """The weakest wave said to run along the strong axis."""
    weak, energy = found
    return np.array([-weak[1], weak[0]]), energy


def _square(right: Function) -> Function:
    return lambda cls, operator, coarsening: cls(
        (coarsening, 0), (0, coarsening), operator.bonds.lattice.shape
    )


def _mirrored(path: Any) -> Any:
    """Every point of a crack's path mirrored at the line of its first one."""
    points = np.array(path.points)
    points[:, 1] = 2 * points[0, 1] - points[:, 1]
    return dataclasses.replace(path, points=points)


FAULTS = (
    # ---- linear solvers -----------------------------------------------------------------
    Fault(
        "coarse grids along the weak axis",
        "solver.linear.coarse_grid._axes",
        result(_other_axis),
        "linear solvers",
    ),
    Fault(
        "coarse grids square in every solid",
        "solver.linear.coarse_grid.CoarseGrid.of",
        _square,
        "linear solvers",
    ),
    Fault(
        "condensed rotations + 1 %",
        "solver.linear.condensed.Condensed.rotations",
        scaled(1.01),
        "linear solvers",
    ),
    Fault(
        "rotations without mass + 1 %",
        "solver.linear.rotations.MasslessRotations.__call__",
        result(lambda found: (1.01 * found[0], found[1])),
        "linear solvers",
    ),
    # ---- calibrated tips ----------------------------------------------------------------
    Fault(
        "fields of calibrated tips turned by 5 degrees",
        "solver.tips.field.TipField.__call__",
        argument(1, lambda away: np.asarray(away) @ _TURN),
        "tips",
    ),
    Fault(
        "rotation of calibrated tips' fields of the other sign",
        "solver.tips.field.TipField.__call__",
        result(lambda found: (found[0], -found[1])),
        "tips",
    ),
    Fault(
        "forces that calibrate tips halved",
        "solver.tips.update.best_forces",
        scaled(0.5),
        "tips",
    ),
    Fault(
        "tips turned over without their signs",
        "solver.tips.calibration.CalibratedTip.inverted",
        lambda right: lambda self: self,
        "tips",
    ),
    Fault(
        "tips left as drawn without a word",
        "solver.problem.tips.calibrate",
        lambda right: lambda *given: (),
        "tips",
    ),
    # ---- surfaces, laws, paths ----------------------------------------------------------
    Fault(
        "unknowns of surfaces + 1 %",
        "solver.operators.surface_stiffness.SurfaceStiffness.nodal",
        scaled(1.01),
        "surfaces",
    ),
    Fault(
        "positive moduli that miss their moments by 1 %",
        "solver.material.positive.closest",
        lambda right: lambda *given: None if (x := right(*given)) is None else 1.01 * x,
        "moduli",
    ),
    Fault(
        "paths of cracks mirrored",
        "solver.fracture.crack_path.trace",
        result(lambda found: [_mirrored(path) for path in found]),
        "fracture",
    ),
)
