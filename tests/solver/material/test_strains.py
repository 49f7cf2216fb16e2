"""The strains of a bond: by hand, on rigid motions, and in their three forms."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver.material import Family
from solver.material.physics import ELASTICITY, HEAT
from solver.material.strains import (
    bent,
    directions,
    elongations,
    end_rows,
    homogeneous_shear,
    homogeneous_stretch,
    sheared,
    stretched,
)
from tests.solver.bodies import exact

ELASTIC, POLAR = ("s", "γ"), ("s", "γ", "χ")


def test_a_bond_by_hand():
    # From (0, 0) to (2, 0): the far end moves by (0.2, 0.1), the ends turn by 0.01 and 0.03.
    normal, difference = np.array([1.0, 0.0]), np.array([0.2, 0.1, 0.02])
    s, gamma = elongations(ELASTIC, normal, difference, np.array(1.0 * 0.01 + 1.0 * 0.03)) / 2.0
    assert s == pytest.approx(0.1)
    assert gamma == pytest.approx(0.05 - 0.02)
    assert elongations(("χ",), normal, difference, np.array(0.0)) / 2.0 == pytest.approx(0.01)
    assert elongations(("g",), normal, np.array([3.0]), np.array(0.0)) / 2.0 == pytest.approx(1.5)


@exact
@given(st.floats(-1, 1), st.tuples(st.floats(-1, 1), st.floats(-1, 1)), st.floats(0.1, 0.9))
def test_rigid_motions_strain_nothing_wherever_the_bond_is_held(angle, shift, share):
    family = Family(3, 0.5)
    normal, length = family.normal.T, family.length
    # u = shift + angle e3 × x, θ = angle; the arms add up to the length.
    turned = length * np.stack([-normal[1], normal[0]])
    difference = angle * np.concatenate([turned, np.zeros((1, family.size))])
    turn = angle * (share * length + (1 - share) * length)
    assert np.abs(elongations(POLAR, normal, difference, turn)).max() < 1e-15
    motions = ELASTICITY.motions(np.array([shift]))
    assert motions.shape == (3, 3, 1)
    assert motions[2, :2, 0] == pytest.approx((-shift[1], shift[0]))


@exact
@given(st.integers(0, 10**6))
def test_rows_of_both_ends_add_up_to_the_strains(seed):
    rng = np.random.default_rng(seed)
    family = Family(2.5, 0.4)
    normal = family.normal.T
    for physics, strains in ((ELASTICITY, ELASTIC), (ELASTICITY, POLAR), (HEAT, ("g",))):
        scales = physics.scales(0.4)
        ends = rng.normal(size=(2, len(scales), family.size))
        arms = rng.uniform(0.1, 1.0, (2, family.size))
        rows = [
            end_rows(strains, scales, normal, end, arm)
            for end, arm in zip((-1.0, 1.0), arms, strict=True)
        ]
        found = sum(
            np.einsum("abn,bn->an", r, scales[:, None] * u) for r, u in zip(rows, ends, strict=True)
        )
        turn = arms[0] * ends[0][-1] + arms[1] * ends[1][-1]
        wanted = elongations(strains, normal, ends[1] - ends[0], turn)
        np.testing.assert_allclose(found, wanted, atol=1e-14)


@exact
@given(st.tuples(*[st.floats(-1, 1)] * 3))
def test_homogeneous_strains(strain):
    family = Family(3, 1.0)
    e = np.array([[strain[0], 0.5 * strain[2]], [0.5 * strain[2], strain[1]]])
    n, t = family.normal, family.tangent
    s = np.einsum("ni,ij,nj->n", n, e, n)
    gamma = np.einsum("ni,ij,nj->n", t, e, n)
    np.testing.assert_allclose(strain @ homogeneous_stretch(n.T), s, atol=1e-14)
    np.testing.assert_allclose(strain @ homogeneous_shear(n.T), gamma, atol=1e-14)


def test_forces_act_along_normal_and_tangent():
    family = Family(2)
    along = directions(POLAR, family.normal.T)
    np.testing.assert_array_equal(along[0], family.normal.T)
    np.testing.assert_array_equal(along[1], family.tangent.T)
    assert not along[2].any()


def test_kernels_compile_what_arrays_use():
    assert stretched(0.6, 0.8, 1.0, 2.0) == stretched.py_func(0.6, 0.8, 1.0, 2.0)
    assert bent(0.3) == bent.py_func(0.3)
    assert sheared(0.6, 0.8, 1.0, 2.0, 0.3) == sheared.py_func(0.6, 0.8, 1.0, 2.0, 0.3)


def test_an_unknown_strain_is_named():
    with pytest.raises(ValueError, match="unknown strain 'κ'"):
        elongations(("κ",), np.ones(2), np.ones(3), np.zeros(()))
