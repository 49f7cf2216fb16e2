"""Fields for other programs: .vtu for ParaView, .npz for Python."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from cmverify.case import FieldSet


def write_fields(fields: FieldSet, base: Path) -> tuple[Path, Path]:
    """Write computed, reference and difference of every field.

    Parameters
    ----------
    fields : FieldSet
        Lattice points are written as vertices, a mesh as its triangles.
    base : Path
        Path without suffix; .vtu and .npz are added.

    Returns
    -------
    The two paths.
    """
    from solver.result import write_arrays

    arrays: dict[str, np.ndarray] = {}
    for key, item in fields.items.items():
        arrays[key] = item.computed
        arrays[f"{key}_reference"] = item.reference
        arrays[f"{key}_difference"] = item.difference
    return write_arrays(fields.points, arrays, base, fields.triangles)


def check_writable(base: Path) -> None:
    """Refuse a base name to which nothing could be written, before any work.

    Raises
    ------
    ValueError
        Naming the path and what the system says.
    """
    if not base.name:
        raise ValueError(f"{base} names no file")
    try:
        base.parent.mkdir(parents=True, exist_ok=True)
        trial = base.with_name(f".{base.name}.{os.getpid()}.trial")
        trial.touch()
        trial.unlink()
    except OSError as error:
        raise ValueError(f"nothing can be written to {base}: {error.strerror}") from error
