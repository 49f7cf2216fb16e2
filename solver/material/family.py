"""The family: which neighbours a particle of the regular grid interacts with, and how much.

On a regular grid every family is the same set of integer offsets, so it is stored once. The
offsets come in opposite pairs: the second half of every array is the first half mirrored, which
is what lets the kernels treat a bond and its mirror image together.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..magnitude import LENGTHS, outside
from .influence import CONSTANT, Influence, influence

AreaRule = Literal["full", "partial", "exact"]

# Lengths equal to the horizon up to rounding belong to the family (or 3-4-5 triangles flicker).
_TIE = 1e-9
# A cell with a smaller share inside the horizon is left out.
_SMALLEST_FRACTION = 1e-12


def _quarter_area(x: Array, y: Array, radius: float) -> Array:
    """Area of the circle about 0 within [0, x] × [0, y] for x, y ≥ 0."""
    x, y = np.minimum(x, radius), np.minimum(y, radius)
    # Left of `corner` the circle lies above y, right of it the arc is the upper limit.
    corner = np.minimum(np.sqrt(np.maximum(radius**2 - y**2, 0.0)), x)

    def under_arc(t: Array) -> Array:
        t = np.minimum(t, radius)
        return 0.5 * (
            t * np.sqrt(np.maximum(radius**2 - t**2, 0.0)) + radius**2 * np.arcsin(t / radius)
        )

    return corner * y + under_arc(x) - under_arc(corner)


def _cell_circle_area(i: Array, j: Array, radius: float) -> Array:
    """Area of the unit cell about (i, j) inside the circle of `radius` about 0 (PA-AC)."""

    def signed(x: Array, y: Array) -> Array:
        return np.sign(x) * np.sign(y) * _quarter_area(np.abs(x), np.abs(y), radius)

    return (
        signed(i + 0.5, j + 0.5)
        - signed(i - 0.5, j + 0.5)
        - signed(i + 0.5, j - 0.5)
        + signed(i - 0.5, j - 0.5)
    )


@dataclass(frozen=True)
class Family:
    """Offsets, area fractions and geometry of the bonds of a bulk particle.

    Parameters
    ----------
    m : float
        Horizon in cells, δ = m Δx; any number ≥ 1.
    spacing : float
        Grid spacing Δx, m.
    area_rule : {"partial", "full", "exact"}
        ``full``: whole cells with centres within δ. ``partial``: α = clip(m + 1/2 − r/Δx, 0, 1)
        (Hu, Ha, Bobaru 2010, the paper's). ``exact``: area of the cell within the circle
        (Seleson 2014, PA-AC).
    influence : Influence
        Λ of the bond length.

    Raises
    ------
    ValueError
        If m < 1, the spacing is not positive, or the area rule is unknown.
    """

    m: float
    spacing: float = 1.0
    area_rule: AreaRule = "partial"
    influence: Influence = CONSTANT

    def __post_init__(self) -> None:
        if not (np.isfinite(self.m) and self.m >= 1):
            raise ValueError(f"the horizon must be at least one cell: m = {self.m}")
        if not (np.isfinite(self.spacing) and self.spacing > 0):
            raise ValueError(f"the grid spacing must be positive: {self.spacing}")
        if wrong := outside(self.spacing, LENGTHS):
            raise ValueError(f"the grid spacing is {wrong}")
        if self.area_rule not in get_args(AreaRule):
            raise ValueError(
                f"unknown area rule {self.area_rule!r}; known: {', '.join(get_args(AreaRule))}"
            )
        object.__setattr__(self, "influence", influence(self.influence))
        if not self.size:
            raise ValueError(
                f"the family is empty: at m = {self.m:g} the influence function "
                f"{self.influence.name!r} leaves no neighbour any weight"
            )

    @cached_property
    def _selected(self) -> tuple[NDArray[np.int64], Array]:
        reach = int(np.ceil(self.m + 1))
        j, i = np.mgrid[-reach : reach + 1, -reach : reach + 1]
        i, j = i.ravel(), j.ravel()
        upper = (j > 0) | ((j == 0) & (i > 0))
        i, j = i[upper], j[upper]
        r = np.hypot(i, j)
        if self.area_rule == "full":
            fraction = (r <= self.m * (1 + _TIE)).astype(np.float64)
        elif self.area_rule == "partial":
            fraction = np.clip(self.m + 0.5 - r, 0.0, 1.0)
        else:
            fraction = _cell_circle_area(i.astype(float), j.astype(float), self.m)
        fraction = fraction * (self.influence(r / self.m) > 0)
        kept = fraction > _SMALLEST_FRACTION
        half = np.column_stack([i, j])[kept]
        return np.vstack([half, -half]), np.tile(fraction[kept], 2)

    @property
    def offsets(self) -> NDArray[np.int64]:
        """Integer offsets (columns, rows) of the neighbours, shape (n, 2); o[k + n/2] = −o[k]."""
        return self._selected[0]

    @property
    def fraction(self) -> Array:
        """Area fractions α in (0, 1], shape (n,)."""
        return self._selected[1]

    @cached_property
    def weight(self) -> Array:
        """α Λ, shape (n,)."""
        return self.fraction * self.influence(self.length / self.horizon)

    @property
    def size(self) -> int:
        """Number of neighbours of a bulk particle."""
        return len(self.offsets)

    @property
    def reach(self) -> int:
        """Largest offset along an axis, cells."""
        return int(np.abs(self.offsets).max())

    @property
    def horizon(self) -> float:
        """δ = m Δx, m."""
        return self.m * self.spacing

    @cached_property
    def length(self) -> Array:
        """|ξ|, shape (n,), m."""
        return self.spacing * np.hypot(self.offsets[:, 0], self.offsets[:, 1])

    @cached_property
    def normal(self) -> Array:
        """n = ξ/|ξ|, shape (n, 2)."""
        return self.offsets * (self.spacing / self.length)[:, None]

    @cached_property
    def tangent(self) -> Array:
        """t = n turned by +90°, shape (n, 2)."""
        return np.column_stack([-self.normal[:, 1], self.normal[:, 0]])

    @cached_property
    def angle(self) -> Array:
        """ψ = arg ξ, shape (n,), rad."""
        return np.arctan2(self.offsets[:, 1], self.offsets[:, 0])

    @property
    def cell_area(self) -> float:
        """Δv = Δx² per unit thickness, m²."""
        return self.spacing**2
