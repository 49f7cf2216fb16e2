"""Tetrachiral lattice: against a numerical minimum of the cell's energy, and the paper's forms."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from references.analytic import tetrachiral

quick = settings(deadline=None, max_examples=40, derandomize=True)
stiffness = st.floats(0.01, 100.0)
angles = st.floats(0.0, 0.78)


def cell_stiffness(Kn, Kt, beta):
    """Condense the rotation out of the two springs of a cell, by linear algebra."""
    rows = []
    for along in (np.array([1.0, 0.0]), np.array([0.0, 1.0])):
        across = np.array([-along[1], along[0]])
        for k, d in (
            (Kn, np.cos(beta) * along + np.sin(beta) * across),
            (Kt, -np.sin(beta) * along + np.cos(beta) * across),
        ):
            # Jump over the pitch: eps.along - phi across, in e11, e22, 2 e12, phi.
            e = [d[0] * along[0], d[1] * along[1], 0.5 * (d[0] * along[1] + d[1] * along[0])]
            rows.append(np.sqrt(k) * np.array([*e, -d @ across]))
    full = np.array(rows).T @ np.array(rows)
    return full[:3, :3] - np.outer(full[:3, 3], full[3, :3]) / full[3, 3]


def check_condensed_cell(got, Kn, Kt, beta):
    assert np.abs(got - cell_stiffness(Kn, Kt, beta)).max() <= 1e-12 * (Kn + Kt)
    assert np.linalg.eigvalsh(got)[0] > 0


def check_equations(got, Kn, Kt, beta):
    c, s = np.cos(beta), np.sin(beta)
    top = (Kn - Kt) ** 2 * np.cos(4 * beta) - (Kn**2 + 14 * Kn * Kt + Kt**2)
    bottom = 8 * ((Kn - Kt) * np.cos(2 * beta) - (Kn + Kt))
    tolerance = 1e-11 * (Kn + Kt) * max(Kn / Kt, Kt / Kn)
    assert abs(got[0, 0] - top / bottom) <= tolerance
    c12 = -((Kn - Kt) ** 2) * c**2 * s**2 / (2 * (Kt * c**2 + Kn * s**2))
    assert abs(got[0, 1] - c12) <= tolerance
    assert got[2, 2] == pytest.approx(0.5 * (Kn * s**2 + Kt * c**2), rel=1e-13)
    assert got[0, 2] == pytest.approx(0.25 * (Kn - Kt) * np.sin(2 * beta), abs=1e-13 * (Kn + Kt))
    assert got[0, 2] == -got[1, 2]


@quick
@given(stiffness, stiffness, angles)
def test_condensed_cell(Kn, Kt, beta):
    check_condensed_cell(tetrachiral.effective_voigt(Kn, Kt, beta), Kn, Kt, beta)


@quick
@given(stiffness, stiffness, angles)
def test_equations_87_to_90_with_the_corrected_denominator(Kn, Kt, beta):
    check_equations(tetrachiral.effective_voigt(Kn, Kt, beta), Kn, Kt, beta)


def test_straight_lattice():
    assert tetrachiral.effective_voigt(5.0, 2.0, 0.0) == pytest.approx(np.diag([5.0, 5.0, 1.0]))


def test_equal_stiffnesses_do_not_see_the_angle():
    got = tetrachiral.effective_voigt(3.0, 3.0, 0.4)
    assert got == pytest.approx(np.diag([3.0, 3.0, 1.5]), abs=1e-14)


def test_paper_geometry():
    # Sect. 2.3.2: a = 20 mm, beta = atan(1/2): b = a/2, pitch 25 l = 27.95 a.
    pitch, length, solid = tetrachiral.cell_geometry(0.02, np.arctan(0.5))
    assert length == pytest.approx(0.01, rel=1e-12)
    assert 25 * pitch / 0.02 == pytest.approx(27.95, abs=5e-3)
    assert solid == pytest.approx(0.8, rel=1e-12)
    Kn, Kt = tetrachiral.interface_stiffness(10e6, 0.5, length, 0.02 / 500)
    # 250 E/(1 - 1/4) and 250 E/3 by Eq. 86 with b/thickness = 250.
    assert pytest.approx((250 * 10e6 / 0.75, 250 * 10e6 / 3), rel=1e-12) == (Kn, Kt)


@pytest.mark.parametrize("check", [check_condensed_cell, check_equations])
@pytest.mark.parametrize("off", [(1.01, 1, 1), (1, 1.01, 1), (1, 1, 1.01)])
def test_one_per_cent_is_seen(check, off):
    right = (4.0, 1.0, 0.4)
    check(tetrachiral.effective_voigt(*right), *right)
    perturbed = np.multiply(right, off).tolist()
    with pytest.raises(AssertionError):
        check(tetrachiral.effective_voigt(*perturbed), *right)


@pytest.mark.parametrize("entry", [(0, 0), (0, 1), (0, 2), (2, 2)])
@pytest.mark.parametrize("check", [check_condensed_cell, check_equations])
def test_one_per_cent_in_an_entry_is_seen(check, entry):
    tensor = tetrachiral.effective_voigt(4.0, 1.0, 0.4)
    tensor[entry] *= 1.01
    with pytest.raises(AssertionError):
        check(tensor, 4.0, 1.0, 0.4)


def test_bad_input_is_refused():
    with pytest.raises(ValueError, match="stiffnesses"):
        tetrachiral.effective_voigt(0.0, 1.0, 0.1)
    with pytest.raises(ValueError, match="chirality"):
        tetrachiral.effective_voigt(1.0, 1.0, np.pi / 4)
    with pytest.raises(ValueError, match="chirality"):
        tetrachiral.effective_voigt(1.0, 1.0, np.nan)
    with pytest.raises(ValueError, match="interface"):
        tetrachiral.interface_stiffness(1.0, 0.7, 1.0, 1.0)
    with pytest.raises(ValueError, match="side"):
        tetrachiral.cell_geometry(0.0, 0.1)


@quick
@given(stiffness, stiffness, angles)
def test_blocks_turn_to_the_least_energy(Kn, Kt, beta):
    """The rotation that the condensed cell of rigid blocks takes, from interface to interface."""
    full = np.zeros((4, 4))
    for along in (np.array([1.0, 0.0]), np.array([0.0, 1.0])):
        across = np.array([-along[1], along[0]])
        normal = np.cos(beta) * along + np.sin(beta) * across
        tangent = -np.sin(beta) * along + np.cos(beta) * across
        for k, d in ((Kn, normal), (Kt, tangent)):
            strain = np.outer(d, along)
            row = np.array([strain[0, 0], strain[1, 1], 0.5 * (strain[0, 1] + strain[1, 0]),
                            -d @ across])  # fmt: skip
            full += k * np.outer(row, row)
    wanted = -full[3, :3] / full[3, 3]
    np.testing.assert_allclose(tetrachiral.effective_turn(Kn, Kt, beta), wanted, atol=1e-11)
