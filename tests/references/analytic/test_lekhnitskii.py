"""Crack-tip fields: the identities that make them the solution, for any tensor."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from references.analytic import lekhnitskii as lek
from references.analytic.voigt import isotropic_voigt, strain_of_gradient, turned_axes
from tests.references.analytic.tensors import random_voigt

PAPER = np.array([[1.0, 1 / 5, 1 / 10], [1 / 5, 4 / 5, 1 / 6], [1 / 10, 1 / 6, 1 / 3]])
SILICON = np.array([[141.1, 39.3, 0.0], [39.3, 141.1, 0.0], [0.0, 0.0, 79.6]])
ANGLES = np.linspace(-3.1, 3.1, 17)
quick = settings(deadline=None, max_examples=40, derandomize=True)


def mixities():
    return st.floats(-1.5, 1.5)


def central(function, h):
    """Eighth-order central difference at zero."""
    weights = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}
    return sum(w * (function(k * h) - function(-k * h)) for k, w in weights.items()) / h


@quick
@given(random_voigt())
def test_roots_solve_the_characteristic_equation(voigt):
    s = np.linalg.inv(voigt)
    mu = lek.characteristic_roots(voigt)
    terms = np.array(
        [
            s[0, 0] * mu**4,
            -2 * s[0, 2] * mu**3,
            (2 * s[0, 1] + s[2, 2]) * mu**2,
            -2 * s[1, 2] * mu,
            s[1, 1] + 0 * mu,
        ]
    )
    assert np.all(np.abs(terms.sum(axis=0)) <= 1e-12 * np.abs(terms).sum(axis=0))
    assert np.all(mu.imag > 0)


@quick
@given(random_voigt(), mixities())
def test_equilibrium_hooke_and_gradient(voigt, alpha):
    KI, KII = np.cos(alpha), np.sin(alpha)
    x, y = np.cos(ANGLES), np.sin(ANGLES)
    h = 2e-3
    gradient = lek.crack_tip_gradient(voigt, x, y, KI, KII)
    stress = lek.crack_tip_stress(voigt, x, y, KI, KII)
    size = np.abs(stress).max()
    assert np.abs(strain_of_gradient(gradient) @ voigt - stress).max() <= 1e-11 * size

    by_x = central(lambda d: lek.crack_tip_displacement(voigt, x + d, y, KI, KII), h)
    by_y = central(lambda d: lek.crack_tip_displacement(voigt, x, y + d, KI, KII), h)
    numeric = np.stack([by_x, by_y], axis=-1)
    assert np.abs(numeric - gradient).max() <= 1e-8 * np.abs(gradient).max()

    sx = central(lambda d: lek.crack_tip_stress(voigt, x + d, y, KI, KII), h)
    sy = central(lambda d: lek.crack_tip_stress(voigt, x, y + d, KI, KII), h)
    residual = np.stack([sx[:, 0] + sy[:, 2], sx[:, 2] + sy[:, 1]])
    assert np.abs(residual).max() <= 1e-8 * max(np.abs(sx).max(), np.abs(sy).max())


@quick
@given(random_voigt(), mixities())
def test_faces_are_free_and_the_plane_ahead_carries_K(voigt, alpha):
    KI, KII = np.cos(alpha), np.sin(alpha)
    r = np.array([0.3, 1.0, 4.0])
    ahead = lek.crack_tip_stress(voigt, r, 0 * r, KI, KII)
    assert ahead[:, 1] == pytest.approx(KI / np.sqrt(2 * np.pi * r), rel=1e-12, abs=1e-13)
    assert ahead[:, 2] == pytest.approx(KII / np.sqrt(2 * np.pi * r), rel=1e-12, abs=1e-13)
    for face in ("upper", "lower"):
        stress = lek.crack_tip_stress(voigt, -r, 0 * r, KI, KII, face=face)
        assert np.abs(stress[:, 1:]).max() <= 1e-12 * np.abs(stress).max() + 1e-14


@quick
@given(random_voigt(), mixities())
def test_energy_release_rate_is_the_closure_work(voigt, alpha):
    """Irwin: G = lim 1/(2 a) int_0^a sigma_2i(r, ahead) [u_i](a - r, behind) dr."""
    KI, KII = np.cos(alpha), np.sin(alpha)
    node, weight = np.polynomial.legendre.leggauss(8)
    phi, w = np.pi / 4 * (node + 1), np.pi / 4 * weight
    r = np.sin(phi) ** 2  # absorbs both square roots; a = 1
    traction = lek.crack_tip_stress(voigt, r, 0 * r, KI, KII)[:, [2, 1]]
    behind = r - 1.0
    jump = lek.crack_tip_displacement(
        voigt, behind, 0 * r, KI, KII, face="upper"
    ) - lek.crack_tip_displacement(voigt, behind, 0 * r, KI, KII, face="lower")
    work = 0.5 * np.sum(w * 2 * np.sin(phi) * np.cos(phi) * np.sum(traction * jump, axis=1))
    assert lek.energy_release_rate(voigt, KI, KII) == pytest.approx(work, rel=1e-10)
    assert work > 0


@quick
@given(random_voigt(), st.floats(-3.0, 3.0), mixities())
def test_energy_release_rate_turns_with_the_body(voigt, angle, alpha):
    KI, KII = np.cos(alpha), np.sin(alpha)
    crack_axes = lek.energy_release_rate(voigt, KI, KII)
    turned = lek.energy_release_rate(turned_axes(voigt, -angle), KI, KII, angle=angle)
    assert turned == pytest.approx(crack_axes, rel=1e-10)


@quick
@given(random_voigt(), mixities())
def test_rotating_the_body_by_half_a_turn_leaves_the_field(voigt, alpha):
    """C is even under a half turn, so the field in turned axes is the turned field."""
    again = turned_axes(voigt, np.pi)
    x, y = np.cos(ANGLES), np.sin(ANGLES)
    one = lek.crack_tip_displacement(voigt, x, y, np.cos(alpha), np.sin(alpha))
    two = lek.crack_tip_displacement(again, x, y, np.cos(alpha), np.sin(alpha))
    assert np.abs(one - two).max() <= 1e-11 * np.abs(one).max()


@pytest.mark.parametrize("plane", ["stress", "strain"])
@pytest.mark.parametrize("nu", [-0.4, 0.0, 0.3, 0.49])
def test_isotropic_body_gives_the_textbook_field(plane, nu):
    """Williams' leading terms, e.g. T. L. Anderson, Fracture Mechanics, Tables 2.1 and 2.2."""
    E, KI, KII = 210.0, 1.3, -0.7
    voigt = isotropic_voigt(E, nu, plane)
    G = E / (2 * (1 + nu))
    kappa = 3 - 4 * nu if plane == "strain" else (3 - nu) / (1 + nu)
    r, t = 0.7, ANGLES
    c, s, c3, s3 = np.cos(t / 2), np.sin(t / 2), np.cos(1.5 * t), np.sin(1.5 * t)
    u1 = KI * c * (kappa - 1 + 2 * s**2) + KII * s * (kappa + 1 + 2 * c**2)
    u2 = KI * s * (kappa + 1 - 2 * c**2) - KII * c * (kappa - 1 - 2 * s**2)
    expected = np.stack([u1, u2], axis=-1) * np.sqrt(r / (2 * np.pi)) / (2 * G)
    x, y = r * np.cos(t), r * np.sin(t)
    got = lek.crack_tip_displacement(voigt, x, y, KI, KII)
    assert np.abs(got - expected).max() <= 1e-13 * np.abs(expected).max()

    stress = np.stack(
        [
            KI * c * (1 - s * s3) - KII * s * (2 + c * c3),
            KI * c * (1 + s * s3) + KII * s * c * c3,
            KI * s * c * c3 + KII * c * (1 - s * s3),
        ],
        axis=-1,
    ) / np.sqrt(2 * np.pi * r)
    computed = lek.crack_tip_stress(voigt, x, y, KI, KII)
    assert np.abs(computed - stress).max() <= 1e-13 * np.abs(stress).max()

    modulus = E if plane == "stress" else E / (1 - nu**2)
    G_textbook = (KI**2 + KII**2) / modulus
    assert lek.energy_release_rate(voigt, KI, KII) == pytest.approx(G_textbook, rel=1e-13)


