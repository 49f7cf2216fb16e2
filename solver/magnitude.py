"""How large numbers may be: units far from the body's own leave the range of double precision.

Norms square what they measure, and calibrations and eigenvalues multiply three moduli or divide by
powers of the spacing. Within these bounds no product leaves 1e±308; any unit in use stays far
within them.
"""

from __future__ import annotations

from numbers import Real
from typing import Any

from .errors import SceneError

#: Moduli, densities and capacities, in any unit.
MODULI = (1e-50, 1e50)
#: Spacings and thicknesses, in any unit.
LENGTHS = (1e-30, 1e30)
#: Durations and steps, in any unit.
TIMES = (1e-50, 1e50)
#: Values that are given, in any unit.
VALUES = (0.0, 1e150)
#: What a load or a prescribed value makes of a cell, as a strain (or difference over its size).
STRAINS = (1e-100, 1e100)


def outside(size: float, bounds: tuple[float, float]) -> str:
    """In words, what is wrong with a size; empty if nothing is, or if it is zero."""
    low, high = bounds
    if size == 0.0 or low <= size <= high:
        return ""
    return (
        f"of the size {size:.1e}, not between {low:g} and {high:g}: its squares and products would "
        f"leave the range of numbers; choose other units"
    )


def require_positive(given: Any, what: str, unit: str, bounds: tuple[float, float]) -> None:
    """Refuse what is no positive number, or leaves the bounds.

    Raises
    ------
    SceneError
    """
    real = isinstance(given, Real) and not isinstance(given, bool)
    if not (real and 0.0 < given < float("inf")):
        raise SceneError(f"{what} must be positive ({unit}), not {given!r}")
    if wrong := outside(float(given), bounds):
        raise SceneError(f"{what} is {wrong}")
