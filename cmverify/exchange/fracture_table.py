"""The [fracture] table of a scene file: read, run, written.

A scene with this table is not solved once: its cracks grow, by `solver.fracture.grow`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from solver import Scene
    from solver.fracture import Growth

TOUGHNESS = {"G1", "G2", "n", "frequency", "axis_degrees", "toughness_calibration"}
PROGRAMME = {"start", "stop", "increment", "overload", "levels", "control"}
OPTIONS = {"batch", "criterion", "tension_only", "max_solves", "tolerance"}
#: Every key of the table.
KEYS = TOUGHNESS | PROGRAMME | OPTIONS | {"no_fail", "advance", "checkpoint"}


@dataclass(frozen=True)
class Plan:
    """What a [fracture] table asks for.

    Attributes
    ----------
    toughness, programme : Toughness, Programme
    options : dict
        Further arguments of `solver.fracture.grow`.
    """

    toughness: Any
    programme: Any
    options: dict[str, Any]

    def run(self, scene: Scene) -> Growth:
        """Let the scene's cracks grow."""
        from solver import fracture

        return fracture.grow(scene, self.toughness, self.programme, **self.options)


def plan(table: Mapping[str, Any], formula: Callable[[str, Any], Any]) -> Plan:
    """Turn the table into a plan; `formula` (key, value) makes functions of formulas.

    Raises
    ------
    ValueError
        If G1 is missing or a value makes no sense.
    """
    from solver import Programme, Toughness

    if "G1" not in table:
        raise ValueError("the key 'G1' (fracture energy, J/m²) is missing")
    given = {key: table[key] for key in ("G1", "G2", "n", "frequency") if key in table}
    if "axis_degrees" in table:
        given["axis"] = float(np.radians(table["axis_degrees"]))
    if "toughness_calibration" in table:
        given["calibration"] = table["toughness_calibration"]
    options = {key: table[key] for key in OPTIONS if key in table}
    if "no_fail" in table:
        options["no_fail"] = [formula("no_fail", table["no_fail"])]
    if "checkpoint" in table:
        options["checkpoint"] = table["checkpoint"]
    if "advance" in table:
        advance = float(table["advance"])
        options["until"] = lambda run: run.advance >= advance
    programme = Programme(**{key: table[key] for key in PROGRAMME if key in table})
    return Plan(Toughness(**given), programme, options)
