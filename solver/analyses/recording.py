"""What an analysis in time leaves behind as it goes: state files, probes and series of fields.

A run that is killed leaves its last state on the disk, written whole or not at all, and fields
that any program which reads ParaView's files can follow while it runs. It goes on from the state
with the same results to the last bit: the state holds everything that decides how it goes on, and
a fingerprint of what decides it besides.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import ArrayLike

from .. import state_file
from ..arrays import Array, Indices
from ..bonds import Bonds, Cells
from ..errors import SceneError
from ..geometry import Lattice
from ..magnitude import TIMES, outside
from ..problem import Discretisation
from ..result import Table, replacing, suffixed, vtk_mesh

#: Told the share of the run that is done, 0 to 1.
Progress = Callable[[float], None]


def nearest(lattice: Lattice, points: ArrayLike) -> Indices:
    """Numbers of the particles nearest to some points, shape (p,).

    Raises
    ------
    SceneError
        If points are no points of the plane, or one has no particle within a cell.
    """
    wanted = np.asarray(points, dtype=np.float64)
    if wanted.ndim != 2 or wanted.shape[1] != 2 or not np.isfinite(wanted).all():
        raise SceneError(f"probes are points (x, y), an array of shape (p, 2), not {wanted.shape}")
    distance, found = lattice.tree.query(wanted)
    if distance.max(initial=0.0) > 1.5 * lattice.spacing:
        x, y = wanted[np.argmax(distance)]
        raise SceneError(f"the probe at ({x:g}, {y:g}) is not in the body")
    return np.asarray(found, dtype=np.int64)


def checked_times(times: ArrayLike, start: float, end: float = np.inf) -> Array:
    """Times at which fields are wanted: ascending, finite, from `start` to `end`.

    Raises
    ------
    SceneError
    """
    found = np.atleast_1d(np.asarray(times, dtype=np.float64))
    if found.ndim != 1 or not len(found) or not np.isfinite(found).all():
        raise SceneError(f"times must be finite numbers in a list, not {times!r}")
    if (np.diff(found) <= 0).any():
        raise SceneError("times must ascend, each once")
    if found[0] < start or found[-1] > end * (1 + 1e-12):
        raise SceneError(
            f"times must lie between the start at {start:g} s and the end at {end:g} s, not at "
            f"{found[0]:g} … {found[-1]:g} s"
        )
    if wrong := outside(float(found[-1] - start), TIMES):
        raise SceneError(f"the time from start to end is {wrong}")
    return found


@dataclass(frozen=True)
class History:
    """Values at chosen particles at every step.

    Attributes
    ----------
    particles : ndarray of int, shape (p,)
    times : ndarray, shape (s,), s
    values : ndarray, shape (s, components, p)
        In the components' units.
    """

    particles: Indices
    times: Array
    values: Array

    def table(self, names: tuple[str, ...]) -> dict[str, Table]:
        """The history as a table, columns by component and probe; none without probes."""
        if not len(self.particles):
            return {}
        columns = [f"{name}_{k}" for name in names for k in range(len(self.particles))]
        rows = self.values.reshape(len(self.times), -1)
        return {"probes": Table(("time", *columns), np.column_stack([self.times, rows]))}


class Log:
    """Rows of numbers that grow step by step."""

    def __init__(self, width: int, rows: Array | None = None) -> None:
        self._rows = np.empty((256, width)) if rows is None else rows.copy()
        self._count = 0 if rows is None else len(rows)

    def append(self, row: Array) -> None:
        """Add a row, shape (width,)."""
        if self._count == len(self._rows):
            grown = np.empty((2 * self._count + 1, self._rows.shape[1]))
            grown[: self._count] = self._rows
            self._rows = grown
        self._rows[self._count] = row
        self._count += 1

    @property
    def rows(self) -> Array:
        """Everything so far, shape (rows, width)."""
        return self._rows[: self._count]


class Series:
    """Fields at several times as ParaView reads them: one .vtu each, listed in one .pvd.

    Parameters
    ----------
    stem : path without suffix
    bonds : Bonds

    Raises
    ------
    SceneError
        If the folder is missing or cannot be written to.
    """

    def __init__(self, stem: str | os.PathLike[str], bonds: Bonds) -> None:
        self.stem, self.points, self.cells = Path(stem), bonds.lattice.places, Cells.of(bonds)
        state_file.check(suffixed(self.stem, ".pvd"), "series")

    def write(self, number: int, times: Sequence[float], fields: Mapping[str, Array]) -> None:
        """Write the fields of frame `number` and list the frames of `times`."""
        mesh = vtk_mesh(self.points, dict(fields), cells=self.cells)
        _whole(self._frame(number), lambda path: mesh.write(path, file_format="vtu"))
        lines = [
            f'<DataSet timestep="{time!r}" part="0" file={quoteattr(self._frame(k).name)}/>'
            for k, time in enumerate(map(float, times))
        ]
        body = "\n".join(
            [
                '<?xml version="1.0"?>',
                '<VTKFile type="Collection" version="0.1"><Collection>',
                *lines,
                "</Collection></VTKFile>\n",
            ]
        )
        _whole(suffixed(self.stem, ".pvd"), lambda path: path.write_text(body, encoding="utf-8"))

    def _frame(self, number: int) -> Path:
        return self.stem.with_name(f"{self.stem.name}_{number:05d}.vtu")


def fingerprint(body: Discretisation, **parts: Any) -> str:
    """Hash of a body and of whatever else decides a run's results.

    Functions of time enter by the values that they have in `parts`, not by their code.
    """
    ended = body.bonds.ended
    scene = body.scene
    known: dict[str, Any] = {
        "mask": body.lattice.mask,
        "corner": body.lattice.points[0],
        "offsets": body.family.offsets,
        "blocks": body.operator.blocks,
        "strengths": body.bonds.strengths,
        "prescribed": body.prescribed,
        "values": body.values,
        "load": body.load,
        "nodal": body.nodal_load,
        "material": (scene.density, scene.heat_capacity, scene.surface),
    }
    if body.bonds.phases is not None:
        known["phases"] = body.bonds.phases.of
        known["storage"] = [
            body.storage(n) for n in ("density", "heat_capacity") if getattr(scene, n)
        ]
    if ended is not None:
        known["ended"] = np.concatenate([ended.position, ended.length])
    return state_file.fingerprint(**known, **parts)


def _whole(path: Path, write: Callable[[Path], Any]) -> None:
    """Write a file so that it is there as a whole or not at all."""
    try:
        with replacing(path) as partial:
            write(partial)
    except OSError as error:
        raise SceneError(f"{path} cannot be written: {error}") from error
