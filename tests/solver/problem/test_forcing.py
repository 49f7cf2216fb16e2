"""What drives a body in time is what the scene at that time says, whatever was asked before."""

import numpy as np
import pytest

from solver import ConductivityTensor, ElasticTensor, Load, Scene, SceneError, Support, rectangle
from solver.problem import Discretisation, Forcing
from solver.problem.values import at_time, in_time


def elastic(surface):
    return Scene(
        region=rectangle(1.0, 0.8, angle=0.2),
        spacing=0.1,
        m=2,
        material=ElasticTensor.isotropic(1.0, 0.2),
        surface=surface,
        supports=[
            Support.where(lambda x, y: x < -0.3, u1=lambda x, y, t: t * y, rotation=0.1),
            Support.where(lambda x, y: x < -0.4, u2=lambda x, y: x),
        ],
        loads=[
            Load.body_force(lambda x, y, t: np.stack([t + x, y], -1)),
            Load.couple(0.3),
            Load.stress(lambda x, y, t: np.stack([t * x, y, t + 0 * x], -1)),
            Load.line(lambda x, y, t: np.stack([t + 0 * x, x], -1), (0.0, -0.1), (0.1, 0.1)),
        ],
    )


def conductive(surface):
    return Scene(
        region=rectangle(1.0, 0.8, angle=0.2),
        spacing=0.1,
        m=2,
        material=ConductivityTensor.isotropic(1.0),
        surface=surface,
        supports=[Support.layer(1.0, temperature=lambda x, y: x)],
        loads=[
            Load.source(lambda x, y, t: np.sin(t) * x, where=rectangle(0.35, 0.3)),
            Load.flux(lambda x, y, t: np.stack([t + 0 * x, x], -1)),
        ],
    )


@pytest.mark.parametrize("surface", ["volume", "extrapolated"])
@pytest.mark.parametrize("scene", [elastic, conductive])
def test_at_any_time_it_is_the_scene_of_that_time(scene, surface):
    scene = scene(surface)
    body = Discretisation.of(scene.at(0.0), free=True)
    forcing = Forcing(body, scene)
    assert not forcing.constant
    for time in (0.7, 0.0, 2.5, 0.7, 1.0, 1.1, 1.2, 2.5):
        then = Discretisation.of(scene.at(time), free=True)
        np.testing.assert_array_equal(forcing.values(time), then.values)
        np.testing.assert_allclose(
            forcing.right_hand_side(time), then.right_hand_side(), rtol=1e-12, atol=1e-12
        )
        found = forcing.at(time)
        if then.nodal_load is not None:
            np.testing.assert_allclose(found.nodal_load, then.nodal_load, atol=1e-13)


def shaken():
    """Held within and at its very edge, at values in time, under loads that stay."""
    return Scene(
        region=rectangle(1.0, 0.8, angle=0.2),
        spacing=0.1,
        m=2,
        material=ElasticTensor.isotropic(1.0, 0.2),
        surface="extrapolated",
        supports=[
            Support.where(lambda x, y: x < -0.3, u1=lambda x, y, t: np.sin(t) * y),
            Support.edge(lambda x, y: x > 0.3, u1=0.1, u2=lambda x, y, t: t * t * x),
        ],
        loads=[Load.body_force((1.0, 2.0)), Load.couple(0.3)],
    )


def test_an_edge_that_moves_is_that_of_the_scene_then():
    scene = shaken()
    forcing = Forcing(Discretisation.of(scene.at(0.0), free=True), scene)
    for time in (0.7, 0.0, 2.5):
        then = Discretisation.of(scene.at(time), free=True)
        np.testing.assert_allclose(
            forcing.right_hand_side(time), then.right_hand_side(), rtol=1e-11, atol=1e-12
        )
        field = np.cos(np.arange(then.values.size)).reshape(then.values.shape)
        np.testing.assert_allclose(
            forcing.at(time).surface_values(field), then.surface_values(field), atol=1e-11
        )


def test_what_velocities_exert_is_the_change_of_what_values_exert():
    scene = shaken()
    forcing = Forcing(Discretisation.of(scene.at(0.0), free=True), scene)
    early, late = 0.4, 0.9
    change = forcing.right_hand_side(late) - forcing.right_hand_side(early)
    found = forcing.of_velocity(early, late) * (late - early)
    assert np.abs(found).max() > 1e-3
    np.testing.assert_allclose(found, change, atol=1e-11 * np.abs(change).max())


def test_what_does_not_depend_on_time_is_made_once():
    scene = Scene(
        region=rectangle(1.0, 1.0),
        spacing=0.1,
        m=2,
        material=ConductivityTensor.isotropic(1.0),
        supports=[Support.layer(1, temperature=1.0)],
    )
    body = Discretisation.of(scene)
    forcing = Forcing(body, scene)
    assert forcing.constant
    assert forcing.at(3.0) is body
    assert forcing.right_hand_side(1.0) is forcing.right_hand_side(2.0)


def test_a_value_that_becomes_bad_later_is_found_before_any_work():
    scene = elastic("volume")
    body = Discretisation.of(scene.at(0.0), free=True)
    with pytest.raises(SceneError, match="not finite"):
        Forcing(body, scene).check(np.array([1.0, np.inf]))


def test_a_third_argument_makes_a_function_of_time():
    assert in_time(lambda x, y, t: x)
    for other in (lambda x, y: x, lambda x, y, k=1: x, lambda *a: a[0], np.add, 3.0, None):
        assert not in_time(other)
    assert at_time(lambda x, y, t: x + t, 2.0)(1.0, 0.0) == 3.0
    assert at_time(4.0, 2.0) == 4.0
