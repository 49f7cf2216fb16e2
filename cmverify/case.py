"""What a verification case is: methods that measure, and checks that judge.

A `Case` is declared once. pytest, asv, the command line and the report read the same object, so
that nothing is described twice. This module holds data only: running is `runner`'s business,
judging is `verdict`'s.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cmverify.exchange.statement import Pose

Array = NDArray[np.float64]


#: What is left of an error where arithmetic is all that is wrong.
ROUNDING = 1e-14


class Level(StrEnum):
    """How much time a run may take: seconds, a minute, or the paper's resolution."""

    QUICK = "quick"
    STANDARD = "standard"
    PAPER = "paper"


@dataclass(frozen=True)
class Field:
    """One scalar field beside its reference, at the points of a `FieldSet`.

    Attributes
    ----------
    label : str
        Symbol as a figure prints it, matplotlib mathtext allowed.
    unit : str
        Unit of both arrays; "1" for a number.
    computed, reference : (N,) arrays
    """

    label: str
    unit: str
    computed: Array
    reference: Array

    @property
    def difference(self) -> Array:
        """Computed minus reference, (N,)."""
        return self.computed - self.reference


@dataclass(frozen=True)
class FieldSet:
    """Fields over the plane: on lattice points, or on the vertices of triangles.

    Attributes
    ----------
    points : (N, 2) array, in metres or in units of the case's length
    items : mapping from a file-safe key to a `Field`
    spacing : grid spacing of a lattice; None for a mesh
    triangles : (M, 3) integer array for a mesh; None for a lattice
    """

    points: Array
    items: Mapping[str, Field]
    spacing: float | None = None
    triangles: NDArray[np.int64] | None = None


@dataclass(frozen=True)
class Stage:
    """What a body looks like at one moment of a run, for the row of pictures of an experiment.

    Attributes
    ----------
    label : str
        Such as "u* = 0.33 mm".
    at : (2,) array
        Where the moment lies in the first line plot of the measurement.
    values : (N,) array
        One scalar a particle, such as damage; NaN where particles came loose.
    """

    label: str
    at: Array
    values: Array


@dataclass(frozen=True)
class Stages:
    """Stages of one run, drawn in a row beside the first line plot.

    Attributes
    ----------
    quantity : str
        What the values are, such as "damage".
    points : (N, 2) array
    spacing : float
    stages : tuple of Stage
    outlines : tuple of (k, 2) arrays
        Lines drawn on each map, such as the rims of pins.
    """

    quantity: str
    points: Array
    spacing: float
    stages: tuple[Stage, ...]
    outlines: tuple[Array, ...] = ()


@dataclass(frozen=True)
class Curve:
    """Computed values along a line, (M,), beside the reference.

    The reference is given at `reference_abscissa`, (K,), or at the same abscissae without one.
    """

    label: str
    abscissa: Array
    computed: Array
    reference: Array
    reference_abscissa: Array | None = None

    def __post_init__(self) -> None:
        where = self.abscissa if self.reference_abscissa is None else self.reference_abscissa
        if len(self.abscissa) != len(self.computed) or len(where) != len(self.reference):
            raise ValueError(f"curve {self.label!r}: abscissae and values differ in length")


@dataclass(frozen=True)
class LinePlot:
    """A line plot as the paper draws them: one or more curves over one abscissa.

    `over_resolutions` asks the report to draw the first curve at every resolution that was run
    (the paper's Fig. 9) instead of all the curves at the finest, `over_methods` to draw it for
    every method at its finest resolution, side by side. `joined` draws lines between the
    computed values, for curves that would be hard to tell apart by markers alone;
    `reference_label` says in the legend what the references are.
    """

    title: str
    xlabel: str
    ylabel: str
    curves: tuple[Curve, ...]
    over_resolutions: bool = False
    over_methods: bool = False
    joined: bool = False
    reference_label: str = "closed form"


class Setting(NamedTuple):
    """With what a scene was solved: a place in the validity matrix."""

    physics: str
    calibration: str
    surface: str
    m: float
    influence: str


