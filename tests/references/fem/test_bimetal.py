"""The bimetal by finite elements: Timoshenko's curvature, free expansion, convergence."""

import numpy as np
import pytest

from references.analytic.voigt import isotropic_voigt
from references.fem.bimetal import Layers, displacement

SOFT, STIFF = isotropic_voigt(1.0, 0.3), isotropic_voigt(3.0, 0.3)


def strip(first, second, lower=SOFT, upper=STIFF, length=6.0):
    strains = [(a, a, 0.0) for a in (first, second)]
    return Layers(length, 1.0, lower, upper, *strains)


def test_equal_layers_expand_and_do_not_bend():
    points = np.random.default_rng(0).uniform([-2.9, -0.49], [2.9, 0.49], (40, 2))
    found = displacement(strip(0.01, 0.01), points, 4)
    np.testing.assert_allclose(found, 0.01 * points, atol=1e-12)


def test_the_middle_bends_as_timoshenko_says():
    body = strip(0.01, 0.0)
    x = np.linspace(-1, 1, 21)
    u2 = displacement(body, np.column_stack([x, 0 * x]), 8)[:, 1]
    assert 2 * np.polyfit(x, u2, 2)[0] == pytest.approx(body.curvature(), rel=2e-3)
    # The lower layer grows: the strip's ends go up where it is longer below, like a smile.
    assert body.curvature() < 0 or u2[0] > u2[10]


def test_finer_elements_change_little():
    body = strip(0.01, 0.003, length=4.0)
    points = np.random.default_rng(0).uniform([-1.9, -0.45], [1.9, 0.45], (40, 2))
    coarse, fine = (displacement(body, points, across) for across in (8, 16))
    assert np.abs(coarse - fine).max() < 1e-3 * np.abs(fine).max()
