"""The heated disc: equilibrium, a free edge and Duhamel's law, by differences."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from references.analytic.thermal import HeatedDisc

discs = st.builds(
    HeatedDisc,
    E=st.floats(0.5, 5.0),
    nu=st.floats(-0.8, 0.45),
    alpha=st.floats(-2.0, 2.0),
    T0=st.floats(0.5, 3.0),
    radius=st.floats(0.5, 3.0),
    plane_strain=st.booleans(),
)


def slopes(function, x, y, step=1e-4):
    """Derivatives along x and y, each (..., components)."""
    return [
        (function(x + a, y + b) - function(x - a, y - b)) / (2 * step)
        for a, b in ((step, 0.0), (0.0, step))
    ]


@given(discs, st.integers(0, 10**6))
def test_the_field_satisfies_what_it_must(disc, seed):
    rng = np.random.default_rng(seed)
    r, angle = disc.radius * np.sqrt(rng.uniform(0.01, 0.98, 20)), rng.uniform(0, 7, 20)
    x, y = r * np.cos(angle), r * np.sin(angle)
    along, across = slopes(disc.stress, x, y)
    scale = disc.E * (abs(disc.alpha) * disc.T0 + 1e-3) * 20
    # Equilibrium.
    assert np.abs(along[:, 0] + across[:, 2]).max() < 1e-6 * scale / disc.radius
    assert np.abs(along[:, 2] + across[:, 1]).max() < 1e-6 * scale / disc.radius
    # Duhamel: stress of what the solid is strained beyond free expansion (plane strain: e33 = 0).
    gx, gy = slopes(disc.displacement, x, y)
    strain = np.stack([gx[:, 0], gy[:, 1], gx[:, 1] + gy[:, 0]])
    E, nu, free = disc.E, disc.nu, disc.alpha * disc.temperature(x, y)
    if disc.plane_strain:
        lam, mu = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
        trace = strain[0] + strain[1] - 3 * free
        s11, s22 = (lam * trace + 2 * mu * (strain[k] - free) for k in (0, 1))
    else:
        beyond = strain[:2] - free
        s11, s22 = (E / (1 - nu**2) * (beyond[k] + nu * beyond[1 - k]) for k in (0, 1))
    wanted = np.stack([s11, s22, E / (2 * (1 + nu)) * strain[2]], axis=-1)
    np.testing.assert_allclose(disc.stress(x, y), wanted, atol=1e-6 * scale)


@given(discs, st.floats(0.0, 7.0))
def test_the_edge_is_free(disc, angle):
    c, s = np.cos(angle), np.sin(angle)
    s11, s22, s12 = disc.stress(disc.radius * c, disc.radius * s)
    scale = disc.E * abs(disc.alpha) * disc.T0
    assert np.hypot(s11 * c + s12 * s, s12 * c + s22 * s) <= 1e-12 * scale + 1e-300


def test_what_is_no_solid_is_refused():
    with pytest.raises(ValueError, match="between -1 and 1/2"):
        HeatedDisc(nu=0.5)