@dataclass(frozen=True)
class Measurement:
    """What one method gives at one resolution.

    Attributes
    ----------
    unknowns : int
        Size of the linear system that was solved.
    quantities : mapping
        Named figures that checks judge, such as relative L2 errors.
    seconds : mapping
        Wall seconds by stage ("setup", "solve", ...), JIT compilation excluded.
    statistics : mapping
        Whatever else is worth a column: iterations, residual, bonds, method chosen.
    fields, lines, stages
        What the report draws; may be left out.
    warnings : tuple of str
        What the solver said of the scenes that it was asked, each sentence once. The harness
        listens (`cmverify.run.worker`): no method needs to hand them on.
    scenes : tuple of Setting
        With what its scenes were solved, each once; the harness listens to these too.
    """

    unknowns: int
    quantities: Mapping[str, float]
    seconds: Mapping[str, float] = field(default_factory=dict)
    statistics: Mapping[str, float | int | str] = field(default_factory=dict)
    fields: FieldSet | None = None
    lines: tuple[LinePlot, ...] = ()
    stages: Stages | None = None
    warnings: tuple[str, ...] = ()
    scenes: tuple[Setting, ...] = ()

    @property
    def total_seconds(self) -> float:
        """Set-up and solve together; stages of post-processing do not count."""
        return sum(self.seconds.get(stage, 0.0) for stage in ("setup", "solve"))


def nothing_to_compile() -> None:
    """The warm-up of a method without compiled code."""


@dataclass(frozen=True)
class Method:
    """A way to solve the case's problem.

    Attributes
    ----------
    name : str
        Such as "bond/lattice" or "fem/P2".
    kind : "bond", "fem", "exact" or, of an answer that another program gave, "other"
    run : callable
        Takes a resolution n (spacing or mesh size a/n) and returns a `Measurement`.
    resolutions : mapping from Level to a tuple of ascending n
    warm_up : callable
        Compiles what `run` needs, so that no measured second is a compiler's.
    problem : str
        Which one it solves, where a case has several: what errors and times of different problems
        cost is not compared.
    """

    name: str
    kind: Literal["bond", "fem", "exact", "other"]
    run: Callable[[int], Measurement]
    resolutions: Mapping[Level, tuple[int, ...]]
    warm_up: Callable[[], None] = nothing_to_compile
    problem: str = ""

    @property
    def coarsest(self) -> int:
        """The smallest resolution of any level."""
        return min(n for ladder in self.resolutions.values() for n in ladder)


@dataclass(frozen=True)
class OrderBand:
    """Bounds for the observed order.

    Parameters
    ----------
    low, high : float
        The order must lie between them: too high is as suspicious as too low.
    since : int
        Resolutions below this one are pre-asymptotic and are not used.
    floor : float
        Where all errors are below it, rounding decides the order: a method that converges cannot
        get there, and the check fails.
    fitted : bool
        Fit one order to all resolutions instead of taking it between the two finest: for
        unstructured meshes, whose regularity differs from one to the next.
    """

    low: float
    high: float
    since: int = 0
    floor: float = 1e-13
    fitted: bool = False


@dataclass(frozen=True)
class Check:
    """What must hold for one quantity of one method.

    Attributes
    ----------
    at_most : mapping from resolution to an absolute bound
        Between listed resolutions the bound of the next coarser one holds: an error may not grow
        under refinement.
    equals : mapping from resolution to an exact value
    order : OrderBand, optional
    source : str
        Where the bounds come from, in words that a reader of the paper understands: theory, the
        paper's figure, another method, or a measurement with its margin.
    exact : bool
        Whether the quantity may be zero, or is but for rounding. If not, an error that is too
        good fails as one too large does: see `least_at`.
    """

    method: str
    quantity: str
    at_most: Mapping[int, float] = field(default_factory=dict)
    equals: Mapping[int, float] = field(default_factory=dict)
    order: OrderBand | None = None
    source: str = ""
    exact: bool = False

    def __post_init__(self) -> None:
        name = f"check of {self.method}/{self.quantity}"
        if not self.at_most and not self.equals and self.order is None:
            raise ValueError(f"{name} can never fail: no bound")
        if self.exact and self.order is not None:
            raise ValueError(f"{name}: what is exact has no order of convergence")

    def bound_at(self, resolution: int) -> float | None:
        """The absolute bound that holds at a resolution, or None below the coarsest listed."""
        listed = [n for n in self.at_most if n <= resolution]
        return self.at_most[max(listed)] if listed else None

    def least_at(self, resolution: int) -> float:
        """What the error of a method that is not exact cannot come below.

        Follows from the method and not from what was measured, so that an honest gain passes: its
        highest order and two more, h = 1/resolution; without an order the floor of rounding.
        """
        if self.order is None:
            return ROUNDING
        return max(self.order.floor, float(resolution) ** -(self.order.high + 2.0))


