"""Scenes: what they refuse, what they derive, what their solutions hold."""

import dataclasses

import numpy as np
import pytest

import solver
from solver import (
    CalibrationError,
    ConductivityTensor,
    Cosine,
    ElasticTensor,
    InadmissibleMaterialError,
    Scene,
    SceneError,
    Support,
    disc,
    rectangle,
)
from tests.solver.bodies import DISC, FIG_7

SOLID, CONDUCTOR = ElasticTensor(FIG_7), ConductivityTensor(DISC)
CLAMP = Support.layer(2, displacement=0.0, rotation=0.0)


def test_the_script_of_the_readme():
    scene = Scene(
        region=disc(1.0),
        spacing=0.1,
        m=3,
        material=CONDUCTOR,
        calibration="positive",
        supports=[Support.layer(cells=3.5, temperature=lambda x, y: x**3 / 5 - x**2 * y)],
    )
    solution = scene.solve()
    assert solution.scene is scene
    assert solution.temperature.shape == (len(solution.points),)
    assert solution.points.shape == (316, 2)  # lattice points of half-integers in a disc of ten
    assert solution.spacing == 0.1
    assert 0 < solution.prescribed.sum() < 316


def test_only_the_unknowns_that_a_scene_needs():
    for material, support, components in [
        (CONDUCTOR, Support.layer(3, temperature=0.0), 1),
        (ElasticTensor.isotropic(1.0, 1 / 3), Support.layer(3, displacement=0.0), 2),
        (SOLID, Support.layer(3, displacement=0.0, rotation=0.0), 3),
    ]:
        parts = Scene(disc(1.0), 0.1, material, [support], m=2).discretise()
        assert parts.operator.components == components
        free = (parts.lattice.edge_distance > 0.3).sum()
        assert parts.operator.shape == (components * free,) * 2
        # A sound body in a layer as wide as its bonds are long stores nothing for single bonds.
        assert parts.bonds.strengths.size == 0


def test_solutions_know_their_physics():
    elastic = Scene(disc(1.0), 0.2, SOLID, [CLAMP], m=2).solve()
    assert elastic.displacement.shape == elastic.points.shape
    assert elastic.rotation.shape == (len(elastic.points),)
    with pytest.raises(AttributeError, match="displacement, rotation, not temperature"):
        _ = elastic.temperature
    heat = Scene(disc(1.0), 0.2, CONDUCTOR, [Support.layer(2, temperature=1.0)], m=2).solve()
    np.testing.assert_allclose(heat.temperature, 1.0, rtol=1e-9)
    for name in ("displacement", "rotation"):
        with pytest.raises(AttributeError, match="holds temperature, not"):
            getattr(heat, name)


def test_rotations_come_back_in_radians():
    angle = 0.01
    layer = Support.layer(
        3, displacement=lambda x, y: np.stack([-angle * y, angle * x], axis=-1), rotation=angle
    )
    found = Scene(disc(1e-3), 1e-4, SOLID, [layer], m=2).solve(1e-12)
    np.testing.assert_allclose(found.rotation, angle, rtol=1e-8)


def test_particles_held_in_part_are_not_prescribed():
    roller = Support.where(lambda x, y: x > 0.8, u1=0.0)
    found = Scene(rectangle(2.0, 1.0), 0.1, SOLID, [
        Support.where(lambda x, y: x < -0.8, displacement=0.0, rotation=0.0), roller
    ], m=2).solve()  # fmt: skip
    np.testing.assert_array_equal(found.prescribed, found.points[:, 0] < -0.8)


@pytest.mark.parametrize(
    ("changes", "error", "message"),
    [
        ({"region": "disc"}, SceneError, "region must be a Region, not str"),
        ({"surface": "fancy"}, ValueError, "unknown surface treatment"),
        ({"spacing": 0.0}, ValueError, "spacing must be positive"),
        ({"spacing": 10.0}, SceneError, "no particle"),
        ({"m": 0.5}, ValueError, "at least one cell"),
        ({"calibration": "magic"}, ValueError, "unknown calibration"),
        ({"area_rule": "half"}, ValueError, "unknown area rule"),
        ({"influence": "cone"}, ValueError, "unknown influence"),
        ({"law": Cosine(4)}, CalibrationError, "orthotropic"),
        ({"supports": []}, SceneError, "rigid motion"),
        (
            {"material": ElasticTensor.isotropic(1.0, 0.45, "strain")},
            InadmissibleMaterialError,
            "k Δx = ",
        ),
    ],
)
def test_refusals_before_any_long_work(changes, error, message):
    keys = {"region": disc(1.0), "spacing": 0.1, "material": SOLID, "supports": [CLAMP], "m": 2}
    with pytest.raises(error, match=message):
        Scene(**(keys | changes)).discretise()


def test_named_errors_are_value_errors():
    for error in (SceneError, CalibrationError, InadmissibleMaterialError):
        assert issubclass(error, ValueError)


def test_scenes_are_frozen_and_vary_by_replacement():
    scene = Scene(disc(1.0), 0.2, SOLID, [CLAMP], m=2)
    with pytest.raises(dataclasses.FrozenInstanceError):
        scene.spacing = 0.1
    finer = dataclasses.replace(scene, spacing=0.1)
    assert finer.discretise().lattice.count == 316


def test_the_public_names_are_there():
    for name in solver.__all__:
        assert hasattr(solver, name)
