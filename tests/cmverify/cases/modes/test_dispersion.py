"""The quartic form of a lattice, and what it does to modes whose shape is known."""

import numpy as np
import pytest

from cmverify.cases.common.materials import isotropic
from cmverify.cases.modes.dispersion import quartic, shifts
from solver import ElasticTensor, Family
from solver.material import calibrated
from solver.material.symbol import acoustic_tensor, condensed_symbol

ANISOTROPIC = np.array([[1, 0.2, 0.1], [0.2, 0.8, 1 / 6], [0.1, 1 / 6, 1 / 3]])


@pytest.mark.parametrize("m", [3, 5])
@pytest.mark.parametrize("angle", [0.3, 1.9])
def test_the_form_is_the_symbols_second_term(m, angle):
    family = Family(m, 1.0)
    moduli = calibrated(family, ElasticTensor(ANISOTROPIC), "lattice", None)
    along = np.array([np.cos(angle), np.sin(angle)])
    k = 0.12
    term = condensed_symbol(family, moduli, k * along) / k**2 - acoustic_tensor(ANISOTROPIC, along)
    q = quartic(ANISOTROPIC, m) @ [along[0] ** (4 - j) * along[1] ** j for j in range(5)]
    wanted = k**2 * np.array([[q[0], q[1]], [q[1], q[2]]])
    assert np.abs(term - wanted).max() < 2e-2 * np.abs(wanted).max()


def test_waves_of_twenty_cells_are_some_per_cent_slow():
    """Of P waves 5 % at m = 5 and 2 % at m = 3, as measured."""
    voigt, k = isotropic(0.2), 2 * np.pi / 20
    slow = [0.5 * quartic(voigt, m)[0, 0] * k**2 / voigt[0, 0] for m in (5, 3)]
    assert slow == pytest.approx([-0.05, -0.02], abs=0.01)


def test_a_sine_product_shifts_as_its_waves_do():
    side, density, frequency = 3.0, 2.0, 1.7
    p, r = 2 * np.pi / side, np.pi / side

    def shape(points):
        x, y = points.T
        one = np.sin(p * x) * np.cos(r * y)
        return np.stack([one, -2 * one], axis=-1)[None]

    form = np.random.default_rng(3).standard_normal((3, 5))
    form[:, 1::2] = 0.0  # odd derivatives of a sine product are of another parity
    even = form[:, ::2] @ [p**4, p**2 * r**2, r**4]
    wanted = (even[0] - 4 * even[1] + 4 * even[2]) / (5 * density * 2 * frequency**2)
    found = shifts(form, shape, side, np.array([frequency]), density)
    # Shapes are polynomials of degree 12.
    assert found == pytest.approx([wanted], rel=1e-3)
