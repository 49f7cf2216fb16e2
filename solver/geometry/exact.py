"""Positions in cells, and signs of areas that no rounding decides.

Whatever lies between particles is asked in cells of the lattice, relative to its first cell. So
the particles are whole numbers, and neither units nor the distance to the origin matter. Corners of
bodies and of cracks are rounded to 2⁻²⁰ of a cell: less than any length the lattice tells apart,
and more than the rounding of coordinates given a billion cells from the origin, so that what was
meant to lie on a line does. From there on every sign is exact: float64 holds the coordinates as
whole numbers of 2⁻²⁰ cells, and a product that is too large for it is kept in two parts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Array
from ..compiled import kernel
from ..errors import SceneError
from .lattice import Lattice

#: Units of length in a cell.
CELL = 2.0**20
# Coordinates (units) up to which signs are exact.
_LARGEST = 2.0**49
# Dekker's constant: splits a float64 into two halves of 26 bits.
_SPLIT = 2.0**27 + 1.0
# Share of the two products below which their difference may be all rounding.
_DOUBT = 2.0**-50

_OPTIONS: Any = {"nogil": True}


@dataclass(frozen=True, eq=False)
class Frame:
    """Cells of a lattice as coordinates.

    Attributes
    ----------
    origin : ndarray, shape (2,), m
        Centre of the padded grid's first cell.
    spacing : float
        m.
    """

    origin: Array
    spacing: float

    @classmethod
    def of(cls, lattice: Lattice) -> Frame:
        """The frame in which particle (row, column) lies at (column, row) cells."""
        x, y = lattice.axes
        return cls(np.array([x[0], y[0]]), lattice.spacing)

    def units(self, points: Array) -> Array:
        """Points (m), shape (n, 2), in whole units.

        Raises
        ------
        SceneError
            If one lies so far away that signs would not be exact.
        """
        found = np.rint((np.asarray(points) - self.origin) / self.spacing * CELL)
        if not (np.abs(found) <= _LARGEST).all():
            raise SceneError("a point of an edge or a crack lies half a billion cells away")
        # No −0.
        return np.asarray(found + 0.0)

    def metres(self, units: Array) -> Array:
        """The inverse of `units`."""
        return np.asarray(self.origin + units / CELL * self.spacing)


@kernel(**_OPTIONS)
def _rest(a: float, b: float, product: float) -> float:
    """a b less its rounded product, exactly (Dekker)."""
    c = _SPLIT * a
    high_a = c - (c - a)
    low_a = a - high_a
    c = _SPLIT * b
    high_b = c - (c - b)
    low_b = b - high_b
    return low_a * low_b - (((product - high_a * high_b) - low_a * high_b) - high_a * low_b)


@kernel(**_OPTIONS)
def sign_of_cross(ax: float, ay: float, bx: float, by: float) -> int:
    """Sign of ax by − ay bx for whole numbers below 2⁵⁰, exact."""
    one, other = ax * by, ay * bx
    difference = one - other
    if abs(difference) <= _DOUBT * (abs(one) + abs(other)):
        # Nearly equal: their difference is exact, and so is that of what rounding took from each.
        difference += _rest(ax, by, one) - _rest(ay, bx, other)
    if difference > 0.0:
        return 1
    return -1 if difference < 0.0 else 0


@kernel(**_OPTIONS)
def side(ax: float, ay: float, bx: float, by: float, px: float, py: float) -> int:
    """1 if p lies to the left of the line from a to b, −1 to its right, 0 on it."""
    return sign_of_cross(bx - ax, by - ay, px - ax, py - ay)
