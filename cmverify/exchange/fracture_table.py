"""The [fracture] table of a scene file: read, run, written.

A scene with this table is not solved once: its cracks grow, by `solver.fracture.grow`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cmverify.exchange.export import write_arrays

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


def write(run: Growth, fields: Mapping[str, np.ndarray], base: Path) -> tuple[Path, ...]:
    """Fields with the damage as .vtu and .npz, the history and the crack's path as .csv."""
    arrays = dict(fields) | {"damage": run.damage, "loose": run.loose.astype(float)}
    paths = write_arrays(run.solution.points, arrays, base)
    history, path = base.with_suffix(".history.csv"), base.with_suffix(".path.csv")
    columns = ",".join(run.history.names)
    np.savetxt(history, run.history.array, delimiter=",", header=columns, comments="")
    np.savetxt(path, run.path, delimiter=",", header="x,y", comments="")
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
