"""From what the solver and the references return to what a `Measurement` holds."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from cmverify.case import Array, Curve, Level, Measurement, Method

if TYPE_CHECKING:
    from references.fem.mesh import Mesh

#: Thickness of the prescribed layer in cells: a family at m = 5 with partial areas reaches 5.5.
LAYER_CELLS = 5.5


def disc_lattice(n: int) -> Array:
    """Particle centres of the unit disc, half-integer multiples of 1/n, (N, 2).

    Written here and not taken from the solver: finite elements are evaluated at these points, and
    they count the particles that the solver should have.
    """
    axis = (np.arange(-n, n) + 0.5) / n
    x, y = np.meshgrid(axis, axis)
    inside = x**2 + y**2 < 1.0
    return np.column_stack([x[inside], y[inside]])


def free_points(n: int) -> Array:
    """The centres of `disc_lattice` that no layer of 5.5 cells prescribes."""
    points = disc_lattice(n)
    return points[np.hypot(*points.T) < 1.0 - LAYER_CELLS / n]


@dataclass(frozen=True)
class Stored:
    """Solves a stored reference's finite elements anew, with some of its arguments changed.

    For `Case.elements`: small meshes, and few of the reference's rows.
    """

    name: str
    changes: dict[str, Any]

    def __call__(self) -> None:
        from references.catalogue import catalogue

        reference = catalogue()[self.name]
        reference.generator(**{**reference.arguments, **self.changes})


def stored(name: str, **changes: Any) -> dict[str, Callable[[], Any]]:
    """A stored reference as an item of `Case.elements`."""
    return {f"stored {name}": Stored(name, changes)}


def row(points: Array, height: float, spacing: float) -> np.ndarray:
    """Indices of the lattice row nearest to a height, by ascending x.

    Of two rows at the same distance the upper is taken.
    """
    wanted = (np.floor(height / spacing + 1e-9) + 0.5) * spacing
    index = np.flatnonzero(np.abs(points[:, 1] - wanted) < 0.25 * spacing)
    return index[np.argsort(points[index, 0])]


def curves_along_rows(
    points: Array,
    computed: Array,
    reference: Array,
    heights: Sequence[float],
    spacing: float,
) -> tuple[Curve, ...]:
    """A curve for each height, over x1."""
    curves = []
    for height in heights:
        index = row(points, height, spacing)
        label = f"$x_2/a = {height:g}$"
        curves.append(Curve(label, points[index, 0], computed[index], reference[index]))
    return tuple(curves)


@contextmanager
def stopwatch(seconds: dict[str, float], stage: str) -> Iterator[None]:
    """Add the wall seconds of the block to a stage."""
    start = time.perf_counter()
    try:
        yield
    finally:
        seconds[stage] = seconds.get(stage, 0.0) + time.perf_counter() - start


def solver_seconds(statistics: Any) -> dict[str, float]:
    """Set-up and solve seconds of a bond solution."""
    return {"setup": statistics.setup_seconds, "solve": statistics.solve_seconds}


def solver_statistics(statistics: Any) -> dict[str, float | int | str]:
    """The columns of a bond solution in a method table."""
    names = ("particles", "bonds", "method", "iterations", "residual")
    found = {name: getattr(statistics, name, None) for name in names}
    return {name: value for name, value in found.items() if value is not None}


def fem_seconds(meshing: float, seconds: dict[str, float]) -> dict[str, float]:
    """Stages of a finite-element solution; meshing is told but does not count as work.

    A general mesh generator takes longer than the solution, a lattice needs none: to count it
    would flatter the lattice on a body that happens to be a disc.
    """
    return {"setup": seconds["assembly"], "solve": seconds["solve"], "meshing": meshing}


def fem_statistics(mesh: Mesh, order: int) -> dict[str, float | int | str]:
    """The columns of a finite-element solution in a method table."""
    return {
        "triangles": len(mesh.triangles),
        "vertices": len(mesh.points),
        "order": order,
        "method": "sparse LU",
    }


def elements(
    run: Callable[[int, bool, int], Measurement],
    resolutions: Mapping[Level, tuple[int, ...]],
    graded: bool = True,
) -> tuple[Method, ...]:
    """Linear, quadratic, graded quadratic elements, for `Case.rivals`: `run(order, graded, n)`."""
    kinds = [("fem/P1", 1, False), ("fem/P2", 2, False), ("fem/P2 graded", 2, True)]
    return tuple(
        Method(name, "fem", partial(run, order, finer), resolutions)
        for name, order, finer in kinds
        if graded or not finer
    )


@lru_cache(maxsize=6)
def timed_mesh(build: Callable[..., Mesh], size: float, **options: float) -> tuple[Mesh, float]:
    """A mesh and the seconds it took; gmsh is loaded beforehand and not counted.

    Problems on the same body share it: meshing takes longer than all else and is deterministic.
    """
    from references.fem.mesh import load_gmsh

    load_gmsh()
    start = time.perf_counter()
    mesh = build(size, **options)
    return mesh, time.perf_counter() - start
