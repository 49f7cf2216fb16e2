"""Bonds of a body: which exist, what ends at the surface, how they strain (Eqs. 1–3)."""

from .bonds import Bonds, damage
from .cells import Cells
from .ended import EndedBonds
from .factors import Factors
from .volume_method import Surface, check_surface

__all__ = ["Bonds", "Cells", "EndedBonds", "Factors", "Surface", "check_surface", "damage"]
