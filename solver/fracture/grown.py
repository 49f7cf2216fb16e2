"""Growing cracks with something beside them: what all such results hand out of the cracks."""

from __future__ import annotations

from dataclasses import dataclass

from ..arrays import Array
from ..bonds import Cells
from ..result import Result
from ..state import State
from .growth import Growth


@dataclass(frozen=True, eq=False)
class Grown(Result):
    """A run in which cracks grew.

    Attributes
    ----------
    growth : Growth
    """

    growth: Growth

    @property
    def points(self) -> Array:
        """Particle centres, shape (N, 2), m."""
        return self.growth.points

    @property
    def cells(self) -> Cells | None:
        """The particles' cells, parted where bonds carry nothing."""
        return self.growth.cells

    @property
    def stressed(self) -> State:
        """The last equilibrium."""
        return self.growth.solution
