"""Solids as scene files name them to an analysis: principal values along turned axes."""

from __future__ import annotations

from math import isfinite, radians

from ..errors import SceneError
from ..material import ConductivityTensor, ExpansionTensor


def heated(
    conductivities: tuple[float, float], expansions: tuple[float, float], angle_degrees: float
) -> tuple[ConductivityTensor, ExpansionTensor]:
    """A solid that conducts heat and expands.

    Parameters
    ----------
    conductivities : pair of float, W/(m K)
        Principal ones.
    expansions : pair of float, 1/K
        Along the same axes (in plane strain the effective ones).
    angle_degrees : float
        Turn of these axes, anticlockwise.

    Raises
    ------
    SceneError
        If a conductivity is not positive, or a number not finite.
    """
    if not all(isfinite(k) and k > 0 for k in conductivities):
        raise SceneError(f"conductivities must be positive and finite, not {conductivities}")
    if not all(map(isfinite, expansions)):
        raise SceneError(f"coefficients of expansion must be finite, not {expansions}")
    angle = radians(angle_degrees)
    expansion = ExpansionTensor.orthotropic(*expansions).rotated(angle)
    return ConductivityTensor.orthotropic(*conductivities, angle), expansion
