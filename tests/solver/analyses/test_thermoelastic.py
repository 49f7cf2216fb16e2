"""Deformational heating: adiabatic temperatures, energy, the limits, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from solver import (
    ConductivityTensor,
    ElasticTensor,
    ExpansionTensor,
    Inclusion,
    Load,
    Scene,
    SceneError,
    Support,
    rectangle,
)
from solver.analyses import thermoelastic
from tests.solver.bodies import FIG_7

SOLID, EXPANSION = ElasticTensor(FIG_7), ExpansionTensor([[0.3, 0.1], [0.1, -0.2]])
BODY = Scene(rectangle(1.0, 0.8), 0.1, SOLID, m=2, density=2.0)
HEAT = Scene(
    rectangle(1.0, 0.8), 0.1, ConductivityTensor([[0.3, 0.1], [0.1, 0.2]]), m=2, heat_capacity=0.7
)


def kicked(body=BODY, heat=HEAT, **options):
    given = {
        "step": 0.05,
        "steps": 40,
        "velocity": lambda x, y: np.stack([np.sin(3 * x), x * y], axis=-1),
        "temperature": lambda x, y: np.cos(2 * x) - y,
        **options,
    }
    return thermoelastic.run(body, heat, EXPANSION, 1.5, **given)


@pytest.mark.parametrize("surface", ["none", "volume"])
@pytest.mark.parametrize("held", [False, True])
def test_energy_is_kept_but_for_what_conduction_loses(surface, held):
    supports = [Support.layer(1.2, displacement=0.01, rotation=0.0)] if held else []
    cold = [Support.where(lambda x, y: x > 0.3, temperature=0.2)] if held else []
    run = kicked(
        replace(BODY, surface=surface, supports=supports, loads=[Load.body_force((0.1, 0.2))]),
        replace(HEAT, surface=surface, supports=cold, loads=[Load.source(0.3)]),
    )
    scale = np.abs(run.kinetic + run.elastic + run.thermal).max()
    assert np.abs(run.imbalance).max() < 1e-12 * scale
    if not held:
        # Without sources heat conduction only loses.
        run = kicked(replace(BODY, surface=surface), replace(HEAT, surface=surface))
        assert (np.diff(run.dissipated) > 0).all()
        assert run.dissipated[-1] > 0.01 * scale
    assert run.summary()["imbalance"] < 1e-12
    assert run.tables()["energy"].values.shape == (41, 6)
    assert {"displacement", "rotation", "temperature", "stress11"} < set(run.fields())


def test_what_motion_or_heat_leave_out_is_told():
    """A small body without treatment, and sinks thinner than a horizon."""
    thin = replace(
        HEAT, surface="none", supports=[Support.where(lambda x, y: x > 0.42, temperature=0)]
    )
    told = kicked(replace(BODY, surface="none"), thin, steps=1).summary()["warnings"]
    assert any("bonds of free particles" in one and "surface='none'" in one for one in told)
    assert any("what is prescribed about" in one for one in told)


def test_stress_is_that_of_the_mechanical_strain():
    """A body held in a homogeneous strain, warmed evenly: σ = C (ε − A ϑ)."""
    slope = np.array([[0.1, -0.3], [0.2, 0.4]])
    held = Support.where(
        lambda x, y: x == x,
        displacement=lambda x, y: np.stack([x, y], axis=-1) @ slope.T,
        rotation=0.5 * (slope[1, 0] - slope[0, 1]),
    )
    warm = Support.where(lambda x, y: x == x, temperature=0.3)
    run = thermoelastic.run(
        replace(BODY, supports=[held]),
        replace(HEAT, supports=[warm]), EXPANSION, 1.5, step=0.1, steps=1, temperature=0.3,
    )  # fmt: skip
    strain = np.array([slope[0, 0], slope[1, 1], slope[0, 1] + slope[1, 0]])
    wanted = SOLID.voigt @ (strain - 0.3 * EXPANSION.voigt)
    middle = np.argmin(np.hypot(*run.points.T))
    found = [run.fields()[f"stress{k}"][middle] for k in ("11", "22", "12")]
    np.testing.assert_allclose(found, wanted, rtol=1e-10)


def test_a_scene_alone_says_all():
    """Principal values along turned axes make the same motion as tensors do."""
    kick = {"step": 0.05, "steps": 5, "velocity": lambda x, y: np.stack([x, x * y], axis=-1)}
    turn = ConductivityTensor(np.diag([0.3, 0.1])).rotated(0.4)
    expands = ConductivityTensor(np.diag([0.3, 0.2])).rotated(0.4).matrix
    cold = Support.where(lambda x, y: x > 0.3, temperature=0.0)
    heat = replace(HEAT, material=turn, supports=[cold])
    wanted = thermoelastic.run(BODY, heat, ExpansionTensor(expands), 1.5, **kick)
    found = thermoelastic.motion(
        BODY, (0.3, 0.1), (0.3, 0.2), 0.7, 1.5, angle_degrees=np.degrees(0.4),
        sink=lambda x, y: x > 0.3, **kick,
    )  # fmt: skip
    np.testing.assert_allclose(found.temperature, wanted.temperature, rtol=0, atol=1e-12)
    assert np.abs(found.temperature).max() > 1e-3
    with pytest.raises(SceneError, match="this is a conductive"):
        thermoelastic.motion(HEAT, (1.0, 1.0), (0.1, 0.1), 1.0, 1.0, 0.1, 1)
    with pytest.raises(SceneError, match="must be positive"):
        thermoelastic.motion(BODY, (1.0, -1.0), (0.1, 0.1), 1.0, 1.0, 0.1, 1)


def test_a_fast_motion_is_adiabatic():
    """Without conduction each particle keeps its entropy: ϑ = −T₀ Gᵀ u/C at every step."""
    cold = replace(HEAT, material=ConductivityTensor.isotropic(1e-12))
    run = kicked(heat=cold, temperature=0.0)
    force = thermoelastic.thermal_force(run.body.bonds, run.body.moduli, EXPANSION)
    wanted = -1.5 / 0.7 * (force.T @ run.unknowns[-1].ravel())
    assert np.abs(run.temperature[-1] - wanted).max() < 1e-9 * np.abs(wanted).max()
    assert np.abs(wanted).max() > 0.1


def test_without_expansion_heat_and_motion_do_not_meet():
    none = ExpansionTensor.isotropic(0.0)
    run = thermoelastic.run(BODY, HEAT, none, 1.5, step=0.05, steps=5, temperature=1.0)
    assert not run.displacement.any()
    np.testing.assert_allclose(run.temperature, 1.0, atol=1e-12)


@pytest.mark.parametrize(
    ("body", "heat", "options", "message"),
    [
        ({}, {}, {"step": 0.0}, "step must be a positive time"),
        ({}, {}, {"steps": 0}, "number of steps"),
        ({"density": None}, {}, {}, "density"),
        ({}, {"heat_capacity": None}, {}, "heat_capacity"),
        ({}, {"spacing": 0.05}, {}, "not the same body"),
        ({"surface": "extrapolated"}, {}, {}, "whole bonds only"),
        ({"loads": [Load.body_force(lambda x, y, t: (t + 0 * x, t))]}, {}, {}, "depend on time"),
        ({}, {}, {"velocity": np.zeros((3, 2))}, "initial velocity"),
    ],
)
def test_what_makes_no_sense_is_refused(body, heat, options, message):
    with pytest.raises(SceneError, match=message):
        kicked(replace(BODY, **body), replace(HEAT, **heat), **options)


def test_what_is_no_pair_of_scenes_is_refused():
    with pytest.raises(SceneError, match="needs an elastic scene"):
        thermoelastic.run(HEAT, HEAT, EXPANSION, 1.0, step=0.1, steps=1)
    other = Inclusion(rectangle(0.4, 0.4), BODY.material)
    with pytest.raises(SceneError, match="knows one solid"):
        kicked(replace(BODY, inclusions=[other]), HEAT)
    with pytest.raises(SceneError, match="absolute and positive"):
        thermoelastic.run(BODY, HEAT, EXPANSION, 0.0, step=0.1, steps=1)
    solution = replace(
        BODY, supports=[Support.layer(9, displacement=0.0, rotation=0.0)], surface="none"
    ).solve()
    with pytest.raises(SceneError, match="must be positive"):
        thermoelastic.adiabatic_temperature(solution, EXPANSION, 1.0, -1.0)
