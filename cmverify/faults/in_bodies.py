"""Faults of bodies: bonds, operators and their solvers, geometry, supports, loads."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from cmverify.faults.changes import result, scaled, swapped, times
from cmverify.faults.fault import Fault

Function = Callable[..., Any]


def _load(alter: Callable[[Any], Any]) -> Callable[[Function], Function]:
    """The densities of a load in the body altered."""

    def change(right: Function) -> Function:
        def wrong(*args: Any, **kwargs: Any) -> Any:
            made = right(*args, **kwargs)

            def density(*asked: Any) -> Any:
                mask, values = made.density(*asked)
                return mask, alter(values)

            return dataclasses.replace(made, density=density)

        return wrong

    return change


def _thinner(right: Function) -> Function:
    def wrong(cls: Any, cells: float, **values: Any) -> Any:
        return right(cls, max(cells - 1.0, 0.5), **values)

    return wrong


def _less_sharp(right: Function) -> Function:
    """Every piece of a crack ends half a cell early."""

    def wrong(self: Any, lattice: Any, offsets: Any) -> Any:
        from solver.geometry.exact import CELL

        start, end = self.pieces[:, 0], self.pieces[:, 1]
        size = np.hypot(*(end - start).T)[:, None]
        pieces = np.stack([start, end - 0.5 * CELL * (end - start) / size], axis=1)
        return right(dataclasses.replace(self, pieces=pieces), lattice, offsets)

    return wrong


def _cut_nothing(right: Function) -> Function:
    """Cracks lie between no particles, though they are met."""

    def wrong(self: Any, lattice: Any, offsets: Any) -> Any:
        particles, mask, met, lying = right(self, lattice, offsets)
        return particles[:0], mask[:, :0], met, lying

    return wrong


def _no_coarse_grid(right: Function) -> Function:
    """Two levels without the second."""

    def wrong(self: Any, residual: Any) -> Any:
        return 0.0 * right(self, residual)

    return wrong


def _early(right: Function) -> Function:
    """Stops a million times too early."""

    def wrong(discretisation: Any, tolerance: float = 1e-10, **options: Any) -> Any:
        return right(discretisation, min(1e6 * tolerance, 0.1), **options)

    return wrong


def _half_cell(points: Any) -> Any:
    """Particle centres moved along axis 1 by a tenth of a cell."""
    step = np.min(np.diff(np.unique(points[:, 0].round(12))))
    return points + np.array([0.1 * step, 0.0])


def _without_turning(right: Function) -> Function:
    """Pins whose rotation is held."""

    def wrong(cls: Any, where: Any, centre: Any = None, **motion: Any) -> Any:
        return right(cls, where, centre, **{"rotation": 0.0, **motion})

    return wrong


def _without_rims(right: Function) -> Function:
    """Bonds between a lead and its surroundings that do not end at its rim."""
    return lambda scene, bonds, moduli: bonds


FAULTS = (
    # ---- bonds, operators -------------------------------------------------------------------
    Fault("bond blocks + 1 %", "solver.operators.blocks.offset_blocks", scaled(1.01), "operators"),
    Fault(
        "rotation coupled with the other sign",
        "solver.operators.blocks.offset_blocks",
        result(lambda b: b if b.shape[1] < 6 else b * np.array([1, 1, 1, -1, -1, 1.0])),
        "operators",
    ),
    Fault(
        "rotation coupled 1 % too strongly",
        "solver.operators.blocks.offset_blocks",
        result(lambda b: b if b.shape[1] < 6 else b * np.array([1, 1, 1, 1.01, 1.01, 1.01**2])),
        "operators",
    ),
    Fault(
        "prescribed values act 1 % too strongly",
        "solver.operators.bond_operator.BondOperator.coupling",
        scaled(1.01),
        "supports",
    ),
    Fault(
        "volume factor + 5 %", "solver.bonds.volume_method.volume_factor", scaled(1.05), "surfaces"
    ),
    Fault(
        "volume factor + 1 %",
        "solver.bonds.volume_method.volume_factor",
        scaled(1.01),
        "surfaces",
        "the volume method is the paper's approximation, off by some per cent at every face; what "
        "it is off by converges and 5 % more is seen",
    ),
    Fault(
        "cracks end half a cell early",
        "solver.geometry.crack_set.CrackSet.cut",
        _less_sharp,
        "cracks",
    ),
    Fault("cracks cut nothing", "solver.geometry.crack_set.CrackSet.cut", _cut_nothing, "cracks"),
    Fault(
        "skin 10 % too thick",
        "solver.operators.skin.thickness",
        scaled(1.1),
        "surfaces",
        "a correction of round edges: a tenth of it moves the errors there by some per cent of "
        "themselves, and they go on converging",
    ),
    Fault("damage + 5 %", "solver.bonds.bonds.damage", scaled(1.05), "recovery"),
    Fault(
        "preconditioner without its coarse grid",
        "solver.linear.two_level.TwoLevel._correction",
        _no_coarse_grid,
        "linear solvers",
    ),
    Fault("iteration stops too early", "solver.analyses.statics.solve", _early, "linear solvers"),
    # ---- geometry, supports, loads ----------------------------------------------------------
    Fault(
        "particles moved by a tenth of a cell",
        "solver.geometry.lattice.Lattice.points",
        result(_half_cell),
        "geometry",
    ),
    Fault(
        "edge weights + 1 %",
        "solver.geometry.edge_quadrature.Quadrature.force",
        scaled(1.01),
        "loads",
    ),
    Fault(
        "normals of edges inwards",
        "solver.geometry.edge_quadrature.Quadrature.normals",
        scaled(-1.0),
        "loads",
    ),
    Fault(
        "edge loads missing from the force",
        "solver.geometry.edge_quadrature.Quadrature.force",
        scaled(0.0),
        "loads",
    ),
    Fault(
        "layers one cell too thin", "solver.problem.supports.Support.layer", _thinner, "supports"
    ),
    Fault("body force + 1 %", "solver.problem.loads.Load.body_force", _load(times(1.01)), "loads"),
    Fault(
        "body force with its components swapped",
        "solver.problem.loads.Load.body_force",
        _load(swapped()),
        "loads",
    ),
    Fault("heat source + 1 %", "solver.problem.loads.Load.source", _load(times(1.01)), "loads"),
    Fault(
        "heat source of the other sign",
        "solver.problem.loads.Load.source",
        _load(times(-1.0)),
        "loads",
    ),
    Fault("body couple + 1 %", "solver.problem.loads.Load.couple", _load(times(1.01)), "loads"),
    Fault(
        "right-hand side + 1 %",
        "solver.problem.discretisation.Discretisation.right_hand_side",
        scaled(1.01),
        "loads",
    ),
    Fault(
        "pins that do not turn",
        "solver.problem.supports.Support.pin",
        _without_turning,
        "supports",
    ),
    Fault("leads without a rim", "solver.problem.leads.rimmed", _without_rims, "leads"),
)
