"""Cracks as they are drawn: polylines along which bonds are cut."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from .regions import Point, moved_points


@dataclass(frozen=True)
class Crack:
    """Cut along the polyline through `points`; bonds that cross it are cut.

    Cracks may share ends, cross, branch and overlap: they act as the one set of points that they
    are, see `solver.geometry.crack_set`. An end that lies in the body is a tip and belongs to the
    uncut material: a bond through the very tip stays. One on the body's edge, beyond it, or less
    than half a cell before it is a mouth.

    Raises
    ------
    ValueError
        If there are fewer than two points, all coincide, or one is not finite.

    Examples
    --------
    >>> Crack((-1.0, 0.0), (0.0, 0.0)).segments
    (((-1.0, 0.0), (0.0, 0.0)),)
    """

    points: tuple[Point, ...]

    def __init__(self, *points: Point) -> None:
        array = np.array(points, dtype=np.float64)
        if array.ndim != 2 or array.shape[1] != 2 or len(array) < 2:
            raise ValueError(f"a crack runs through two or more points of the plane, not {points}")
        if not np.all(np.isfinite(array)):
            raise ValueError(f"a crack with a point that is not finite: {points}")
        # A point drawn twice is one.
        fresh = np.append(True, (np.diff(array, axis=0) != 0).any(axis=1))
        array = array[fresh]
        if len(array) < 2:
            raise ValueError(f"a crack of no length: {points}")
        object.__setattr__(self, "points", tuple((float(x), float(y)) for x, y in array))

    def moved(self, by: Point, grid: float = 0.0) -> Crack:
        """As `Region.moved`; the crack remembers as what it was drawn."""
        result = Crack(*moved_points(self.points, by, grid))
        object.__setattr__(result, "_drawn", self.drawn)
        return result

    @property
    def drawn(self) -> tuple[Point, ...]:
        """The points that the user gave, m: what messages say."""
        drawn: tuple[Point, ...] = getattr(self, "_drawn", self.points)
        return drawn

    @property
    def closed(self) -> bool:
        """Whether it ends where it starts: then it has no tips."""
        return self.points[0] == self.points[-1]

    @property
    def segments(self) -> tuple[tuple[Point, Point], ...]:
        """Its straight pieces."""
        return tuple(pairwise(self.points))
