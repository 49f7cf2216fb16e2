"""Faults of fracture: toughness, breaking, the ledger."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from cmverify.faults.changes import argument, first_bond, result, scaled
from cmverify.faults.fault import Fault

Function = Callable[..., Any]


FAULTS = (
    Fault(
        "critical energies + 2 %",
        "solver.fracture.toughness.Toughness.energies",
        scaled(1.02),
        "toughness",
    ),
    Fault(
        "critical energies turned by 90 degrees",
        "solver.fracture.toughness.Toughness._lobes",
        argument(1, lambda psi: np.asarray(psi) + 0.5 * np.pi),
        "toughness",
    ),
    Fault(
        "constants of the law + 2 %",
        "solver.fracture.toughness.Toughness.constants",
        scaled(1.02),
        "toughness",
    ),
    Fault(
        "effective fracture energy + 1 %",
        "solver.fracture.toughness.Toughness.fracture_energy",
        scaled(1.01),
        "toughness",
    ),
    Fault(
        "levelled bonds not levelled",
        "solver.fracture.toughness.evenness",
        result(np.ones_like),
        "toughness",
    ),
    Fault(
        "one direction of bonds 5 % too tough",
        "solver.fracture.directions.levelled",
        result(first_bond),
        "toughness",
    ),
    Fault(
        "a batch without one of its bonds",
        "solver.fracture.breaking.next_batch",
        result(lambda found: tuple(part[: max(1, len(part) - 1)] for part in found)),
        "fracture",
    ),
    Fault(
        "w_c of a growing body + 2 %",
        "solver.fracture.breaking.critical_energies",
        scaled(1.02),
        "fracture",
    ),
    Fault(
        "bonds break 2 % too late",
        "solver.fracture.breaking.Breakable.utilisation",
        scaled(1 / 1.02),
        "fracture",
    ),
    Fault(
        "cost of breaking + 2 %",
        "solver.fracture.breaking.Breakable.cost_of",
        scaled(1.02),
        "fracture",
    ),
    Fault(
        "energy of single bonds + 1 %",
        "solver.fracture.breaking.Breakable.energy_of",
        scaled(1.01),
        "fracture",
    ),
    Fault(
        "stored energy + 1 %", "solver.fracture.breaking.Breakable.stored", scaled(1.01), "fracture"
    ),
    Fault(
        "work of supports + 1 %",
        "solver.fracture.ledger.Ledger._support_work",
        scaled(1.01),
        "fracture",
    ),
    Fault("advance + 5 %", "solver.fracture.growth.Growth.advance", scaled(1.05), "fracture"),
    Fault(
        "broken bonds stay in the books",
        "solver.fracture.breaking.Breakable.strengths",
        lambda right: lambda self: self.whole,
        "fracture",
    ),
)
