"""A state names its values, in their own units."""

import numpy as np
import pytest

from solver import Scene, Support, rectangle
from solver.material import ConductivityTensor, ElasticTensor
from solver.state import State

STRAINED = Support.where(
    lambda x, y: abs(x) > 1.0, displacement=lambda x, y: np.stack([0.1 * x, 0 * y], axis=-1)
)


def state_of(material, support, seed=0):
    body = Scene(rectangle(3.0, 2.0), 0.25, material, [support], m=2).discretise()
    values = np.random.default_rng(seed).normal(size=body.values.shape)
    return State(body, values)


def test_rotations_come_back_in_radians():
    state = state_of(ElasticTensor.isotropic(1.0, 0.2), STRAINED)
    np.testing.assert_array_equal(state.values[:2], state.unknowns[:2])
    np.testing.assert_allclose(state.rotation, state.unknowns[2] / 0.25)
    assert set(state.solved()) == {"displacement", "rotation"}
    assert state.displacement.shape == (len(state.points), 2)


def test_a_solid_without_shear_bonds_has_no_rotations():
    state = state_of(ElasticTensor.isotropic(1.0, 1 / 3), STRAINED)
    assert set(state.solved()) == {"displacement"}
    assert np.isnan(state.rotation).all()


def test_other_physics_are_refused_by_name():
    warm = Support.where(lambda x, y: x > 1.0, temperature=1.0)
    state = state_of(ConductivityTensor.isotropic(1.0), warm)
    assert set(state.solved()) == {"temperature"}
    for name in ("displacement", "rotation", "surface_displacement"):
        with pytest.raises(AttributeError, match="heat conduction holds temperature, not"):
            getattr(state, name)


def test_without_ended_bonds_there_are_no_nodes():
    state = state_of(ElasticTensor.isotropic(1.0, 0.2), STRAINED)
    assert state.surface_points.shape == (0, 2)
    assert state.surface_displacement.shape == (0, 2)
