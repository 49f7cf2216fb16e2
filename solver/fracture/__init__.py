"""Bonds break, the body finds a new equilibrium, cracks grow."""

from .crack_path import CrackPath
from .growth import Growth
from .programme import Programme
from .quasistatic import grow
from .temperatures import Temperatures
from .toughness import Toughness, ToughnessCalibration

__all__ = [
    "CrackPath",
    "Growth",
    "Programme",
    "Temperatures",
    "Toughness",
    "ToughnessCalibration",
    "grow",
]
