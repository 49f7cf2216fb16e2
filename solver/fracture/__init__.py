"""Bonds break, the body finds a new equilibrium, cracks grow."""

from .growth import Growth
from .quasistatic import grow

__all__ = ["Growth", "grow"]
