"""Thermal expansion: plane strain from three dimensions, rotation, and what is refused."""

import numpy as np
import pytest

from solver import ElasticTensor, ExpansionTensor


def test_plane_strain_is_the_solid_held_along_its_third_axis():
    """ε_α without stress in the plane, from the compliance in three dimensions."""
    e = np.array([140.0, 10.0, 12.0])
    n12, n13, n23 = 0.3, 0.25, 0.2
    s = np.array([[1 / e[0], -n12 / e[0], -n13 / e[0]],
                  [-n12 / e[0], 1 / e[1], -n23 / e[1]],
                  [-n13 / e[0], -n23 / e[1], 1 / e[2]]])  # fmt: skip
    a = np.array([1.0, 25.0, 30.0])
    s33 = -a[2] / s[2, 2]  # holds ε33 = s33/E3 + a3 at zero
    wanted = a[:2] + s[:2, 2] * s33
    nu31, nu32 = n13 * e[2] / e[0], n23 * e[2] / e[1]
    found = ExpansionTensor.orthotropic(1.0, 25.0, "strain", 30.0, nu31, nu32)
    np.testing.assert_allclose(found.matrix, np.diag(wanted), rtol=1e-14)
    # The same stress when clamped as in three dimensions.
    plane = ElasticTensor.orthotropic(*e[:2], 5.0, n12, plane="strain", E3=e[2], nu13=n13, nu23=n23)
    clamped = -np.linalg.inv(s) @ a
    np.testing.assert_allclose(-plane.voigt @ found.voigt, [*clamped[:2], 0.0], rtol=1e-12)


def test_turned():
    a = ExpansionTensor.orthotropic(1.0, 3.0).rotated(0.4)
    first = np.array([np.cos(0.4), np.sin(0.4)])
    np.testing.assert_allclose(a.matrix @ first, first, rtol=1e-14)
    np.testing.assert_allclose(a.voigt, [a.matrix[0, 0], a.matrix[1, 1], 2 * a.matrix[0, 1]])


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: ExpansionTensor([[1.0, 2.0], [0.0, 1.0]]), "symmetric"),
        (lambda: ExpansionTensor([1.0, 2.0]), "2×2"),
        (lambda: ExpansionTensor(np.full((2, 2), np.nan)), "finite"),
        (lambda: ExpansionTensor.isotropic(1.0, "strain"), "Poisson's ratio"),
        (lambda: ExpansionTensor.orthotropic(1.0, 1.0, "strain"), "needs alpha3"),
        (lambda: ExpansionTensor.orthotropic(1.0, 1.0, "bent"), "plane must be"),
    ],
)
def test_what_is_no_expansion_is_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()
