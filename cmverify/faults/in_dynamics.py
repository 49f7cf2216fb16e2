"""Faults of modes, transients and waves, and of what they are held against."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from cmverify.faults.changes import argument, field, one_nan, result, scaled, swapped, times
from cmverify.faults.fault import Fault

ANALYSES, A, F = "solver.analyses", "references.analytic", "references.fem"
Function = Callable[..., Any]


def _first_missed(right: Function) -> Function:
    """The lowest elastic mode lost: all others move down by one."""

    def wrong(scene: Any, count: int, *rest: Any, **options: Any) -> Any:
        found = right(scene, count + 1, *rest, **options)
        keep = slice(1, None)
        return _shortened(found, keep)

    return wrong


def _copy_lost(right: Function) -> Function:
    """The second of the body's first two modes lost."""

    def wrong(scene: Any, count: int, *rest: Any, **options: Any) -> Any:
        found = right(scene, count + 1, *rest, **options)
        return _shortened(found, np.r_[0, 2 : count + 1])

    return wrong


def _shortened(found: Any, keep: Any) -> Any:
    from dataclasses import replace

    return replace(
        found,
        frequencies=found.frequencies[keep],
        unknowns=found.unknowns[keep],
        residuals=found.residuals[keep],
    )


def _late(share: float) -> Callable[[Function], Function]:
    """A pulse that arrives later, by a share of the time that has passed."""

    def change(right: Function) -> Function:
        def wrong(self: Any, x: Any, y: Any, t: float) -> Any:
            return right(self, x, y, t / (1.0 + share))

        return wrong

    return change


FAULTS = (
    # ---- what all share -----------------------------------------------------------------
    Fault("masses + 1 %", "solver.operators.mass.inertia", scaled(1.01), "mass"),
    Fault(
        "rotations with the mass of displacements",
        "solver.operators.mass.inertia",
        result(lambda mass: np.repeat(mass[:1], len(mass), axis=0)),
        "mass",
    ),
    Fault(
        "areas that particles stand for + 1 %",
        "solver.problem.discretisation.Discretisation.volumes",
        scaled(1.01),
        "mass",
    ),
    # ---- modes --------------------------------------------------------------------------
    Fault(
        "frequencies + 1 %",
        f"{ANALYSES}.modes.solve",
        field("frequencies", times(1.01)),
        "modes",
    ),
    Fault(
        "a frequency that is no number",
        f"{ANALYSES}.modes.solve",
        field("frequencies", one_nan),
        "modes",
    ),
    Fault(
        "a rigid motion counted twice",
        f"{ANALYSES}.modes.solve",
        field("rigid", lambda rigid: rigid + 1),
        "modes",
    ),
    Fault("the lowest mode missed", f"{ANALYSES}.modes.solve", _first_missed, "modes"),
    Fault("the second mode missed", f"{ANALYSES}.modes.solve", _copy_lost, "modes"),
    Fault(
        "shapes with their components swapped",
        f"{ANALYSES}.modes.Modes.shapes",
        result(swapped()),
        "modes",
    ),
    # ---- heat in time -------------------------------------------------------------------
    Fault(
        "temperatures in time + 1 %",
        f"{ANALYSES}.transient.run",
        field("temperature", times(1.01)),
        "transient",
    ),
    Fault(
        "steps of heat 1 % too long",
        f"{ANALYSES}.heating.Heating._step",
        argument(2, times(1.01)),
        "transient",
    ),
    Fault(
        "error of a step not looked at",
        f"{ANALYSES}.heating.Heating._first",
        scaled(1e4),
        "transient",
        harmless="a first step too long is rejected and halved: the answer is the same",
    ),
    # ---- waves --------------------------------------------------------------------------
    Fault(
        "velocity of Verlet's step + 1 %",
        f"{ANALYSES}.stepping.Verlet.next",
        result(lambda v: 1.01 * v),
        "waves",
    ),
    Fault(
        "first half step left out",
        f"{ANALYSES}.stepping.Verlet.first",
        lambda right: lambda self, v, a: v,
        "waves",
    ),
    Fault(
        "force of a step + 1 %",
        f"{ANALYSES}.stepping.Verlet.force",
        result(lambda pair: (pair[0], 1.01 * pair[1])),
        "waves",
    ),
    Fault(
        "stable step twice too long",
        f"{ANALYSES}.motion.stable_step",
        scaled(2.0),
        "waves",
    ),
    # ---- references ---------------------------------------------------------------------
    Fault(
        "polarisations of the two waves exchanged",
        f"{A}.christoffel.polarisations",
        result(lambda p: p[..., ::-1]),
        "closed forms",
    ),
    Fault("impulse response + 1 %", f"{A}.lamb.impulse", scaled(1.01), "closed forms"),
    Fault(
        "displacement of the half space + 1 %",
        f"{A}.lamb.edge_displacement",
        scaled(1.01),
        "closed forms",
    ),
    Fault(
        "heat of a pulse spreads 1 % too slowly",
        f"{A}.conduction.InstantaneousSource.value",
        _late(0.01),
        "closed forms",
    ),
    Fault(
        "frequencies of finite elements + 1 %",
        f"{F}.modes.in_plane_modes",
        field("frequencies", times(1.01)),
        "finite elements",
    ),
    Fault(
        "frequencies of blocks + 1 %",
        "references.lattice.blocks.BlockLattice.modes",
        result(lambda found: (1.01 * found[0], found[1])),
        "block lattice",
    ),
)
