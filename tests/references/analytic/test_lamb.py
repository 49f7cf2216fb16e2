"""Lamb's problem: the path does not matter, Rayleigh's wave, arrivals, and the static limit."""

import numpy as np
import pytest

from references.analytic import lamb

LAME, DENSITY = (2 / 3, 1.0), 1.0  # ν = 0.2


def test_rayleigh_speed_of_known_solids():
    # c_R/c_S = 0.9194 for ν = 1/4, (2 − 2/√3)^½ exactly; 0.8741 for ν = 0.
    assert lamb.rayleigh_speed(np.sqrt(3.0), 1.0) == pytest.approx(np.sqrt(2 - 2 / np.sqrt(3)))
    assert lamb.rayleigh_speed(np.sqrt(2.0), 1.0) == pytest.approx(0.8740, abs=1e-4)


def test_the_pole_is_rayleighs():
    a, b = np.sqrt(DENSITY / (LAME[0] + 2 * LAME[1])), np.sqrt(DENSITY / LAME[1])
    p = 1.0 / lamb.rayleigh_speed(1 / a, 1 / b)
    assert abs(lamb.impulse(np.array(p + 1e-9j), a, b)) > 1e6


def test_the_path_of_integration_does_not_matter(monkeypatch):
    t = np.linspace(0.0, 6.0, 40)
    args = (2.0, t, lamb.ricker(1.0, 1.2), 0.3, LAME, DENSITY, 0.1)
    usual = lamb.edge_displacement(*args)
    other = lamb.edge_displacement(2.0, t, args[2], 0.6, LAME, DENSITY, 0.1)
    np.testing.assert_allclose(other, usual, atol=1e-7 * abs(usual).max())
    monkeypatch.setattr(lamb, "_PATH", 8001)
    np.testing.assert_allclose(lamb.edge_displacement(*args), usual, atol=1e-7 * abs(usual).max())


def test_nothing_before_the_pressure_wave_and_most_with_rayleighs():
    t = np.linspace(0.0, 8.0, 400)
    x, delay = 3.0, 1.2
    found = lamb.edge_displacement(x, t, lamb.ricker(1.0, delay), 0.3, LAME, DENSITY)
    c_p = np.sqrt(LAME[0] + 2 * LAME[1])
    early = t < x / c_p + delay - 1.2
    assert abs(found[early]).max() < 1e-4 * abs(found).max()
    peak = t[np.argmax(abs(found))] - delay
    assert peak == pytest.approx(x / lamb.rayleigh_speed(c_p, 1.0), abs=0.25)


def test_late_motion_is_the_growing_static_one():
    """Under a load that stays, w grows by Q (1 − ν)/(π μ) a logarithm of time (Flamant)."""
    nu, x = 0.2, 1.0

    def gaussian(t):
        return np.exp(-(((t - 2.0) / 0.5) ** 2)) / (0.5 * np.sqrt(np.pi))

    late = np.array([60.0, 120.0])
    found = lamb.edge_displacement(x, late, gaussian, 0.5, LAME, DENSITY)
    wanted = (1 - nu) / (np.pi * LAME[1] * (late - 2.0))
    np.testing.assert_allclose(found, wanted, rtol=3e-3)


def test_it_scales_and_bad_input_is_refused():
    t = np.linspace(0.0, 6.0, 20)
    one = lamb.edge_displacement(2.0, t, lamb.ricker(1.0, 1.2), 0.3, LAME, DENSITY)
    # Twice as long and as slow, three times as stiff at the same speeds.
    other = lamb.edge_displacement(
        4.0, 2 * t, lamb.ricker(0.5, 2.4), 0.6, (3 * LAME[0], 3 * LAME[1]), 3 * DENSITY
    )
    np.testing.assert_allclose(3 * other, one, atol=1e-8 * abs(one).max())
    with pytest.raises(ValueError, match="beside the load"):
        lamb.edge_displacement(0.1, t, np.real, 1.0, LAME, DENSITY, 0.2)
    with pytest.raises(ValueError, match="must be positive"):
        lamb.edge_displacement(2.0, t, np.real, 1.0, (1.0, -1.0), DENSITY)
