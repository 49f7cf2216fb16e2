"""The solver's own field of a tip is that of the references; isotropy is no exception."""

import numpy as np
import pytest

from references.analytic import lekhnitskii as lek
from references.analytic.voigt import isotropic_voigt, turned_axes
from solver.tips.field import TipField

PAPER = np.array([[1.0, 1 / 5, 1 / 10], [1 / 5, 4 / 5, 1 / 6], [1 / 10, 1 / 6, 1 / 3]])


@pytest.mark.parametrize("voigt", [PAPER, isotropic_voigt(1.0, 0.2)], ids=["paper", "isotropic"])
@pytest.mark.parametrize("degrees", [0.0, 27.0, 180.0, -110.0])
def test_it_is_the_field_of_sih_paris_and_irwin(voigt, degrees):
    """Written down twice, with other code: up to the factor √(2π) that units of K carry."""
    angle = np.radians(degrees)
    direction = np.array([np.cos(angle), np.sin(angle)])
    axes = np.array([direction, [-direction[1], direction[0]]]).T
    around = np.linspace(-3.0, 3.0, 12)
    local = np.stack([np.cos(around), np.sin(around)], axis=-1)
    displacement, rotation = TipField(voigt, direction)(local @ axes.T)
    own = turned_axes(voigt, angle)
    for k, mode in enumerate([(1.0, 0.0), (0.0, 1.0)]):
        wanted = lek.crack_tip_displacement(own, *local.T, *mode) @ axes.T
        np.testing.assert_allclose(displacement[k].T, np.sqrt(2 * np.pi) * wanted, atol=1e-7)
        turn = lek.crack_tip_rotation(own, *local.T, *mode)
        np.testing.assert_allclose(rotation[k], np.sqrt(2 * np.pi) * turn, atol=1e-7)