@dataclass(frozen=True)
class Case:
    """A benchmark problem with everything that is to be said about it.

    Attributes
    ----------
    name : str
        As the command line knows it.
    title, section, equations, figures
        What it is and where the paper has it.
    shows : str
        In a sentence, what a passed case shows.
    quantities : mapping from the name of a quantity to its description
    primary : str
        The quantity that convergence and work-precision plots show.
    featured : str
        The method whose fields and lines the report draws.
    length : str
        The length that resolutions divide: spacing = length/n.
    timed : bool
        Whether its seconds mean anything and belong in a work-precision diagram.
    poses : tuple of Pose
        Its problems as other programs are told them (`cmverify export`), the main one first;
        none if what it shows is no answer to a problem.
    elements : mapping from a name to a callable
        Solves a small one of the finite-element problems that judge it and that no method of kind
        "fem" solves: `cmverify run --cross-check` has another code solve it too.
    rivals : tuple of Method
        Ways to the main figure that nothing is promised of: runs leave them alone, and the study
        of work and precision measures them beside the others.
    """

    name: str
    title: str
    section: str
    shows: str
    methods: tuple[Method, ...]
    checks: tuple[Check, ...]
    quantities: Mapping[str, str]
    primary: str
    featured: str
    equations: tuple[str, ...] = ()
    figures: tuple[str, ...] = ()
    tags: tuple[str, ...] = ()
    length: str = "a"
    timed: bool = True
    poses: tuple[Pose, ...] = ()
    elements: Mapping[str, Callable[[], Any]] = field(default_factory=dict)
    rivals: tuple[Method, ...] = ()

    def __post_init__(self) -> None:
        every = [method.name for method in (*self.methods, *self.rivals)]
        if len(set(every)) != len(every):
            raise ValueError(f"case {self.name}: method names are not unique: {every}")
        names = [method.name for method in self.methods]
        if self.featured not in names:
            raise ValueError(f"case {self.name}: featured method {self.featured!r} is not declared")
        if self.primary not in self.quantities:
            raise ValueError(f"case {self.name}: primary quantity {self.primary!r} is undescribed")
        for check in self.checks:
            if check.method not in names:
                raise ValueError(f"case {self.name}: check of unknown method {check.method!r}")
            if check.quantity not in self.quantities:
                raise ValueError(f"case {self.name}: check of undescribed {check.quantity!r}")
        for pose in self.poses:
            if pose.method not in names:
                raise ValueError(f"case {self.name}: problem of unknown method {pose.method!r}")

    def method(self, name: str) -> Method:
        """The method of that name; KeyError if there is none."""
        for method in self.methods:
            if method.name == name:
                return method
        raise KeyError(f"case {self.name} has no method {name!r}")

    def plan(self, level: Level) -> Iterator[tuple[Method, int]]:
        """Every (method, resolution) of a level, coarse ones first."""
        pairs = [(m, n) for m in self.methods for n in m.resolutions.get(level, ())]
        yield from sorted(pairs, key=lambda pair: pair[1])


@dataclass(frozen=True)
class Failed:
    """A method that raised, or a worker that died, at one resolution."""

    error: str
    message: str
    traceback: str = ""


Outcome = Measurement | Failed


#: What is known of one case: method name -> resolution -> outcome.
Outcomes = Mapping[str, Mapping[int, Outcome]]