@pytest.mark.parametrize("power", range(1, 16))
def test_nearly_equal_roots_lose_no_digits(power):
    """Against 60-digit arithmetic with the textbook form and its 1/(mu1 - mu2)."""
    mpmath = pytest.importorskip("mpmath")
    voigt = isotropic_voigt(1.0, 0.3)
    voigt[0, 0] += 10.0**-power
    voigt[0, 2] = voigt[2, 0] = 3.0 * 10.0**-power
    x, y, KI, KII = -0.8, 0.55, 0.9, 0.4
    with mpmath.workdps(60):
        s = mpmath.inverse(mpmath.matrix(voigt.tolist()))
        quartic = [s[0, 0], -2 * s[0, 2], 2 * s[0, 1] + s[2, 2], -2 * s[1, 2], s[1, 1]]
        roots = mpmath.polyroots(quartic, maxsteps=500, extraprec=400)
        m1, m2 = (m for m in roots if m.imag > 0)
        exact = np.array([complex(m1), complex(m2)])
        r1, r2 = mpmath.sqrt(x + m1 * y), mpmath.sqrt(x + m2 * y)
        expected = []
        for f in (
            lambda m: s[0, 0] * m**2 + s[0, 1] - s[0, 2] * m,
            lambda m: s[0, 1] * m + s[1, 1] / m - s[1, 2],
        ):
            one = (m1 * f(m2) * r2 - m2 * f(m1) * r1) / (m1 - m2)
            two = (f(m2) * r2 - f(m1) * r1) / (m1 - m2)
            expected.append(float(mpmath.sqrt(2 / mpmath.pi) * (KI * one + KII * two).real))
    got = lek.crack_tip_displacement(voigt, x, y, KI, KII)
    assert np.abs(got - expected).max() <= 1e-14 * np.abs(expected).max()
    # A single root of a nearly double pair is known to the square root of rounding.
    mu = lek.characteristic_roots(voigt)
    best = min(np.abs(mu - exact).max(), np.abs(mu - exact[::-1]).max())
    assert best <= 5e-8
    total, product = lek.characteristic_factor(voigt)
    assert abs(total - exact.sum()) <= 1e-14
    assert abs(product - exact.prod()) <= 1e-14


