"""The symbol against the operator itself: a plane wave on a torus of bulk particles."""

import numpy as np
import pytest

from references.analytic.cosserat import shear_speed
from solver import ConductivityTensor, ElasticTensor, Family, PolarTensor
from solver.material import brillouin_zone, calibrate
from solver.material.symbol import acoustic_tensor, condensed_symbol, margins, symbol
from tests.solver.bodies import DISC, FIG_7

FAMILY = Family(2, 0.5)
ELASTIC = calibrate(FAMILY, ElasticTensor(FIG_7), "lattice")
THERMAL = calibrate(FAMILY, ConductivityTensor(DISC), "lattice")
K = np.array([0.7, -0.4])


def bond_by_bond(k):
    """Row of one particle in the wave (u, θ) exp(i k·x), from each bond's force and moment."""
    rows = np.zeros((3, 3), dtype=complex)
    for o, (kn, kt) in enumerate(zip(ELASTIC.normal, ELASTIC.shear, strict=True)):
        length, n = FAMILY.length[o], FAMILY.normal[o]
        t = np.array([-n[1], n[0]])
        phase = np.exp(1j * (k @ FAMILY.offsets[o]))
        stretch = np.append((phase - 1) * n / length, 0.0)
        shear = np.append((phase - 1) * t / length, -0.5 * (phase + 1))
        weight = FAMILY.weight[o] * FAMILY.cell_area
        rows[:2] -= weight * (kn * np.outer(n, stretch) + kt * np.outer(t, shear))
        rows[2] -= 0.5 * weight * length * kt * shear
    return rows


def test_symbol_is_the_row_of_a_particle_in_a_wave():
    found = symbol(FAMILY, ELASTIC, K)
    np.testing.assert_allclose(found, bond_by_bond(K), atol=1e-12 * np.abs(found).max())
    np.testing.assert_allclose(found, found.conj().T)


def test_condensed_symbol_eliminates_the_rotation():
    full = symbol(FAMILY, ELASTIC, K)
    wanted = full[:2, :2] - np.outer(full[:2, 2], full[2, :2]) / full[2, 2]
    np.testing.assert_allclose(condensed_symbol(FAMILY, ELASTIC, K), wanted.real, rtol=1e-12)
    assert np.abs(wanted.imag).max() < 1e-12 * np.abs(wanted).max()


def test_long_waves_see_the_continuum():
    k = 1e-3 * K
    direction = K / np.linalg.norm(K)
    size = (np.linalg.norm(k) / FAMILY.spacing) ** 2
    condensed = condensed_symbol(FAMILY, ELASTIC, k) / size
    np.testing.assert_allclose(condensed, acoustic_tensor(FIG_7, direction), rtol=1e-5)
    conduction = symbol(FAMILY, THERMAL, k) / size
    assert conduction == pytest.approx(direction @ DISC @ direction, rel=1e-5)
    assert margins(FAMILY, ELASTIC, k[None])[0] == pytest.approx(1.0, rel=1e-5)


@pytest.mark.parametrize("length", [0.0, 0.3, 1.0, 3.0, 30.0])
def test_shear_waves_of_a_polar_solid_disperse_as_the_continuum(length):
    """Waves long beside the horizon, whatever they are beside the solid's own length."""
    solid, family, k = ElasticTensor.isotropic(2.4, 0.2), Family(3, 1e-3), np.array([5e-3, 0.0])
    wave_number = k[0] / family.spacing
    bending = np.diag([2.0, 1.0]) * (length / wave_number) ** 2
    moduli = calibrate(family, PolarTensor(solid, bending) if length else solid, "lattice")
    found = condensed_symbol(family, moduli, k) / wave_number**2
    speed = shear_speed(solid.voigt, bending[0, 0], wave_number)
    assert found[1, 1] == pytest.approx(float(speed), rel=2e-5)


def test_half_of_the_zone_without_its_centre():
    zone = brillouin_zone(4)
    assert np.abs(zone).max() == np.pi
    assert (zone[:, 1] >= 0).all()
    assert np.linalg.norm(zone, axis=1).min() > 0
