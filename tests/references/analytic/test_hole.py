"""Hole in an infinite plate: free edge, balance, remote state, textbook limits."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from references.analytic import hole
from references.analytic.voigt import isotropic_voigt, strain_of_gradient, turned_axes
from tests.references.analytic.tensors import random_voigt

quick = settings(deadline=None, max_examples=30, derandomize=True)
ANGLES = np.linspace(0, 2 * np.pi, 25)


def orthotropic(E1, E2, G12, nu12):
    return np.linalg.inv(
        np.array([[1 / E1, -nu12 / E1, 0], [-nu12 / E1, 1 / E2, 0], [0, 0, 1 / G12]])
    )


def ellipse(ratio, angle=ANGLES):
    theta = hole.eccentric_angle(angle, ratio)
    return np.cos(theta), ratio * np.sin(theta)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.49])
def test_isotropic_circle_is_kirsch(nu):
    got = hole.edge_hoop_stress(isotropic_voigt(2.0, nu), ANGLES)
    assert got == pytest.approx(1 - 2 * np.cos(2 * ANGLES), abs=1e-13)


@pytest.mark.parametrize("ratio", [0.2, 0.5, 3.0, 10.0])
def test_isotropic_ellipse_is_inglis(ratio):
    voigt = isotropic_voigt(2.0, 0.3)
    # 1 + 2 b/a at the end of the axis across the tension, -1 at the other.
    assert hole.edge_hoop_stress(voigt, np.pi / 2, ratio) == pytest.approx(1 + 2 * ratio, rel=1e-12)
    assert hole.edge_hoop_stress(voigt, 0.0, ratio) == pytest.approx(-1.0, rel=1e-12)


def test_orthotropic_circle_has_lekhnitskiis_factor():
    E1, E2, G12, nu12 = 140.0, 10.0, 5.0, 0.3
    n = np.sqrt(2 * (np.sqrt(E1 / E2) - nu12) + E1 / G12)
    voigt = orthotropic(E1, E2, G12, nu12)
    assert hole.edge_hoop_stress(voigt, np.pi / 2) == pytest.approx(1 + n, rel=1e-12)
    k = np.sqrt(E1 / E2)
    assert hole.edge_hoop_stress(voigt, 0.0) == pytest.approx(-1 / k, rel=1e-12)


@quick
@given(random_voigt(), st.floats(0.2, 5.0), st.floats(-3.0, 3.0))
def test_edge_is_free_and_agrees_with_the_field(voigt, ratio, direction):
    x, y = ellipse(ratio)
    c, s = np.cos(direction), np.sin(direction)
    stress = hole.hole_stress(voigt, x, y, 1.0, ratio, (c * c, s * s, c * s))
    normal = np.stack([x, y / ratio**2], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    n1, n2 = normal.T
    traction = np.stack(
        [stress[:, 0] * n1 + stress[:, 2] * n2, stress[:, 2] * n1 + stress[:, 1] * n2]
    )
    assert np.abs(traction).max() <= 1e-9 * np.abs(stress).max()
    along = stress[:, 0] * n2**2 + stress[:, 1] * n1**2 - 2 * stress[:, 2] * n1 * n2
    edge = hole.edge_hoop_stress(voigt, ANGLES, ratio, tension_angle=direction)
    assert np.abs(edge - along).max() <= 1e-9 * np.abs(stress).max()


@quick
@given(random_voigt(), st.floats(0.3, 3.0))
def test_field_is_in_equilibrium_and_follows_hooke(voigt, ratio):
    remote = (0.7, -0.4, 0.5)
    x, y = ellipse(ratio, np.linspace(0.1, 6.2, 9))
    x, y, h = 1.6 * x, 1.6 * y, 4e-3
    weights = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}

    def gradient(function):
        def along(dx, dy):
            return (
                sum(
                    w
                    * (
                        function(x + k * h * dx, y + k * h * dy)
                        - function(x - k * h * dx, y - k * h * dy)
                    )
                    for k, w in weights.items()
                )
                / h
            )

        return np.stack([along(1, 0), along(0, 1)], axis=-1)

    stress = hole.hole_stress(voigt, x, y, 1.0, ratio, remote)
    d = gradient(lambda a, b: hole.hole_stress(voigt, a, b, 1.0, ratio, remote))
    residual = np.stack([d[:, 0, 0] + d[:, 2, 1], d[:, 2, 0] + d[:, 1, 1]])
    assert np.abs(residual).max() <= 1e-6 * np.abs(d).max()
    g = gradient(lambda a, b: hole.hole_displacement(voigt, a, b, 1.0, ratio, remote))
    assert np.abs(strain_of_gradient(g) @ voigt - stress).max() <= 1e-7 * np.abs(stress).max()


@quick
@given(random_voigt())
def test_far_away_the_plate_does_not_feel_the_hole(voigt):
    remote = (0.7, -0.4, 0.5)
    r = 1e4
    stress = hole.hole_stress(voigt, r * np.cos(ANGLES), r * np.sin(ANGLES), 1.0, 0.5, remote)
    assert np.abs(stress - np.array(remote)).max() <= 1e-5


@quick
@given(random_voigt(), st.floats(-3.0, 3.0))
def test_circle_turns_with_the_body(voigt, turn):
    one = hole.edge_hoop_stress(voigt, ANGLES, tension_angle=0.4)
    two = hole.edge_hoop_stress(turned_axes(voigt, -turn), ANGLES + turn, tension_angle=0.4 + turn)
    assert np.abs(one - two).max() <= 1e-9 * np.abs(one).max()


@pytest.mark.parametrize("power", [2, 5, 8, 11, 14])
def test_nearly_equal_roots_stay_near_kirsch(power):
    voigt = isotropic_voigt(1.0, 0.3)
    voigt[0, 0] += 10.0**-power
    got = hole.edge_hoop_stress(voigt, ANGLES)
    assert np.abs(got - (1 - 2 * np.cos(2 * ANGLES))).max() <= 3 * 10.0**-power + 1e-13


def test_polar_and_eccentric_angle():
    theta = hole.eccentric_angle(ANGLES[1:6], 0.25)
    assert np.arctan2(0.25 * np.sin(theta), np.cos(theta)) == pytest.approx(ANGLES[1:6], rel=1e-13)


def test_one_per_cent_in_a_modulus_is_seen():
    voigt = orthotropic(140.0, 10.0, 5.0, 0.3)
    off = voigt.copy()
    off[2, 2] *= 1.01
    change = hole.edge_hoop_stress(off, np.pi / 2) / hole.edge_hoop_stress(voigt, np.pi / 2) - 1
    assert abs(change) > 1e-3


def test_bad_input_is_refused():
    voigt = isotropic_voigt(1.0, 0.3)
    with pytest.raises(ValueError, match="inside the hole"):
        hole.hole_stress(voigt, 0.5, 0.0, 1.0, 1.0)
    with pytest.raises(ValueError, match="semi-axes"):
        hole.edge_hoop_stress(voigt, 0.0, -1.0)
    with pytest.raises(ValueError, match="angle"):
        hole.edge_hoop_stress(voigt, np.nan)
    with pytest.raises(ValueError, match="positive definite"):
        hole.edge_hoop_stress([[1, 2, 0], [2, 1, 0], [0, 0, 1]], 0.0)
