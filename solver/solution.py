"""What a solve returns: fields at the particles, and how they were obtained."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

from scipy.sparse.linalg import LinearOperator

from . import recovery
from .arrays import Array
from .bonds import Cells
from .material.physics import ELASTICITY
from .result import Result
from .state import State


@dataclass(frozen=True)
class Statistics:
    """How a solution was obtained.

    Attributes
    ----------
    particles, unknowns, bonds : int
        Particles of the body, free unknowns, directed bonds that a product visits.
    method : str
        Solver and preconditioner.
    kind, margin : str, float
        Of the operator, see `solver.material.stability.Stability`.
    iterations : int
    residual : float
        |b − K x| / |b|, evaluated at the end with the operator itself.
    setup_seconds, solve_seconds : float
        Wall time of the discretisation (with the preconditioner) and of the solver.
    peak_memory : int
        Peak resident memory of the process so far, bytes.
    warnings : tuple of str
        What the answer leaves out or settles by a rule, one sentence each.
    """

    particles: int
    unknowns: int
    bonds: int
    method: str
    kind: str
    margin: float
    iterations: int
    residual: float
    setup_seconds: float
    solve_seconds: float
    peak_memory: int
    warnings: tuple[str, ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """Plain values, for JSON."""
        return asdict(self)


@dataclass(frozen=True, eq=False)
class Solution(State, Result):
    """Fields at the particles of a body.

    Attributes
    ----------
    discretisation : Discretisation
    unknowns : ndarray, shape (components, N)
        u1, u2 and θ Δx, or T.
    statistics : Statistics
    preconditioner : LinearOperator, optional
        Kept so that a later solve of the same body may reuse it.
    """

    statistics: Statistics
    preconditioner: LinearOperator | None = field(default=None, repr=False)

    @property
    def cells(self) -> Cells:
        """The particles' cells, parted where bonds carry nothing."""
        return Cells.of(self.discretisation.bonds)

    @property
    def stressed(self) -> State | None:
        """Itself, if it is elastic."""
        return self if self.physics is ELASTICITY else None

    def fields(self) -> dict[str, Array]:
        """What was solved for and what is recovered from it, by name, (N,) or (N, 2), SI units."""
        prescribed = self.prescribed.astype(float)
        return {"prescribed": prescribed, **self.solved(), **recovery.fields(self)}

    def summary(self) -> dict[str, Any]:
        """What was solved and how."""
        return {"physics": self.physics.name, **self.statistics.as_dict()}
