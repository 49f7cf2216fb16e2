"""The [fracture] table of a scene file: run, written.

A scene with this table is not solved once: its cracks grow, by `solver.fracture.grow`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from cmverify.exchange.model import Fracture
from cmverify.exchange.refusal import Source

if TYPE_CHECKING:
    from solver import Scene
    from solver.fracture import Growth

PROGRAMME = ("start", "stop", "increment", "overload", "levels", "control")
OPTIONS = ("batch", "criterion", "tension_only", "max_solves", "tolerance")


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


def plan(table: Fracture, source: Source) -> Plan:
    """Turn the table into a plan.

    Raises
    ------
    SceneFileError
        If a value makes no sense, or the checkpoint cannot be written.
    """
    from solver import Programme, Toughness
    from solver.fracture import checkpoint

    given = {key: value for key, value in table if value is not None}
    with source.at("fracture"):
        toughness = Toughness(
            table.G1, table.G2, table.n, table.frequency, float(np.radians(table.axis_degrees)),
            table.toughness_calibration,
        )  # fmt: skip
        programme = Programme(**{key: given[key] for key in PROGRAMME if key in given})
    options = {key: given[key] for key in OPTIONS if key in given}
    if table.no_fail is not None:
        options["no_fail"] = [table.no_fail]
    if table.checkpoint is not None:
        with source.at("fracture", "checkpoint"):
            checkpoint.check(table.checkpoint)
        options["checkpoint"] = table.checkpoint
    if (advance := table.advance) is not None:
        options["until"] = lambda run: run.advance >= advance
    return Plan(toughness, programme, options)
