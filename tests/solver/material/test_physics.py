"""What physics say of themselves hangs together, and their free motions strain no bond."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver.material import (
    ConductivityTensor,
    ElasticTensor,
    ElectricConductivityTensor,
    Family,
    calibrate,
)
from solver.material.physics import ELASTICITY, ELECTRICITY, HEAT
from solver.material.strains import elongations
from tests.solver.bodies import exact

ALL = (ELASTICITY, HEAT, ELECTRICITY)


@pytest.mark.parametrize("physics", ALL, ids=lambda p: p.name)
def test_everything_refers_to_unknowns_that_exist(physics):
    count = len(physics.unknowns)
    assert len(physics.turning) == count
    for table in (physics.fields, physics.supports, physics.loads):
        assert all(0 <= k < count for unknowns in table.values() for k in unknowns)
    # Every unknown is a field, and can be prescribed.
    for table in (physics.fields, physics.supports):
        assert {k for unknowns in table.values() for k in unknowns} == set(range(count))
    assert set(physics.missing) <= set(range(count))
    sentence = physics.unheld.format(place="the strip", motions="rotation")
    assert "the strip" in sentence
    assert "{" not in sentence


def test_rotations_are_scaled_by_the_spacing():
    np.testing.assert_array_equal(ELASTICITY.scales(0.1), [1.0, 1.0, 0.1])
    np.testing.assert_array_equal(ELASTICITY.scales(0.1, 2), [1.0, 1.0])
    np.testing.assert_array_equal(HEAT.scales(0.1), [1.0])


@exact
@given(st.integers(0, 10**6))
def test_free_motions_strain_no_bond(seed):
    rng = np.random.default_rng(seed)
    family = Family(2.5, 0.3)
    start = rng.normal(size=(family.size, 2))
    end = start + family.length[:, None] * family.normal
    for physics, strains in ((ELASTICITY, ("s", "γ")), (HEAT, ("g",)), (ELECTRICITY, ("g",))):
        motions = zip(physics.motions(start), physics.motions(end), strict=True)
        for name, (here, there) in zip(physics.motion_names, motions, strict=True):
            turn = 0.5 * family.length * (here[-1] + there[-1])
            found = elongations(strains, family.normal.T, there - here, turn)
            assert np.abs(found).max() < 1e-14, f"{physics.name}: {name}"


@pytest.mark.parametrize(
    ("material", "physics"),
    [
        (ElasticTensor.isotropic(1.0, 0.2), ELASTICITY),
        (ConductivityTensor.isotropic(1.0), HEAT),
        (ElectricConductivityTensor.isotropic(1.0).rotated(0.3), ELECTRICITY),
    ],
)
def test_tensors_and_moduli_name_their_physics(material, physics):
    moduli = calibrate(Family(3), material)
    assert material.physics is physics
    assert moduli.physics is physics
    assert moduli.components == len(physics.unknowns)
    assert moduli.stiffness.shape == (len(moduli.strains), Family(3).size)
