"""The [fracture] table of a scene file: run, written.

A scene with this table is not solved once: its cracks grow, by `solver.fracture.grow`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cmverify.exchange.export import named, replacing, write_arrays
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


def write(run: Growth, fields: Mapping[str, np.ndarray], base: Path) -> tuple[Path, ...]:
    """Fields with the damage as .vtu and .npz, the history and the crack's path as .csv."""
    arrays = dict(fields) | {"damage": run.damage, "loose": run.loose.astype(float)}
    paths = write_arrays(run.solution.points, arrays, base)
    history, path = named(base, ".history.csv"), named(base, ".path.csv")
    tables = ((history, run.history.array, ",".join(run.history.names)), (path, run.path, "x,y"))
    for target, values, columns in tables:
        with replacing(target) as partial:
            np.savetxt(partial, values, delimiter=",", header=columns, comments="")
    return *paths, history, path


def summary(run: Growth) -> dict[str, Any]:
    """What the terminal shows."""
    h, steps = run.history, run.steps
    return {
        "ended": run.reason,
        "load factor": run.load_factor,
        "largest factor": float(h.load_factor.max()),
        "advance": run.advance,
        "tip": f"({run.tip[0]:.4g}, {run.tip[1]:.4g})",
        "bonds broken": len(run.broken_bonds),
        "loose particles": int(run.loose.sum()),
        "work": float(h.work[-1]),
        "stored": float(h.stored[-1]),
        "dissipated": float(h.dissipated[-1]),
        "excess": float(h.excess[-1]),
        "imbalance": float(h.imbalance[-1]),
        "solves": len(steps),
        "iterations": int(steps["iterations"].sum()),
        "bonds a solve": len(run.broken_bonds) / len(steps),
    }
