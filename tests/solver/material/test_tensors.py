"""Tensors: closed forms, rotation index by index, and what is refused."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import ChiralTensor, ConductivityTensor, ElasticTensor, PolarTensor
from solver.material import BendingTensor, stress_rotation
from tests.solver.bodies import FIG_7, conductivities, exact, rotate_4, voigts

angles = st.floats(-7.0, 7.0, allow_nan=False)


@exact
@given(st.floats(0.1, 10.0), st.floats(-0.9, 0.9))
def test_isotropic_plane_stress(E, nu):
    c = ElasticTensor.isotropic(E=E, nu=nu).voigt
    stiff, shear = E / (1 - nu**2), E / (2 * (1 + nu))
    wanted = [[stiff, nu * stiff, 0], [nu * stiff, stiff, 0], [0, 0, shear]]
    np.testing.assert_allclose(c, wanted, rtol=1e-12, atol=1e-13 * stiff)


@exact
@given(st.floats(0.1, 10.0), st.floats(-0.9, 0.49))
def test_isotropic_plane_strain_is_lame_and_a_substitution_in_plane_stress(E, nu):
    c = ElasticTensor.isotropic(E=E, nu=nu, plane="strain").voigt
    lam, mu = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
    wanted = [[lam + 2 * mu, lam, 0], [lam, lam + 2 * mu, 0], [0, 0, mu]]
    scale = lam + 2 * mu
    np.testing.assert_allclose(c, wanted, rtol=1e-11, atol=1e-12 * scale)
    other = ElasticTensor.isotropic(E=E / (1 - nu**2), nu=nu / (1 - nu)).voigt
    np.testing.assert_allclose(c, other, rtol=1e-11, atol=1e-12 * scale)


def test_orthotropic_compliance_and_axes():
    solid = ElasticTensor.orthotropic(140.0, 10.0, 5.0, 0.3)
    wanted = [[1 / 140, -0.3 / 140, 0], [-0.3 / 140, 1 / 10, 0], [0, 0, 1 / 5]]
    np.testing.assert_allclose(solid.compliance, wanted, rtol=1e-12, atol=1e-15)
    turned = solid.rotated(np.pi / 2)
    assert 1 / turned.compliance[0, 0] == pytest.approx(10.0)
    assert 1 / turned.compliance[1, 1] == pytest.approx(140.0)


def test_orthotropic_plane_strain_from_the_solid_in_three_dimensions():
    e1, e2, e3, n12, n13, n23 = 140.0, 10.0, 8.0, 0.3, 0.25, 0.4
    s = np.array(
        [
            [1 / e1, -n12 / e1, -n13 / e1],
            [-n12 / e1, 1 / e2, -n23 / e2],
            [-n13 / e1, -n23 / e2, 1 / e3],
        ]
    )
    # ε33 = 0 keeps the in-plane rows of the three-dimensional *stiffness*.
    wanted = np.linalg.inv(s)[:2, :2]
    solid = ElasticTensor.orthotropic(e1, e2, 5.0, n12, plane="strain", E3=e3, nu13=n13, nu23=n23)
    np.testing.assert_allclose(solid.voigt[:2, :2], wanted, rtol=1e-12)
    assert solid.voigt[2, 2] == pytest.approx(5.0)


@exact
@given(voigts(), angles)
def test_rotation_is_the_four_index_transformation(voigt, angle):
    turned = ElasticTensor(voigt).rotated(angle).voigt
    np.testing.assert_allclose(turned, rotate_4(voigt, angle), atol=1e-13 * np.abs(voigt).max())


@exact
@given(voigts(), angles, angles)
def test_rotations_compose_and_keep_the_invariants(voigt, first, second):
    solid = ElasticTensor(voigt)
    twice, once = solid.rotated(first).rotated(second).voigt, solid.rotated(first + second).voigt
    np.testing.assert_allclose(twice, once, atol=1e-12 * np.abs(voigt).max())
    for c in (once, voigt):
        assert c[0, 0] + c[1, 1] + 2 * c[0, 1] == pytest.approx(voigt[:2, :2].sum(), rel=1e-12)
        assert c[2, 2] - c[0, 1] == pytest.approx(voigt[2, 2] - voigt[0, 1], abs=1e-12)


def test_a_rotation_wrong_by_one_per_cent_is_seen():
    turned = ElasticTensor(FIG_7).rotated(0.7).voigt
    assert np.abs(turned - rotate_4(FIG_7, 0.7 * 1.01)).max() > 1e-4


@exact
@given(st.tuples(*[st.floats(-1, 1)] * 3), angles)
def test_stress_rotation_is_that_of_the_tensor(stress, psi):
    a, b, d = stress
    q = np.array([[np.cos(psi), np.sin(psi)], [-np.sin(psi), np.cos(psi)]])
    turned = q @ np.array([[a, d], [d, b]]) @ q.T
    found = stress_rotation(psi) @ stress
    np.testing.assert_allclose(found, [turned[0, 0], turned[1, 1], turned[0, 1]], atol=1e-14)


@exact
@given(st.floats(0.0, 1.5), st.floats(0.2, 0.45))
def test_orthotropy_angle_finds_a_turned_axis(angle, shear):
    solid = ElasticTensor([[3, 0.4, 0], [0.4, 1, 0], [0, 0, shear]]).rotated(angle)
    off = (solid.orthotropy_angle() - angle) / (np.pi / 2)
    assert abs(off - round(off)) < 1e-9


def test_orthotropy_angle_of_special_solids():
    assert ElasticTensor.isotropic(1.0, 0.3).orthotropy_angle() == 0.0
    assert ElasticTensor(FIG_7).orthotropy_angle() is None
    # Square symmetry: no second harmonic, the axis comes from the fourth.
    square = ElasticTensor([[2, 0.5, 0], [0.5, 2, 0], [0, 0, 0.2]]).rotated(0.3)
    assert square.orthotropy_angle() % (np.pi / 4) == pytest.approx(0.3)


@exact
@given(st.floats(1.1, 50.0), st.floats(-1.5, 1.5))
def test_conductivity_has_the_principal_values_it_was_made_of(ratio, angle):
    high, low, zeta = ConductivityTensor.orthotropic(ratio, 1.0, angle).principal()
    assert (high, low) == pytest.approx((ratio, 1.0), rel=1e-10)
    assert zeta == pytest.approx(angle, abs=1e-10)


@exact
@given(conductivities(), angles)
def test_conductivity_rotates_as_a_tensor(matrix, angle):
    c, s = np.cos(angle), np.sin(angle)
    q = np.array([[c, -s], [s, c]])
    found = ConductivityTensor(matrix).rotated(angle)
    np.testing.assert_allclose(found.matrix, q @ matrix @ q.T, atol=1e-14)
    np.testing.assert_allclose(found.compliance @ found.matrix, np.eye(2), atol=1e-12)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (np.eye(2), "3×3"),
        ([[1, 0, 0], [0, np.nan, 0], [0, 0, 1]], "not finite"),
        ([[1, 0.1, 0], [0, 1, 0], [0, 0, 1]], "symmetric"),
        (np.zeros((3, 3)), "zero"),
        ([[1, 2, 0], [2, 1, 0], [0, 0, 1]], "not positive definite"),
        ([[1, 1, 0], [1, 1, 0], [0, 0, 1]], "not positive definite"),
    ],
)
def test_bad_elastic_tensors(values, message):
    with pytest.raises(ValueError, match=message):
        ElasticTensor(values)


@pytest.mark.parametrize("values", [[[1, 2], [2, 1]], np.eye(3), [[np.inf, 0], [0, 1]]])
def test_bad_conductivity(values):
    with pytest.raises(ValueError, match="conductivity"):
        ConductivityTensor(values)


@pytest.mark.parametrize(
    "keys",
    [
        {"E": -1.0, "nu": 0.3},
        {"E": 1.0, "nu": 1.0},
        {"E": 1.0, "nu": -1.0},
        {"E": 1.0, "nu": 0.5, "plane": "strain"},
        {"E": np.nan, "nu": 0.3},
        {"E": 1.0, "nu": 0.3, "plane": "shell"},
    ],
)
def test_bad_isotropic_constants(keys):
    with pytest.raises(ValueError, match=r"positive|plane"):
        ElasticTensor.isotropic(**keys)


def test_orthotropic_plane_strain_needs_the_third_axis():
    with pytest.raises(ValueError, match="E3"):
        ElasticTensor.orthotropic(1.0, 1.0, 0.4, 0.3, plane="strain")


def test_tensors_are_copies_and_cannot_be_changed():
    values = np.eye(3)
    solid = ElasticTensor(values)
    values[0, 0] = 7.0
    assert solid.voigt[0, 0] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        solid.voigt[0, 0] = 2.0


def test_polar_solids_hold_the_rotations_of_their_points():
    solid = PolarTensor(ElasticTensor.isotropic(2.4, 0.2), [[2.0, 0.5], [0.5, 1.0]])
    assert solid.cosserat_modulus == pytest.approx(1.0 - 0.5)
    assert solid.coupling_number**2 == pytest.approx(1 / 3)
    turned = solid.rotated(np.pi / 2)
    np.testing.assert_allclose(turned.bending.matrix, [[1.0, -0.5], [-0.5, 2.0]], atol=1e-14)
    np.testing.assert_allclose(turned.voigt, solid.voigt, atol=1e-14)
    assert PolarTensor(solid, BendingTensor.isotropic(1.0)).bending.matrix[0, 0] == 1.0


def test_chiral_solids_turn_with_their_frame():
    """r·ε is a number: it does not know in which frame it is written."""
    solid = ChiralTensor(ElasticTensor.isotropic(2.4, 0.2), [0.3, -0.1, 0.2])
    turned = solid.rotated(0.7)
    strain = np.array([0.3, -0.2, 0.5])
    q = stress_rotation(-0.7)
    # Strains with 2 ε12 turn by the inverse transposed.
    assert turned.turn @ np.linalg.solve(q.T, strain) == pytest.approx(solid.turn @ strain)
    assert turned.cosserat_modulus == pytest.approx(solid.cosserat_modulus)
    np.testing.assert_allclose(turned.rotated(-0.7).turn, solid.turn, atol=1e-14)


@pytest.mark.parametrize(
    ("solid", "turn", "message"),
    [
        (ElasticTensor.isotropic(1.0, 0.34), [0.1, 0.1, 0.0], "must be positive"),
        (ElasticTensor.isotropic(1.0, 0.2), [0.0, 0.0, 0.6], "must be positive"),
        (ElasticTensor.isotropic(1.0, 0.2), None, "three finite turns"),
        (ElasticTensor.isotropic(1.0, 0.2), [np.nan, 0, 0], "three finite turns"),
        (PolarTensor(ElasticTensor.isotropic(1.0, 0.2), np.eye(2)), [0.1, 0, 0], "cannot be"),
    ],
)
def test_chiral_solids_that_are_none(solid, turn, message):
    with pytest.raises(ValueError, match=message):
        ChiralTensor(solid, turn)


def test_chiral_solids_are_no_polar_ones_yet():
    chiral = ChiralTensor(ElasticTensor.isotropic(1.0, 0.2), [0.1, 0.1, 0.0])
    with pytest.raises(ValueError, match="cannot be chiral yet"):
        PolarTensor(chiral, np.eye(2))


@pytest.mark.parametrize(
    ("solid", "bending", "message"),
    [
        (ElasticTensor.isotropic(1.0, 0.34), np.eye(2), "needs C66 > C12"),
        (ElasticTensor.isotropic(1.0, 1 / 3), np.eye(2), "needs C66 > C12"),
        (ElasticTensor.isotropic(1.0, 0.26, "strain"), np.eye(2), "needs C66 > C12"),
        (ElasticTensor.isotropic(1.0, 0.2), np.zeros((2, 2)), "bending stiffness must be"),
        (ElasticTensor.isotropic(1.0, 0.2), np.diag([1.0, -1.0]), "bending stiffness is not"),
        (ElasticTensor.isotropic(1.0, 0.2), None, "needs its bending stiffness"),
    ],
)
def test_polar_solids_that_are_none(solid, bending, message):
    with pytest.raises(ValueError, match=message):
        PolarTensor(solid, bending)
