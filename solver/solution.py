"""What a solve returns: fields at the particles, and how they were obtained."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator

from .arrays import Array
from .problem import Description, Discretisation


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
class Solution:
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

    discretisation: Discretisation
    unknowns: Array
    statistics: Statistics
    preconditioner: LinearOperator | None = field(default=None, repr=False)

    @property
    def scene(self) -> Description:
        """The scene that was solved."""
        return self.discretisation.scene

    @property
    def points(self) -> Array:
        """Particle centres, shape (N, 2), m."""
        return self.discretisation.lattice.points

    @property
    def spacing(self) -> float:
        """Δx, m."""
        return self.scene.spacing

    @property
    def prescribed(self) -> NDArray[np.bool_]:
        """Particles of which everything is prescribed, or which were set aside, shape (N,)."""
        return np.logical_and.reduce(self.discretisation.prescribed, axis=0)

    def _need(self, elastic: bool) -> None:
        if self.scene.elastic != elastic:
            held = "temperatures" if elastic else "displacements"
            raise AttributeError(f"this solution holds {held}, not what was asked for")

    @property
    def displacement(self) -> Array:
        """u, shape (N, 2), m."""
        self._need(True)
        return self.unknowns[:2].T

    @property
    def rotation(self) -> Array:
        """θ, shape (N,), rad; NaN where the solid has no rotations (no shear stiffness)."""
        self._need(True)
        if len(self.unknowns) < 3:
            return np.full(self.unknowns.shape[1], np.nan)
        return self.unknowns[2] / self.spacing

    @property
    def surface_points(self) -> Array:
        """Nodes of the surface at which bonds end, shape (s, 2), m; none where no bond does."""
        surface = self.discretisation.operator.ended_stiffness
        if surface is None:
            return np.zeros((0, 2))
        return surface.ended.outline.nodes[surface.nodes]

    def _at_surface(self) -> Array:
        values = self.discretisation.surface_values(self.unknowns)
        return np.zeros((len(self.unknowns), 0)) if values is None else values

    @property
    def surface_displacement(self) -> Array:
        """u at the surface's nodes, shape (s, 2), m."""
        self._need(True)
        return self._at_surface()[:2].T

    @property
    def surface_temperature(self) -> Array:
        """T at the surface's nodes, shape (s,), K."""
        self._need(False)
        return self._at_surface()[0]

    @property
    def temperature(self) -> Array:
        """T, shape (N,), K (the potential, V, in electrical conduction)."""
        self._need(False)
        return self.unknowns[0]