def test_rotation_is_half_the_curl():
    gradient = lek.crack_tip_gradient(PAPER, 0.3, -0.4, 1.0, 0.5)
    rotation = lek.crack_tip_rotation(PAPER, 0.3, -0.4, 1.0, 0.5)
    assert rotation == pytest.approx(0.5 * (gradient[1, 0] - gradient[0, 1]), rel=1e-14)


def test_signed_zero_tells_the_faces_apart():
    up = lek.crack_tip_displacement(PAPER, -1.0, 0.0, 1.0, 0.0)
    down = lek.crack_tip_displacement(PAPER, -1.0, -0.0, 1.0, 0.0)
    assert up[1] > 0 > down[1]
    assert lek.crack_tip_displacement(PAPER, -1.0, 0.0, 1.0, 0.0, face="lower") == pytest.approx(
        down, rel=1e-15
    )


def test_shapes_broadcast():
    u = lek.crack_tip_displacement(SILICON, np.ones((4, 1)), np.ones(3), 1.0, 0.0)
    assert u.shape == (4, 3, 2)
    assert lek.crack_tip_stress(SILICON, 1.0, 2.0, 1.0, 0.0).shape == (3,)
    assert lek.crack_tip_displacement(SILICON, 0.0, 0.0, 1.0, 1.0) == pytest.approx([0, 0], abs=0)


def test_one_per_cent_in_a_modulus_is_seen():
    right = lek.crack_tip_displacement(PAPER, 0.3, 0.4, 1.0, 0.0)
    wrong = PAPER.copy()
    wrong[1, 1] *= 1.01
    off = lek.crack_tip_displacement(wrong, 0.3, 0.4, 1.0, 0.0)
    assert np.linalg.norm(off - right) / np.linalg.norm(right) > 1e-3


def test_bad_input_is_refused():
    with pytest.raises(ValueError, match="positive definite"):
        lek.characteristic_roots([[1, 2, 0], [2, 1, 0], [0, 0, 1]])
    with pytest.raises(ValueError, match="NaN"):
        lek.characteristic_roots([[1, np.nan, 0], [np.nan, 1, 0], [0, 0, 1]])
    with pytest.raises(ValueError, match="not symmetric"):
        lek.characteristic_roots([[1, 0.2, 0], [0.1, 1, 0], [0, 0, 1]])
    with pytest.raises(ValueError, match="3x3"):
        lek.characteristic_roots(np.eye(2))
    with pytest.raises(ValueError, match="crack tip"):
        lek.crack_tip_stress(PAPER, [0.0, 1.0], 0.0, 1.0, 0.0)
    with pytest.raises(ValueError, match="coordinate"):
        lek.crack_tip_displacement(PAPER, np.nan, 0.0, 1.0, 0.0)
    with pytest.raises(ValueError, match="face"):
        lek.crack_tip_displacement(PAPER, 1.0, 0.0, 1.0, 0.0, face="left")
