"""What a scene file wants written: some fields, fields along lines, stresses by a rule."""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cmverify.exchange import model
from solver.result import Result, Table, suffixed

if TYPE_CHECKING:
    from collections.abc import Mapping

    from solver.arrays import Array
    from solver.bonds import Cells
    from solver.state import State

#: Every field that an analysis may write; a mode's begin with "mode 1 ".
FIELDS = (
    "prescribed", "displacement", "rotation", "temperature", "potential", "velocity",
    "stress11", "stress22", "stress12", "stress12_less_21", "couple_stress", "flux",
    "current_density", "joule_heat", "unstrained_potential", "damage", "loose",
)  # fmt: skip
_STRESSES = ("stress11", "stress22", "stress12", "stress12_less_21")


def check_fields(names: list[str] | None) -> None:
    """Refuse names that no analysis writes.

    Raises
    ------
    ValueError
        With the nearest name.
    """
    for name in names or ():
        bare = re.sub(r"^mode \d+ ", "", name)
        if bare not in FIELDS:
            near = difflib.get_close_matches(bare, FIELDS, n=1, cutoff=0.5)
            hint = f"did you mean {near[0]!r}?" if near else f"known: {', '.join(FIELDS)}"
            raise ValueError(f"there is no field {name!r}; {hint}")


@dataclass(frozen=True, eq=False)
class Selected(Result):
    """A result as a scene file wants it written.

    Attributes
    ----------
    whole : Result
    asked : model.Output
    spacing : float, m
    """

    whole: Result
    asked: model.Output
    spacing: float

    @property
    def points(self) -> Array:
        return self.whole.points

    @property
    def cells(self) -> Cells | None:
        return self.whole.cells

    @property
    def stressed(self) -> State | None:
        """Of the whole result."""
        return self.whole.stressed

    def fields(self) -> dict[str, Array]:
        """Those that are asked for; stresses by the rule that is asked for."""
        found = self.everything
        wanted = self.asked.fields
        if wanted is None or not any(name in found for name in wanted):
            return found
        return {name: found[name] for name in wanted if name in found}

    @cached_property
    def everything(self) -> dict[str, Array]:
        """Every field of the result, stresses by the rule that is asked for."""
        found = self.whole.fields()
        state = self.whole.stressed
        if self.asked.stress_rule is not None and state is not None:
            from solver import recovery

            stress = recovery.stress(state, self.asked.stress_rule)
            s12, s21 = stress[:, 0, 1], stress[:, 1, 0]
            values = (stress[:, 0, 0], stress[:, 1, 1], 0.5 * (s12 + s21), s12 - s21)
            found |= {k: v for k, v in zip(_STRESSES, values, strict=True) if k in found}
        return found

    def summary(self) -> dict[str, Any]:
        """That of the whole result, and a warning of fields that it does not have."""
        said = self.whole.summary()
        missing = [name for name in self.asked.fields or () if name not in self.everything]
        if missing:
            known = ", ".join(self.everything)
            warning = f"this analysis writes no {', '.join(missing)}; it has {known}"
            said["warnings"] = (*said.get("warnings", ()), warning)
        return said

    def tables(self) -> dict[str, Table]:
        """Those of the whole result, and one for each line."""
        lines = {f"line-{line.name}": along(self.points, self.fields(), line, self.spacing)
                 for line in self.asked.line}  # fmt: skip
        return {**self.whole.tables(), **lines}


def along(points: Array, fields: dict[str, Array], line: model.Line, spacing: float) -> Table:
    """Fields at the particles nearest to a line.

    Nothing is interpolated, for a crack or an edge may lie between: each of the line's points
    takes the particle that it is nearest to, once, if there is one within a cell.

    Parameters
    ----------
    points : (N, 2) array, m
    fields : dict of (N,) or (N, 2) arrays
    line : model.Line
    spacing : float, m

    Returns
    -------
    Table
        The distance along the line, the particle's own x and y, and the fields there.

    Raises
    ------
    ValueError
        If no particle is near it.
    """
    start, end = np.array(line.start), np.array(line.end)
    share = np.linspace(0.0, 1.0, line.count)[:, None]
    from scipy.spatial import KDTree

    distance, nearest = KDTree(points).query(start + share * (end - start))
    near = nearest[distance <= np.sqrt(0.5) * spacing * (1 + 1e-9)]
    if not len(near):
        raise ValueError(f"the line {line.name!r} runs outside the body")
    _, first = np.unique(near, return_index=True)
    chosen = near[np.sort(first)]
    columns, values = ["s", "x", "y"], [(points[chosen] - start) @ (end - start), points[chosen]]
    values[0] = values[0] / np.hypot(*(end - start))
    for name, field in fields.items():
        if field.ndim == 1:
            columns.append(name)
        else:
            columns += [f"{name}{k + 1}" for k in range(field.shape[1])]
        values.append(field[chosen])
    return Table(tuple(name.replace(" ", "_") for name in columns), np.column_stack(values))


def existing(stem: Path) -> list[Path]:
    """Files that a result of this name would take the place of."""
    found = [path for suffix in (".vtu", ".npz") if (path := suffixed(stem, suffix)).exists()]
    start = re.escape(stem.name)
    if stem.parent.is_dir():
        for path in sorted(stem.parent.iterdir()):
            if re.fullmatch(start + r"\.([\w-]+\.csv|fem\.(vtu|npz|json))", path.name):
                found.append(path)
    return found


def existing_series(options: Mapping[str, Any]) -> list[Path]:
    """Files of the series that an analysis would take the place of; none where it goes on."""
    checkpoint = options.get("checkpoint")
    if options.get("series") is None or (checkpoint is not None and Path(checkpoint).exists()):
        return []
    stem = Path(options["series"])
    found = [path] if (path := suffixed(stem, ".pvd")).exists() else []
    frame = re.compile(re.escape(stem.name) + r"_\d{5,}\.vtu")
    if stem.parent.is_dir():
        found += [p for p in sorted(stem.parent.iterdir()) if frame.fullmatch(p.name)]
    return found
