"""What is read from a solution: unknowns in their units, surfaces, statistics."""

import numpy as np
import pytest

from solver import ConductivityTensor, ElasticTensor, Load, Scene, Support, rectangle

SETTINGS = {"region": rectangle(1.0, 1.0), "spacing": 0.1, "m": 2}


@pytest.fixture(scope="module")
def pulled():
    return Scene(
        material=ElasticTensor.isotropic(1.0, 0.2),
        supports=[Support.where(lambda x, y: x < -0.3, displacement=(0.0, 0.0), rotation=0.5)],
        loads=[Load.body_force((1.0, 0.5))],
        surface="extrapolated",
        **SETTINGS,
    ).solve()


@pytest.fixture(scope="module")
def warm():
    return Scene(
        material=ConductivityTensor.isotropic(1.0),
        supports=[Support.where(lambda x, y: x < -0.3, temperature=20.0)],
        loads=[Load.source(1.0)],
        **SETTINGS,
    ).solve()


def test_rotations_are_radians(pulled):
    np.testing.assert_allclose(pulled.rotation, pulled.unknowns[2] / pulled.spacing)
    np.testing.assert_allclose(pulled.rotation[pulled.prescribed], 0.5)
    np.testing.assert_array_equal(pulled.displacement, pulled.unknowns[:2].T)


def test_bodies_without_shear_have_no_rotation():
    solution = Scene(
        material=ElasticTensor.isotropic(1.0, 1 / 3),
        supports=[Support.where(lambda x, y: x < -0.3, displacement=(0.1, 0.0))],
        **SETTINGS,
    ).solve()
    assert np.isnan(solution.rotation).all()
    assert len(solution.rotation) == len(solution.points)


def test_a_solution_has_the_fields_of_its_physics_only(pulled, warm):
    with pytest.raises(AttributeError, match="not temperature"):
        _ = pulled.temperature
    with pytest.raises(AttributeError, match="not displacement"):
        _ = warm.displacement
    np.testing.assert_allclose(warm.temperature[warm.prescribed], 20.0)
    assert (warm.temperature[~warm.prescribed] > 20.0).all()


def test_surface_nodes_move_with_the_particles_beside_them(pulled, warm):
    nodes, moved = pulled.surface_points, pulled.surface_displacement
    assert nodes.shape == moved.shape
    assert len(nodes)
    near = np.argmin(np.hypot(*(nodes[:, None] - pulled.points[None]).T), axis=0)
    change = np.abs(moved - pulled.displacement[near]).max()
    assert 0 < change < 0.2 * np.abs(pulled.displacement).max()
    assert warm.surface_points.shape == (0, 2)
    assert warm.surface_temperature.shape == (0,)


def test_statistics_are_plain_values(pulled):
    said = pulled.statistics.as_dict()
    assert said["particles"] == len(pulled.points)
    assert said["residual"] <= 1e-10
    assert all(isinstance(v, int | float | str | list | tuple | type(None)) for v in said.values())
