"""Compact tension: tabulated values, the deep-crack limit, the inverse."""

import numpy as np
import pytest

from references.analytic import compact_tension as ct


def check_table(shape_factor):
    # ASTM E399, table of f(a/W) for the compact specimen.
    assert shape_factor(0.45) == pytest.approx(8.34, abs=0.005)
    assert shape_factor(0.50) == pytest.approx(9.66, abs=0.005)
    assert shape_factor(0.55) == pytest.approx(11.36, abs=0.005)


def check_deep_crack(shape_factor):
    # A half plane with an edge ligament in bending: f (1 - a/W)^(3/2) -> 3.978 (Tada).
    ratio = 1 - 1e-9
    assert shape_factor(ratio) * (1e-9) ** 1.5 == pytest.approx(3.978, rel=5e-3)


def test_tabulated_values():
    check_table(ct.shape_factor)


def test_deep_crack_limit():
    check_deep_crack(ct.shape_factor)


def test_units_and_inverse():
    K = ct.stress_intensity(98.0, 1e-3, 0.02578, 0.36 * 0.02578)
    load = ct.critical_load(float(K), 1e-3, 0.02578, 0.36 * 0.02578)
    assert load == pytest.approx(98.0, rel=1e-12)
    assert ct.stress_intensity(1.0, 1.0, 1.0, np.array([0.3, 0.5])).shape == (2,)


@pytest.mark.parametrize("check", [check_table, check_deep_crack])
@pytest.mark.parametrize("factor", [0.99, 1.01])
def test_one_per_cent_is_seen(check, factor):
    with pytest.raises(AssertionError):
        check(lambda ratio: factor * ct.shape_factor(ratio))


def test_one_per_cent_of_crack_is_seen():
    with pytest.raises(AssertionError):
        check_table(lambda ratio: ct.shape_factor(1.01 * ratio))


def test_bad_input_is_refused():
    with pytest.raises(ValueError, match="a/W"):
        ct.shape_factor(0.1)
    with pytest.raises(ValueError, match="a/W"):
        ct.shape_factor(np.nan)
    with pytest.raises(ValueError, match="thickness"):
        ct.stress_intensity(1.0, 0.0, 1.0, 0.5)
    with pytest.raises(ValueError, match="toughness"):
        ct.critical_load(0.0, 1.0, 1.0, 0.5)
