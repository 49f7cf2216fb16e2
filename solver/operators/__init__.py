"""Stiffness of a body as products with fields, assembled where somebody needs the matrix."""

from .bond_operator import BondOperator
from .surface_stiffness import SurfaceStiffness
from .tip_stiffness import TipStiffness

__all__ = ["BondOperator", "SurfaceStiffness", "TipStiffness"]
