"""Johnson's formula: potential theory behind it, orthotropy, inverse, limits."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from references.analytic import potential_drop as drop

quick = settings(deadline=None, max_examples=40, derandomize=True)
ratios = st.floats(0.02, 0.95)
conductivities = st.floats(0.1, 10.0)


@quick
@given(ratios, st.floats(0.05, 2.0), conductivities, conductivities)
def test_formula_is_the_potential_at_the_edge(crack, probe, kx, ky):
    phi = drop.strip_potential(0.0, probe, crack, 1.0, kx, ky)
    assert drop.johnson(crack, probe, kx, ky) == pytest.approx(float(phi) / probe, rel=1e-11)


@quick
@given(ratios, conductivities, conductivities)
def test_potential_conducts_and_is_insulated(crack, kx, ky):
    h = 1e-3
    weights = {0: -205 / 72, 1: 8 / 5, 2: -1 / 5, 3: 8 / 315, 4: -1 / 560}

    def phi(x, y):
        return drop.strip_potential(x, y, crack, 1.0, kx, ky)

    x, y = np.array([0.2, 0.5, 0.8]), 0.3 * np.sqrt(ky / kx) * np.array([1.0, 1.5, 1.2])
    scale = np.sqrt(ky / kx)  # heights in which the field varies like the widths

    def second(dx, dy):
        return sum(
            w * (phi(x + k * dx, y + k * dy) + phi(x - k * dx, y - k * dy)) / (2 if k == 0 else 1)
            for k, w in weights.items()
        )

    xx, yy = second(h, 0.0) / h**2, second(0.0, h * scale) / (h * scale) ** 2
    size = kx * np.abs(xx).max() + ky * np.abs(yy).max() + kx * np.abs(phi(x, y)).max()
    assert np.abs(kx * xx + ky * yy).max() <= 1e-6 * size
    # No flux through the crack (phi is even in y there) and zero on the ligament.
    on_crack = np.linspace(0.05, 0.9, 5) * crack
    tiny = 1e-6 * crack * scale
    slope = (phi(on_crack, tiny + 0 * on_crack) - phi(on_crack, 0 * on_crack)) / tiny
    assert np.abs(slope).max() <= 1e-4
    ligament = crack + (1 - crack) * np.linspace(0.05, 0.95, 5)
    assert np.abs(phi(ligament, 0 * ligament)).max() <= 1e-12
    # Insulated edges.
    height = 0.4 * scale
    for edge, inward in ((0.0, 1e-5), (1.0, -1e-5)):
        assert abs(phi(edge + inward, height) - phi(edge, height)) <= 1e-8
    # Far away the field is one.
    assert phi(0.3, 9.0 * scale) - phi(0.3, 8.0 * scale) == pytest.approx(scale, rel=1e-6)


@quick
@given(ratios, st.floats(0.05, 1.5), conductivities, conductivities)
def test_inverse_returns_the_crack(crack, probe, kx, ky):
    value = drop.johnson(crack, probe, kx, ky)
    if np.pi / 2 * probe * np.sqrt(kx / ky) > 6.0:
        return  # so far from the crack that the drop hardly knows it
    assert drop.crack_ratio_of(value, probe, kx, ky) == pytest.approx(crack, abs=1e-6)


def test_orthotropy_is_a_change_of_height():
    a = drop.johnson(0.4, 0.3, kx=4.0, ky=1.0)
    assert a == pytest.approx(float(drop.johnson(0.4, 0.6)), rel=1e-14)


def test_limits():
    assert drop.johnson(0.0, 0.3) == pytest.approx(1.0, abs=1e-14)
    assert drop.johnson(1e-9, 1e-8) == pytest.approx(np.hypot(1.0, 0.1), rel=1e-9)
    assert np.all(np.diff(drop.johnson(np.linspace(0, 0.95, 30), 0.2)) > 0)
    # arccosh(cosh(pi/4)/cos(pi/4))/(pi/4), the formula evaluated by hand at a/W = y/W = 1/2.
    expected = np.arccosh(np.cosh(np.pi / 4) * np.sqrt(2)) / (np.pi / 4)
    assert drop.johnson(0.5, 0.5) == pytest.approx(expected, rel=1e-14)


def test_one_per_cent_of_crack_is_seen():
    assert drop.johnson(0.505, 0.2) / drop.johnson(0.5, 0.2) - 1 > 1e-3


def test_tall_probes_do_not_overflow():
    # V(a)/V(0) = 1 - log cos(pi a / 2 W) / v for v = pi/2 y/W sqrt(kx/ky) >> 1
    for kx in (1e3, 1e6, 1e12):
        height = np.pi / 2 * np.sqrt(kx)
        expected = 1 - np.log(np.cos(np.pi / 4)) / height
        assert drop.johnson(0.5, 1.0, kx=kx) == pytest.approx(expected, rel=1e-15)
    assert drop.crack_ratio_of(drop.johnson(0.5, 1.0, kx=1e6), 1.0, kx=1e6) == pytest.approx(
        0.5, rel=1e-9
    )
    far = drop.strip_potential(0.3, 2000.0, 0.5, 1.0)
    assert far == pytest.approx(2000.0 - np.log(np.cos(np.pi / 4)) * 2 / np.pi, rel=1e-15)


def test_the_two_branches_meet():
    """At the height where the logarithm takes over, both forms give the same to rounding."""
    at = drop._TALL * 2 / np.pi
    low, high = (drop.johnson(0.7, at * f) * at * f for f in (1 - 1e-12, 1 + 1e-12))
    assert high - low == pytest.approx(2e-12 * at, abs=1e-13)


def test_bad_input_is_refused():
    with pytest.raises(ValueError, match="crack ratio"):
        drop.johnson(1.0, 0.2)
    with pytest.raises(ValueError, match="crack ratio"):
        drop.johnson(np.nan, 0.2)
    with pytest.raises(ValueError, match="one spot"):
        drop.johnson(0.5, 0.0)
    with pytest.raises(ValueError, match="conductivities"):
        drop.johnson(0.5, 0.2, kx=-1.0)
    with pytest.raises(ValueError, match="at least one"):
        drop.crack_ratio_of(0.9, 0.2)
    with pytest.raises(ValueError, match="outside the half strip"):
        drop.strip_potential(1.2, 0.1, 0.3, 1.0)
    with pytest.raises(ValueError, match="inside the strip"):
        drop.strip_potential(0.2, 0.1, 1.3, 1.0)
