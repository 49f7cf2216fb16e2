"""Fields for other programs: .vtu for ParaView, .npz for Python."""

from __future__ import annotations

from pathlib import Path
from typing import Any

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
    arrays: dict[str, np.ndarray] = {}
    for key, item in fields.items.items():
        arrays[key] = item.computed
        arrays[f"{key}_reference"] = item.reference
        arrays[f"{key}_difference"] = item.difference
    return write_arrays(fields.points, arrays, base, fields.triangles)


def write_arrays(
    points: np.ndarray,
    arrays: dict[str, np.ndarray],
    base: Path,
    triangles: np.ndarray | None = None,
) -> tuple[Path, Path]:
    """Write point data on (N, 2) points as .vtu and .npz; vectors (N, 2) are padded for VTK."""
    import meshio

    base.parent.mkdir(parents=True, exist_ok=True)
    count = len(points)
    cells = (
        [("vertex", np.arange(count).reshape(-1, 1))]
        if triangles is None
        else [("triangle", np.asarray(triangles))]
    )
    data = {
        name: np.column_stack([a, np.zeros(count)]) if a.ndim == 2 else a
        for name, a in arrays.items()
    }
    mesh = meshio.Mesh(np.column_stack([points, np.zeros(count)]), cells, point_data=data)
    vtu, npz = base.with_suffix(".vtu"), base.with_suffix(".npz")
    mesh.write(vtu, file_format="vtu")
    extra: dict[str, Any] = {} if triangles is None else {"triangles": np.asarray(triangles)}
    extra |= arrays
    np.savez_compressed(npz, points=points, **extra)
    return vtu, npz
