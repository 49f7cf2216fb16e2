"""From a scene to arrays: prescribed values, loads, right-hand side, fields of a vector."""

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from solver import ElasticTensor, Load, Scene, Support, rectangle
from solver.operators.assembled import to_csr

SOLID = ElasticTensor.isotropic(1.0, 0.2)


def scene(**changes):
    settings = {
        "region": rectangle(1.0, 1.0),
        "spacing": 0.1,
        "m": 2,
        "material": SOLID,
        "supports": [Support.where(lambda x, y: x < -0.3, displacement=(0.1, -0.2), rotation=0.5)],
        **changes,
    }
    return Scene(**settings)


def test_prescribed_rotations_are_held_times_the_spacing():
    built = scene().discretise()
    left = built.lattice.points[:, 0] < -0.3
    np.testing.assert_array_equal(built.prescribed, np.tile(left, (3, 1)))
    np.testing.assert_allclose(built.values[:, left].T, [[0.1, -0.2, 0.05]] * left.sum())
    assert not built.values[:, ~left].any()


def test_later_supports_win():
    more = Support.where(lambda x, y: (x < -0.3) & (y > 0), displacement=(7.0, 7.0), rotation=0.0)
    built = scene(supports=[*scene().supports, more]).discretise()
    x, y = built.lattice.points.T
    assert (built.values[0, (x < -0.3) & (y > 0)] == 7.0).all()
    assert (built.values[0, (x < -0.3) & (y < 0)] == 0.1).all()


def test_loads_add_up_and_couples_are_divided_by_the_spacing():
    loads = [Load.body_force((1.0, 2.0)), Load.body_force((0.5, 0.0)), Load.couple(3.0)]
    built = scene(loads=loads).discretise()
    np.testing.assert_allclose(built.load.T, [[1.5, 2.0, 30.0]] * built.lattice.count)


def test_the_whole_of_an_edge_load_arrives():
    """∮ σ n ds of a stress that pulls on the right half only."""
    pulled = Load.stress((1.0, 0.0, 0.25), where=lambda x, y: x > 0.49)
    for surface in ("none", "extrapolated"):
        built = scene(loads=[pulled], surface=surface).discretise()
        load = built.load.sum(axis=1)
        if built.nodal_load is not None:
            load = load + built.nodal_load.sum(axis=1)
        np.testing.assert_allclose(load * 0.1**2, [1.0, 0.25, 0.0], atol=1e-12)


def test_right_hand_side_is_the_load_less_what_supports_exert():
    built = scene(loads=[Load.body_force((1.0, 2.0))]).discretise()
    solution = scene(loads=[Load.body_force((1.0, 2.0))]).solve(tolerance=1e-12)
    x = solution.unknowns[:, built.operator.active].ravel()
    np.testing.assert_allclose(
        to_csr(built.operator) @ x, built.right_hand_side(), atol=1e-9 * np.abs(x).max()
    )


def test_fields_of_a_vector_keep_what_is_prescribed():
    built = scene().discretise()
    field = built.field(np.full(built.operator.shape[0], 9.0))
    np.testing.assert_array_equal(field[built.prescribed], built.values[built.prescribed])
    assert (field[~built.prescribed] == 9.0).all()
    assert not built.damaged


@pytest.mark.parametrize("surface", ["none", "extrapolated"])
def test_surface_values(surface):
    built = scene(surface=surface).discretise()
    values = built.surface_values(np.zeros((3, built.lattice.count)))
    assert (values is None) == (surface == "none")


def test_building_keeps_blas_to_one_thread():
    seen = []

    def displacement(x, y):
        seen.extend(lib["num_threads"] for lib in threadpool_info() if lib["user_api"] == "blas")
        return np.zeros((len(x), 2))

    with threadpool_limits(limits=2, user_api="blas"):
        support = Support.where(lambda x, y: x < -0.3, displacement=displacement, rotation=0.0)
        scene(supports=[support]).discretise()
    assert set(seen) == {1}
