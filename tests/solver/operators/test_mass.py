"""Displacements carry the mass of what a particle stands for, rotations none."""

import numpy as np

from solver.material.physics import ELASTICITY, HEAT
from solver.operators.mass import inertia


def test_rotations_carry_nothing():
    volumes, active = np.array([1.0, 2.0, 3.0]), np.array([0, 2])
    assert inertia(volumes, active, ELASTICITY, 3).tolist() == [[1, 3], [1, 3], [0, 0]]
    assert inertia(volumes, active, ELASTICITY, 2).tolist() == [[1, 3], [1, 3]]
    assert inertia(volumes, active, HEAT, 1).tolist() == [[1, 3]]
