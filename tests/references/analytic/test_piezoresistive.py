"""Strained directions: moments, closed factors, invariance under turns."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from references.analytic.piezoresistive import angular_conductivity, strained_conductivity

few = settings(derandomize=True, deadline=None, max_examples=25)


def turned(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def tensor(k1, k2, angle):
    return turned(angle) @ np.diag([k1, k2]) @ turned(angle).T


@few
@given(st.floats(0.2, 5.0), st.floats(0.0, 3.0), st.sampled_from([2, 4, 8]))
def test_without_strain_it_is_the_tensor(ratio, angle, exponent):
    wanted = tensor(1.0, ratio, angle)
    found = strained_conductivity(wanted, np.zeros(3), 4.0, exponent)
    assert np.abs(found - wanted).max() < 1e-12 * (1 + ratio)


@few
@given(st.tuples(*[st.floats(-1e-2, 1e-2)] * 3), st.floats(-5.0, 5.0))
def test_an_isotropic_conductor_has_the_isotropic_fourth_moments(strain, gauge):
    e = np.array([[strain[0], strain[2] / 2], [strain[2] / 2, strain[1]]])
    wanted = np.eye(2) + gauge / 4 * (np.trace(e) * np.eye(2) + 2 * e)
    assert np.abs(strained_conductivity(np.eye(2), strain, gauge) - wanted).max() < 1e-13


@few
@given(st.floats(0.0, 3.0), st.booleans(), st.booleans())
def test_turning_body_and_strain_turns_the_result(angle, resistive, actual):
    e = np.array([[1e-2, 3e-3], [3e-3, -5e-3]])
    r = turned(angle)
    f = r @ e @ r.T
    options = {"gauge": 3.0, "exponent": 4, "resistive": resistive, "actual": actual}
    first = strained_conductivity(tensor(1.0, 0.3, 0.2), [e[0, 0], e[1, 1], 2 * e[0, 1]], **options)
    other = strained_conductivity(
        tensor(1.0, 0.3, 0.2 + angle), [f[0, 0], f[1, 1], 2 * f[0, 1]], **options
    )
    assert np.abs(other - r @ first @ r.T).max() < 1e-12


def test_small_strains_part_laws_and_lengths_as_they_must():
    strain = 1e-6 * np.array([1.0, 0.0, 0.0])
    slopes = {
        (r, a): (strained_conductivity(np.eye(2), strain, 4.0, 2, r, a)[0, 0] - 1) / 0.75e-6
        for r in (False, True)
        for a in (False, True)
    }
    wanted = {(False, False): 4, (True, False): -4, (False, True): 2, (True, True): -6}
    for key, value in wanted.items():
        assert slopes[key] == pytest.approx(value, rel=1e-4)


def test_odd_exponents_are_refused():
    with pytest.raises(ValueError, match="must be even"):
        angular_conductivity(np.eye(2), 3)
