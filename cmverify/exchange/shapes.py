"""Regions that a scene file draws: of the body, of its solids, of what is held or fed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from solver import Region


def region(shapes: Any, folder: Path, step: float) -> Region:
    """Shapes added, subtracted and intersected one after the other.

    Parameters
    ----------
    shapes : list of tables
    folder : Path
        Where drawings are looked for.
    step : float, m
        Longest chord of what other programs draw with curves.

    Raises
    ------
    ValueError, OSError
        If there is no such drawing, or it is no region.
    """
    found: Region | None = None
    for table in shapes:
        shape = _shape(table, folder, step)
        if found is None:
            found = shape
        elif table.operation == "subtract":
            found = found - shape
        else:
            found = found | shape if table.operation == "add" else found & shape
    assert found is not None
    return found


def drawn(value: Any) -> bool:
    """Whether a value of a scene file is a list of shapes."""
    return isinstance(value, list) and bool(value) and hasattr(value[0], "shape")


def place(table: Any, folder: Path, step: float) -> Any:
    """Where a support or load is: its region, or else its condition; None for everywhere."""
    drawn = getattr(table, "region", None)
    return getattr(table, "where", None) if drawn is None else region(drawn, folder, step)


def _shape(table: Any, folder: Path, step: float) -> Region:
    import solver

    values = {k: v for k, v in table if k not in ("shape", "operation")}
    if table.shape == "file":
        from cmverify.exchange import outline_file

        return outline_file.region(folder / values.pop("path"), chord=step, **values)
    if "centre" in values:
        values["centre"] = tuple(values["centre"])
    if "angle_degrees" in values:
        values["angle"] = np.radians(values.pop("angle_degrees"))
    shape: Region = getattr(solver, table.shape)(**values)
    return shape
