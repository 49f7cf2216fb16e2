"""Fields for other programs: .vtu for ParaView, .npz for Python."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
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
    vtu, npz = named(base, ".vtu"), named(base, ".npz")
    with replacing(vtu) as partial:
        mesh.write(partial, file_format="vtu")
    extra: dict[str, Any] = {} if triangles is None else {"triangles": np.asarray(triangles)}
    extra |= arrays
    with replacing(npz) as partial, open(partial, "wb") as stream:
        np.savez_compressed(stream, points=points, **extra)
    return vtu, npz


def named(base: Path, suffix: str) -> Path:
    """The file of a base name, which is taken whole: "h_0.02" has no suffix."""
    return base.with_name(base.name + suffix)


@contextmanager
def replacing(target: Path) -> Iterator[Path]:
    """A path to write to, which takes the place of `target` when all of it is written."""
    partial = target.with_name(f".{target.name}.{os.getpid()}.partial")
    try:
        yield partial
        os.replace(partial, target)
    finally:
        with suppress(OSError):
            partial.unlink(missing_ok=True)


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
