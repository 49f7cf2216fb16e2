"""A case's problem as anybody's program is told it, and what is judged of an answer.

A case poses its problem once (`cmverify.case.Case.poses`); `cmverify export` writes it and
`cmverify compare` judges by it, so that both know every case in the same way.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cmverify.judge.norms import (
    largest_deviation,
    line_distance,
    relative_l2,
    without_rigid_motion,
)

Array = NDArray[np.float64]


def _without_rigid(points: Array | None, computed: Array, reference: Array) -> float:
    assert points is not None
    return relative_l2(*(without_rigid_motion(points, u) for u in (computed, reference)))


#: What an error is: (points, computed, reference) → number, by the words that files print.
NORMS: dict[str, Callable[[Array | None, Array, Array], float]] = {
    "sqrt(sum |a - b|^2) / sqrt(sum |b|^2)": lambda _, a, b: relative_l2(a, b),
    "sqrt(sum |a - b|^2) / sqrt(sum |b|^2), means of translation and rotation off": _without_rigid,
    "max |a / b - 1|": lambda _, a, b: largest_deviation(a, b),
    "max |a - b|": lambda _, a, b: float(np.abs(a - b).max()),
    "largest distance between the lines": lambda _, a, b: line_distance(a, b),
}
L2, L2_STRAINED, LARGEST, ABSOLUTE, LINES = NORMS


@dataclass(frozen=True)
class Target:
    """One thing that is judged of an answer.

    Attributes
    ----------
    key : str
        Its name in files.
    quantity : str
        Of the case: whose bounds judge it and what it is called in tables.
    unit : str
    reference : ndarray
        A field at `points`: (P,) or (P, 2); with `times` (T, P) or (T, P, 2). Without points
        numbers, (k,).
    norm : str
        A key of `NORMS`.
    points : (P, 2) array, m, optional
    times : (T,) array, s, optional
    columns : tuple of str
        Names of its components in tables of columns.
    needed : bool
        Whether an answer without it is refused.
    read : callable, optional
        Reads it from the answer's crack path, (k, 2), where the answer gives that and no number.
    """

    key: str
    quantity: str
    unit: str
    reference: Array
    norm: str = L2
    points: Array | None = None
    times: Array | None = None
    columns: tuple[str, ...] = ()
    needed: bool = True
    read: Callable[[Array], Array] | None = None

    def __post_init__(self) -> None:
        if self.norm not in NORMS:
            raise ValueError(f"target {self.key}: no norm is called {self.norm!r}")
        parts = [p for p in (self.times, self.points) if p is not None]
        shape = tuple(len(p) for p in parts)
        if self.reference.shape[: len(shape)] != shape:
            raise ValueError(f"target {self.key}: {self.reference.shape} values, {shape} places")

    @property
    def line(self) -> bool:
        """Whether it is a line of any number of points, such as a crack's path."""
        return self.norm == LINES

    @property
    def names(self) -> tuple[str, ...]:
        """Of the columns, one a component."""
        return self.columns or (self.key,)

    def error(self, computed: Array) -> float:
        """The error of values of the reference's shape."""
        return NORMS[self.norm](self.points, computed, self.reference)


@dataclass(frozen=True)
class Statement:
    """A problem at one resolution.

    Attributes
    ----------
    scene : solver.Scene
        Body, solid, cracks, supports, loads, and the lattice that we would take.
    targets : tuple of Target
        The first is the one that figures show.
    remarks : tuple of str
        What the scene does not say, such as what the initial state is.
    """

    scene: Any
    targets: tuple[Target, ...]
    remarks: tuple[str, ...] = ()


def laid_out(scene: Any) -> Any:
    """The scene at its beginning on its lattice, a `solver.problem.Discretisation`.

    A free body is no fault: an answer may be a mode or a motion.
    """
    from solver.problem import Discretisation

    return Discretisation.of(scene.at(0.0), constrained=True, free=True)


def free_particles(scene: Any) -> Array:
    """Particles whose place (or temperature) is not prescribed, (P, 2), m.

    Raises
    ------
    ValueError
        If there are none: the problem has no answer to judge.
    """
    parts = laid_out(scene)
    if parts.held.all():
        raise ValueError(
            f"at a spacing of {scene.spacing:g} everything is prescribed: take a finer resolution"
        )
    return np.asarray(parts.lattice.places[~parts.held])


@dataclass(frozen=True)
class Pose:
    """A problem of a case, stated at a resolution.

    Attributes
    ----------
    method : str
        Of ours, that solves this very problem: its bounds judge an answer, and its result stands
        beside it.
    state : callable
        Resolution → Statement.
    name : str
        Where a case poses several problems.
    """

    method: str
    state: Callable[[int], Statement]
    name: str = ""
