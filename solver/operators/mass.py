"""Masses of particles: ρ times the area of the body that each stands for.

Which area that is, and that the areas add up to the body's where its edges lie as drawn, is
`Discretisation.volumes`: a body whose size is no whole number of cells is of first order without.

Rotations carry no mass: a Cauchy solid resists no rotation of its points. Modes condense them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..material.physics import Physics


def inertia(volumes: Array, active: NDArray[np.int64], physics: Physics, components: int) -> Array:
    """Inertia of the active unknowns at density one, none in rotations, (components, active).

    Parameters
    ----------
    volumes : ndarray, shape (N,), cells
    active : ndarray of int
        Numbers of the active particles.
    """
    moves = ~np.array(physics.turning[:components])
    return np.asarray(np.where(moves[:, None], volumes[active], 0.0))
