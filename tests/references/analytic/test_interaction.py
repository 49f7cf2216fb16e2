"""The interaction integral of closed fields, by plain quadrature."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from references.analytic.interaction import intensities
from references.analytic.lekhnitskii import crack_tip_gradient
from references.analytic.voigt import turned_axes
from tests.references.analytic.tensors import random_voigt

few = settings(derandomize=True, deadline=None, max_examples=25)


def polar(inner, outer, radial=24, around=200):
    """Gauss points across a ring, midpoints around it (none on the crack), and their areas."""
    s, w = np.polynomial.legendre.leggauss(radial)
    r = inner + (outer - inner) * (s + 1) / 2
    angle = (np.arange(around) + 0.5) * 2 * np.pi / around - np.pi
    rr, tt = np.meshgrid(r, angle)
    area = rr * (w * (outer - inner) / 2) * 2 * np.pi / around
    return np.stack([rr * np.cos(tt), rr * np.sin(tt)], axis=-1), area


@few
@given(random_voigt(), st.floats(-1, 1), st.floats(-1, 1), st.floats(-3.1, 3.1))
def test_factors_come_back_whatever_the_tensor_and_the_crack_s_direction(voigt, k1, k2, angle):
    points, area = polar(0.3, 0.8)
    own = turned_axes(voigt, angle)
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    local = crack_tip_gradient(own, points[..., 0], points[..., 1], k1, k2)
    gradient = np.einsum("ai,...ab,bj->...ij", turn, local, turn)
    found = intensities(voigt, points @ turn, gradient, area, angle, 0.3, 0.8)
    np.testing.assert_allclose(found, (k1, k2), atol=1e-3)
    more = intensities(voigt, points @ turn, 1.01 * gradient, area, angle, 0.3, 0.8)
    np.testing.assert_allclose(more, 1.01 * np.array(found), atol=1e-12)


def test_homogeneous_strain_along_the_crack_has_no_factors():
    """A stress along the crack and a rotation leave its tip without singularity."""
    voigt = np.array([[1, 1 / 5, 1 / 10], [1 / 5, 4 / 5, 1 / 6], [1 / 10, 1 / 6, 1 / 3]])
    points, area = polar(0.3, 0.8)
    e11, e22, shear = np.linalg.solve(voigt, [1.0, 0.0, 0.0])
    gradient = np.array([[e11, shear / 2 - 0.4], [shear / 2 + 0.4, e22]])
    gradient = np.broadcast_to(gradient, (*points.shape[:-1], 2, 2))
    found = intensities(voigt, points, gradient, area, 0.0, 0.3, 0.8)
    np.testing.assert_allclose(found, 0.0, atol=2e-3)


def test_bad_input_is_refused():
    points, area = polar(0.3, 0.8)
    flat = np.zeros((*points.shape[:-1], 2, 2))
    with pytest.raises(ValueError, match="0 < inner < outer"):
        intensities(np.eye(3), points, flat, area, 0.0, 0.8, 0.3)
    with pytest.raises(ValueError, match="not finite"):
        intensities(np.eye(3), points, np.full_like(flat, np.nan), area, 0.0, 0.3, 0.8)
