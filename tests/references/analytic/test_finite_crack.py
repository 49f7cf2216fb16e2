"""The finite crack: equilibrium, free faces, stress far away, and the tip's field near its ends."""

import numpy as np
import pytest

from references.analytic import lekhnitskii as lek
from references.analytic.finite_crack import FiniteCrack, intensities
from references.analytic.voigt import isotropic_voigt

PAPER = np.array([[1.0, 1 / 5, 1 / 10], [1 / 5, 4 / 5, 1 / 6], [1 / 10, 1 / 6, 1 / 3]])
REMOTE = (1.0, 0.5, -0.7)


@pytest.fixture(params=[PAPER, isotropic_voigt(1.0, 0.2)], ids=["anisotropic", "isotropic"])
def crack(request):
    return FiniteCrack(request.param, 0.7, *REMOTE)


def slopes(function, x, y, h=1e-4):
    def along(dx, dy):
        near = function(x + dx, y + dy) - function(x - dx, y - dy)
        far = function(x + 2 * dx, y + 2 * dy) - function(x - 2 * dx, y - 2 * dy)
        return (8 * near - far) / (12 * h)

    return along(h, 0.0), along(0.0, h)


def test_hooke_rotation_and_balance(crack):
    angle = np.linspace(0.1, 2 * np.pi, 23)
    x, y = 0.2 + 0.9 * np.cos(angle), 0.8 * np.sin(angle)
    by_x, by_y = slopes(crack.displacement, x, y)
    strain = np.stack([by_x[:, 0], by_y[:, 1], by_x[:, 1] + by_y[:, 0]], axis=-1)
    stress = crack.stress(x, y)
    np.testing.assert_allclose(strain @ crack.voigt, stress, atol=1e-9 * np.abs(stress).max())
    np.testing.assert_allclose(crack.rotation(x, y), 0.5 * (by_x[:, 1] - by_y[:, 0]), atol=1e-9)
    sx, sy = slopes(crack.stress, x, y)
    force = np.stack([sx[:, 0] + sy[:, 2], sx[:, 2] + sy[:, 1]])
    assert np.abs(force).max() < 1e-9 * np.abs(sx).max()


def test_faces_are_free_and_the_far_field_is_uniform(crack):
    x = np.linspace(-0.65, 0.65, 9)
    for face in (0.0, -0.0):
        stress = crack.stress(x, np.full_like(x, face))
        np.testing.assert_allclose(stress[:, 1:], 0.0, atol=1e-12)
    opening = crack.displacement(x, np.zeros(9)) - crack.displacement(x, -np.zeros(9))
    assert (opening[:, 1] > 0).all()
    far = crack.stress(np.array([1e6, 0.0]), np.array([0.0, -1e6]))
    np.testing.assert_allclose(far, np.tile([REMOTE[2], *REMOTE[:2]], (2, 1)), atol=1e-9)


def test_both_ends_have_the_intensities(crack):
    K = intensities(0.7, *REMOTE[:2])
    away = 1e-7 * np.array([[1.0, 0.0], [0.0, 1.0], [-0.5, 0.5]])
    tip = lek.crack_tip_stress(crack.voigt, *away.T, *K)
    size = np.abs(tip).max()
    right = crack.stress(0.7 + away[:, 0], away[:, 1])
    left = crack.stress(-0.7 - away[:, 0], -away[:, 1])
    np.testing.assert_allclose(right, tip, atol=1e-3 * size)
    np.testing.assert_allclose(left, tip, atol=1e-3 * size)


def test_a_crack_has_a_length():
    with pytest.raises(ValueError, match="half length"):
        FiniteCrack(PAPER, 0.0, 1.0)
