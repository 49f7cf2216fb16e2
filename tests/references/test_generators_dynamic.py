"""Stored modes, cooling and waves against what must hold of them."""

import numpy as np
import pytest

from references.analytic.christoffel import wave_speeds
from references.analytic.lamb import edge_displacement, ricker
from references.generators_dynamic import plate_stiffness
from references.provenance import load


def test_lames_modes_are_among_the_stored_ones() -> None:
    """ω = π √((C11 − C12)/ρ) of a free square whose solid has C11 = C22."""
    stored = load("free-plates")
    for row in (0, 1):
        voigt = stored["voigt"][row]
        exact = np.pi * np.sqrt(voigt[0, 0] - voigt[0, 1])
        assert np.abs(stored["frequencies"][row] / exact - 1).min() < 1e-5


def test_a_feature_softens_a_plate_and_turning_by_a_right_angle_changes_nothing() -> None:
    stored = load("free-plates")
    plain, hole, crack = (
        stored["frequencies"][0],
        stored["frequencies"][8],
        stored["frequencies"][9],
    )
    assert (np.sort(crack)[:10] < plain[:10] * (1 + 1e-4)).all()
    assert hole[0] < plain[0]
    lamina = {"lamina": [4.0, 1.0, 0.45, 0.25]}
    along, across = (plate_stiffness({**lamina, "degrees": angle}) for angle in (20.0, 110.0))
    np.testing.assert_allclose(across[:2, :2], along[1::-1, 1::-1], rtol=1e-12)
    np.testing.assert_allclose(across[2, :2], -along[2, 1::-1], rtol=1e-12)


@pytest.mark.parametrize("n", [20, 40, 80])
def test_the_cracked_square_keeps_its_heat(n: int) -> None:
    field = load("cracked-square-cools")[f"grid_{n}"].reshape(n, n)
    # Odd about the centre but for the crack: rows are y, columns x.
    assert field.mean() == pytest.approx(0.5, abs=2e-3)
    left = np.abs(np.diff(field[n // 2 - 1 : n // 2 + 1, : n // 4], axis=0))
    right = np.abs(np.diff(field[n // 2 - 1 : n // 2 + 1, -n // 4 :], axis=0))
    assert left.min() > 3 * right.max()


def test_lambs_pulse_arrives_with_the_first_wave_and_is_the_closed_form() -> None:
    stored = load("lamb-pulse")
    given = stored.record["arguments"]
    lam = 2 * given["poisson"] / (1 - 2 * given["poisson"])
    voigt = np.array([[lam + 2, lam, 0], [lam, lam + 2, 0], [0, 0, 1.0]])
    fastest = wave_speeds(voigt, 1.0, 0.0)[0]
    pulse = ricker(given["frequency"], given["delay"])
    for x, times, found in zip(
        stored["receivers"], stored["times"], stored["displacement"], strict=True
    ):
        begins = given["delay"] - 1.0 + (x - given["half_width"]) / fastest
        assert np.abs(found[times < begins]).max() < 1e-3 * np.abs(found).max()
        some = slice(40, None, 16)
        again = edge_displacement(x, times[some], pulse, 0.25, (lam, 1.0), 1.0, given["half_width"])
        assert np.abs(again - found[some]).max() < 1e-7 * np.abs(found).max()
