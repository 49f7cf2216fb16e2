"""What every analysis returns can do: say its fields, sum itself up, and write itself."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .arrays import Array
from .bonds.cells import Cells

if TYPE_CHECKING:
    from .state import State

# Scalars that are continuous: unknowns, by the ends of their names.
_SMOOTH = ("rotation", "temperature", "potential")
#: Of the .npz files: raised when a key changes its name, shape or unit.
FORMAT = 1


class Table(NamedTuple):
    """Rows of named columns, such as a history: `values` has the shape (rows, columns)."""

    columns: tuple[str, ...]
    values: Array


class Result(ABC):
    """What an analysis returns.

    Fields are given at `points`, in SI units and by the names that files and figures use.
    """

    @property
    @abstractmethod
    def points(self) -> Array:
        """Where the fields are, shape (N, 2), m."""

    @abstractmethod
    def fields(self) -> dict[str, Array]:
        """Fields by name, shapes (N,) or (N, 2)."""

    @abstractmethod
    def summary(self) -> dict[str, Any]:
        """Plain numbers and words by name, for a terminal or JSON."""

    @property
    def cells(self) -> Cells | None:
        """The particles' cells, to be drawn as a surface; None draws dots."""
        return None

    @property
    def stressed(self) -> State | None:
        """The state whose stress is among the fields, if there is one."""
        return None

    def tables(self) -> dict[str, Table]:
        """Histories, paths and the like by name; none by default."""
        return {}

    def write(self, stem: str | os.PathLike[str]) -> tuple[Path, ...]:
        """Write fields as .vtu (ParaView) and .npz (Python), tables as .csv.

        Parameters
        ----------
        stem : path
            Suffixes are added to it as it stands.

        Returns
        -------
        tuple of Path
        """
        paths = list(write_arrays(self.points, self.fields(), stem, cells=self.cells))
        for name, table in self.tables().items():
            path = suffixed(stem, f".{name}.csv")
            header = ",".join(table.columns)
            with replacing(path) as partial:
                np.savetxt(partial, table.values, delimiter=",", header=header, comments="")
            paths.append(path)
        return tuple(paths)


def suffixed(stem: str | os.PathLike[str], suffix: str) -> Path:
    """The path with a suffix added; dots in its name stay ("h_0.05" is no suffix)."""
    path = Path(stem)
    return path.with_name(path.name + suffix)


@contextmanager
def replacing(target: Path) -> Iterator[Path]:
    """A path to write to, which takes the place of `target` when all of it is written."""
    partial = target.with_name(f".{target.name}.{os.getpid()}.partial")
    try:
        yield partial
        os.replace(partial, target)
    finally:
        # What cannot be removed could not be made either: the first error is the one to tell.
        with suppress(OSError):
            partial.unlink(missing_ok=True)


def write_arrays(
    points: Array,
    arrays: dict[str, Array],
    stem: str | os.PathLike[str],
    triangles: NDArray[np.int64] | None = None,
    cells: Cells | None = None,
) -> tuple[Path, Path]:
    """Write values at (N, 2) points as .vtu and .npz; vectors (N, 2) are padded for VTK.

    The .vtu holds what `vtk_mesh` makes of them, the .npz the values as they are.
    """
    vtu, npz = suffixed(stem, ".vtu"), suffixed(stem, ".npz")
    vtu.parent.mkdir(parents=True, exist_ok=True)
    mesh = vtk_mesh(points, arrays, triangles, cells)
    with replacing(vtu) as partial:
        mesh.write(partial, file_format="vtu")
    kept: dict[str, Any] = {"points": points, "format": FORMAT, **arrays}
    if triangles is not None:
        kept["triangles"] = np.asarray(triangles)
    with replacing(npz) as partial, open(partial, "wb") as stream:
        np.savez_compressed(stream, **kept)
    return vtu, npz


def vtk_mesh(
    points: Array,
    arrays: Mapping[str, Array],
    triangles: NDArray[np.int64] | None = None,
    cells: Cells | None = None,
) -> Any:
    """A mesh for ParaView: the particles' cells, or triangles between the points, or dots.

    On cells every field is cell data, and vectors and unknowns (what a body is warped by or what
    is looked at as a relief) are point data at the cells' corners too.
    """
    import meshio

    if cells is None:
        count = len(points)
        kind = (
            ("vertex", np.arange(count).reshape(-1, 1))
            if triangles is None
            else ("triangle", np.asarray(triangles))
        )
        return meshio.Mesh(_solid(points), [kind], point_data=_padded(arrays))
    smooth = {k: v for k, v in arrays.items() if v.ndim == 2 or k.endswith(_SMOOTH)}
    return meshio.Mesh(
        _solid(cells.corners),
        [("quad", cells.quads)],
        point_data=_padded({k: cells.at_corners(v) for k, v in smooth.items()}),
        cell_data={k: [v] for k, v in _padded(arrays).items()},
    )


def _solid(points: Array) -> Array:
    return np.column_stack([points, np.zeros(len(points))])


def _padded(arrays: Mapping[str, Array]) -> dict[str, Array]:
    return {name: _solid(a) if a.ndim == 2 else a for name, a in arrays.items()}
