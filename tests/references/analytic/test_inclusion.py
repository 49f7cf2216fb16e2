"""Fields of a circular inclusion: equilibrium, what is continuous, limits."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from references.analytic.inclusion import ConductingInclusion, ElasticInclusion

modulus = st.floats(0.05, 20.0)
poisson = st.floats(0.0, 0.45)
number = st.floats(-1.0, 1.0)
ring = np.linspace(0.0, 2 * np.pi, 17)[:-1]
NORMAL = np.array([np.cos(ring), np.sin(ring)])


def plane(modulus, poisson):
    c = modulus / (1 - poisson**2)
    return np.array([[c, poisson * c, 0], [poisson * c, c, 0], [0, 0, 0.5 * (1 - poisson) * c]])


@settings(derandomize=True, deadline=None, max_examples=40)
@given(modulus, poisson, modulus, poisson, st.tuples(number, number, number))
def test_hooke_equilibrium_and_continuity(e0, n0, e1, n1, far):
    found = ElasticInclusion((e0, n0), (e1, n1), far, radius=0.7)
    step = 1e-4
    for radius, voigt in ((0.4, plane(e1, n1)), (1.1, plane(e0, n0))):
        x, y = radius * NORMAL
        dx = (found.displacement(x + step, y) - found.displacement(x - step, y)) / (2 * step)
        dy = (found.displacement(x, y + step) - found.displacement(x, y - step)) / (2 * step)
        strain = np.stack([dx[:, 0], dy[:, 1], dx[:, 1] + dy[:, 0]], axis=-1)
        stress = found.stress_at(x, y)
        np.testing.assert_allclose(strain @ voigt, stress, atol=1e-6)
        np.testing.assert_allclose(
            found.rotation(x, y), 0.5 * (dx[:, 1] - dy[:, 0]), atol=1e-6 / e0 + 1e-6 / e1
        )
        sx = (found.stress_at(x + step, y) - found.stress_at(x - step, y)) / (2 * step)
        sy = (found.stress_at(x, y + step) - found.stress_at(x, y - step)) / (2 * step)
        np.testing.assert_allclose(sx[:, 0] + sy[:, 2], 0.0, atol=1e-5)
        np.testing.assert_allclose(sx[:, 2] + sy[:, 1], 0.0, atol=1e-5)
    inside, outside = (0.7 * (1 + tiny) * NORMAL for tiny in (-1e-12, 1e-12))
    size = max(1 / e0, 1 / e1)
    np.testing.assert_allclose(
        found.displacement(*inside), found.displacement(*outside), atol=1e-10 * size
    )
    traction = []
    for place in (inside, outside):
        s = found.stress_at(*place).T
        traction.append([s[0] * NORMAL[0] + s[2] * NORMAL[1], s[2] * NORMAL[0] + s[1] * NORMAL[1]])
    np.testing.assert_allclose(traction[0], traction[1], atol=1e-9)
    np.testing.assert_allclose(found.stress_at(1e6, 2e6), far, atol=1e-9)


def test_a_soft_disc_is_a_hole():
    found = ElasticInclusion((1.0, 0.2), (1e-12, 0.2), (1.0, 0.0, 0.0))
    x, y = (1 + 1e-12) * NORMAL
    s = found.stress_at(x, y).T
    hoop = s[0] * NORMAL[1] ** 2 + s[1] * NORMAL[0] ** 2 - 2 * s[2] * NORMAL[0] * NORMAL[1]
    np.testing.assert_allclose(hoop, 1 - 2 * np.cos(2 * ring), atol=1e-9)


@settings(derandomize=True, deadline=None, max_examples=40)
@given(modulus, modulus, number, number)
def test_temperature_and_flux_are_continuous(k0, k1, gx, gy):
    found = ConductingInclusion(k0, k1, (gx, gy), radius=0.7)
    step = 1e-6
    slope = []
    for k, inner, outer in ((k1, 0.7 - step, 0.7), (k0, 0.7, 0.7 + step)):
        slope.append(k * (found.value(*outer * NORMAL) - found.value(*inner * NORMAL)) / step)
    np.testing.assert_allclose(slope[0], slope[1], atol=1e-4)
    x, y = 1.3 * NORMAL
    h = 1e-3
    around = (
        found.value(x + h, y)
        + found.value(x - h, y)
        + found.value(x, y + h)
        + found.value(x, y - h)
    )
    np.testing.assert_allclose((around - 4 * found.value(x, y)) / h**2, 0.0, atol=1e-5)
