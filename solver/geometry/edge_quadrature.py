"""Points on a body's edges at which its edge loads are evaluated."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Mask
from ..errors import SceneError
from .outline import Outline
from .regions import Region, Where

# Quadrature points on an edge of the outline: closer than the particles, which may have to carry
# each its own share.
_POINTS = 24
# An edge belongs to a straight line if both its ends lie within this share of its length.
_ALONG = 0.02
# Smaller shares of an edge are rounding of where a load begins.
_SLIVER = 1e-9


@dataclass(frozen=True, eq=False)
class Quadrature:
    """Points on the body's edges with weights, and what acts there.

    Attributes
    ----------
    outline : Outline
    edge : ndarray of int, shape (k,)
    position : ndarray, shape (k,)
        Along the edge, 0 to 1.
    weight : ndarray, shape (k,), m
    density : ndarray, shape (k, components)
        Per length (and unit thickness).
    """

    outline: Outline
    edge: NDArray[np.int64]
    position: Array
    weight: Array
    density: Array

    @classmethod
    def over(cls, outline: Outline, where: Where | None = None) -> Quadrature:
        """The region's edges, or the part that `where` selects.

        Raises
        ------
        SceneError
            If nothing is selected.
        """
        edge = np.nonzero(outline.face == 0)[0]
        rule = cls._rule(outline, edge, np.zeros(len(edge)), np.ones(len(edge)))
        if where is None:
            return rule
        x, y = rule.points.T
        inside = where.contains(x, y) if isinstance(where, Region) else np.asarray(where(x, y))
        if inside.dtype != bool or inside.shape != x.shape:
            raise SceneError("a selection must return one boolean a point")
        if not inside.any():
            raise SceneError("a load on the edge acts nowhere: no point of the edge is selected")
        return rule._pick(inside)

    @classmethod
    def between(cls, outline: Outline, start: Array, end: Array) -> Quadrature:
        """The edges, or parts of them, along a straight line."""
        first, last = (outline.nodes[outline.edges[:, k]] for k in (0, 1))
        length = float(np.hypot(*(end - start)))
        along = (end - start) / length
        across = np.array([-along[1], along[0]])
        near = (outline.face == 0) & (np.abs(outline.outward @ along) < 1e-6)
        for point in (first, last):
            near &= np.abs((point - start) @ across) < _ALONG * outline.length
        edge = np.nonzero(near)[0]
        a, b = ((point[edge] - start) @ along for point in (first, last))
        # Edges may run either way.
        ends = [np.clip((x - a) / (b - a), 0.0, 1.0) for x in (0.0, length)]
        low, high = np.minimum(*ends), np.maximum(*ends)
        kept = high > low + _SLIVER
        return cls._rule(outline, edge[kept], low[kept], high[kept])

    @classmethod
    def _rule(
        cls, outline: Outline, edge: NDArray[np.int64], low: Array, high: Array
    ) -> Quadrature:
        """Midpoints of equal parts of every edge between two positions."""
        middle = (np.arange(_POINTS) + 0.5) / _POINTS
        position = (low[:, None] + (high - low)[:, None] * middle).ravel()
        weight = np.repeat((high - low) * outline.length[edge] / _POINTS, _POINTS)
        return cls(outline, np.repeat(edge, _POINTS), position, weight, np.zeros((len(weight), 0)))

    def _pick(self, chosen: Mask) -> Quadrature:
        parts = (self.position, self.weight, self.density)
        return Quadrature(self.outline, self.edge[chosen], *(part[chosen] for part in parts))

    def __len__(self) -> int:
        return len(self.edge)

    @property
    def points(self) -> Array:
        """Shape (k, 2), m."""
        first, last = (self.outline.nodes[self.outline.edges[self.edge, k]] for k in (0, 1))
        return first + self.position[:, None] * (last - first)

    @property
    def normals(self) -> Array:
        """Outward, shape (k, 2)."""
        return self.outline.outward[self.edge]

    def carrying(self, density: Array) -> Quadrature:
        """The same points with a density."""
        return replace(self, density=density)

    @property
    def force(self) -> Array:
        """What acts at each point, shape (k, components)."""
        return self.weight[:, None] * self.density
