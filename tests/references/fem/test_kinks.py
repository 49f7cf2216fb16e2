import numpy as np
import pytest
from numpy.typing import NDArray

from references.analytic.kinking import hoop_kink_angle
from references.analytic.lekhnitskii import energy_release_rate
from references.fem.kinks import KinkTable, kink_matrix, kink_table

C = np.array([[1, 1 / 5, 1 / 10], [1 / 5, 4 / 5, 1 / 6], [1 / 10, 1 / 6, 1 / 3]])
ISOTROPIC = np.array([[1, 0.3, 0], [0.3, 1, 0], [0, 0, 0.35]]) / 0.91


def amestoy_leblond(angle: float) -> NDArray:
    """Isotropic F(ω) as a series in m = ω/π; Int. J. Solids Struct. 29 (1992) 465."""
    m, p = angle / np.pi, np.pi
    f11 = 1 - 3 * p**2 / 8 * m**2 + (p**2 - 5 * p**4 / 128) * m**4
    f12 = -3 * p / 2 * m + (10 * p / 3 + p**3 / 16) * m**3
    f12 += (-2 * p - 133 * p**3 / 180 + 59 * p**5 / 1280) * m**5
    f21 = p / 2 * m - (4 * p / 3 + p**3 / 48) * m**3
    f21 += (-2 * p / 3 + 13 * p**3 / 30 - 59 * p**5 / 3840) * m**5
    f22 = 1 - (4 + 3 * p**2 / 8) * m**2 + (8 / 3 + 29 * p**2 / 18 - 5 * p**4 / 128) * m**4
    return np.array([[f11, f12], [f21, f22]])


@pytest.mark.parametrize("degrees", [0, -5, 20])
def test_isotropic_kink_against_the_series(degrees: float) -> None:
    angle = np.radians(degrees)
    assert np.abs(kink_matrix(ISOTROPIC, angle) - amestoy_leblond(angle)).max() < 4e-4


def test_the_error_goes_with_the_kinks_length() -> None:
    angle = np.radians(15)
    errors = [
        np.abs(kink_matrix(ISOTROPIC, angle, k) - amestoy_leblond(angle)).max()
        for k in (0.04, 0.01)
    ]
    assert 3 < errors[0] / errors[1] < 5


def test_an_anisotropic_kink_straight_ahead_changes_nothing() -> None:
    almost = kink_matrix(C, 1e-4, 1e-3)
    assert np.abs(almost - np.eye(2)).max() < 2e-3


def test_a_kink_that_turns_back_keeps_clear_of_the_old_crack() -> None:
    """At 145° the old face is 0.57 of the kink away: a ring of 0.7 would reach across it."""
    back = kink_matrix(ISOTROPIC, np.radians(145), 0.01)
    # mirrored, the terms that couple the modes change sign
    mirrored = kink_matrix(ISOTROPIC, np.radians(-145), 0.01) * [[1, -1], [-1, 1]]
    assert np.allclose(back, mirrored, atol=2e-3)


def table(angles: NDArray) -> KinkTable:
    """From the series: tests the table without meshes."""
    return KinkTable(ISOTROPIC, angles, np.stack([amestoy_leblond(w) for w in angles]))


def test_energy_and_hoop_criteria_agree_where_mode_one_dominates() -> None:
    found = table(np.radians(np.linspace(-60, 60, 25)))
    assert found.kink_angle(1.0, 0.0) == pytest.approx(0.0, abs=1e-6)
    assert found.kink_angle(1.0, 0.1) == pytest.approx(
        hoop_kink_angle(ISOTROPIC, 1.0, 0.1), abs=0.02
    )
    assert found.kink_angle(1.0, -0.1) == pytest.approx(-found.kink_angle(1.0, 0.1), abs=1e-9)
    straight = found.energy_release_rate(1.0, 0.4, 0.0)
    assert straight == pytest.approx(energy_release_rate(ISOTROPIC, 1.0, 0.4), rel=1e-12)


@pytest.mark.slow
def test_isotropic_pure_mode_two_kinks_at_the_known_angle() -> None:
    # largest energy release rate in pure mode II: 75.6° (Amestoy and Leblond 1992)
    found = kink_table(ISOTROPIC, np.radians([-90, -85, -80, -75, -70, -65, -60]))
    assert np.degrees(found.kink_angle(0.0, 1.0)) == pytest.approx(-75.6, abs=0.3)


def test_energy_release_rate_turns_with_the_kink() -> None:
    angles = np.radians(np.linspace(-95, 95, 20))
    found = KinkTable(
        C, angles, np.stack([np.eye(2) + 0.2 * np.array([[w, 1], [2, -w]]) for w in angles])
    )
    direct = [
        energy_release_rate(C, *(found.at(np.array(w)) @ [0.6, 0.8]), float(w)) for w in angles
    ]
    np.testing.assert_allclose(found.energy_release_rate(0.6, 0.8, angles), direct, rtol=1e-12)


def test_bad_input_is_refused() -> None:
    with pytest.raises(ValueError, match="kink's angle"):
        kink_matrix(C, 3.0)
    with pytest.raises(ValueError, match="must be short"):
        kink_matrix(C, 0.3, 0.5)
    with pytest.raises(ValueError, match="four ascending"):
        kink_table(C, [0.0, 0.1])
    few = table(np.radians(np.linspace(-10, 10, 5)))
    with pytest.raises(ValueError, match="outside the table"):
        few.energy_release_rate(1.0, 0.0, 1.0)
    with pytest.raises(ValueError, match="table's edge"):
        few.kink_angle(0.5, 1.0)
    with pytest.raises(ValueError, match="opens"):
        few.kink_angle(-1.0, 0.0)
