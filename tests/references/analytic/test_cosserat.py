"""Cosserat strips: the energy's own equilibrium, a numerical solution, and the limits."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_bvp

from references.analytic.cosserat import Strip, shear_speed

moduli = st.tuples(*[st.floats(0.3, 3.0)] * 5)


def strip(values) -> Strip:
    c11, mu_c, c66, e1, e2 = values
    voigt = np.array([[c11 + 3.0, c66 - mu_c, 0], [c66 - mu_c, 6.5, 0], [0, 0, c66]])
    return Strip(voigt, (0.1 * e1, 0.1 * e2), 1.3)


def test_both_follow_from_the_energy():
    x, y, k, m, c, e, t, h = sp.symbols("x y k mu_c C66 E tau H", positive=True)
    u, q = sp.Function("u")(y), sp.Function("q")(y)
    density = c * u.diff(y) ** 2 / 2 + 2 * m * (-u.diff(y) / 2 - q) ** 2 + e * q.diff(y) ** 2 / 2
    stress = sp.diff(density, u.diff(y))
    couple = sp.diff(density, q.diff(y)).diff(y) - sp.diff(density, q)
    n, length = m / (c + m), sp.sqrt(e * (c + m) / (4 * c * m))
    turn = -t / (2 * c) * (1 - sp.cosh((y - h / 2) / length) / sp.cosh(h / 2 / length))
    slope = (t - 2 * m * turn) / (c + m)
    assert sp.simplify(stress.subs(u.diff(y), slope).subs(q, turn) - t) == 0
    left = couple.subs(q, turn).doit().subs(u.diff(y), slope)
    assert sp.simplify(left) == 0
    # Rotations of the walls vanish, and the slip is the integral of the slope.
    assert sp.simplify(turn.subs(y, 0)) == 0
    a = h / 2 / length
    turned = -t / (2 * c) * (y - length * sp.sinh((y - h / 2) / length) / sp.cosh(a))
    assert sp.simplify(turned.diff(y) - turn) == 0
    slip = (t * h - 2 * m * (turned.subs(y, h) - turned.subs(y, 0))) / (c + m)
    apparent = c / (1 - n * sp.tanh(a) / a)
    values = {m: 0.7, c: 1.1, e: 0.2, t: 1.3, h: 0.9}
    assert complex(slip.subs(values)) == pytest.approx(float((t * h / apparent).subs(values)))
    # Bending: no point turns against the displacement; the energy of a length is that of M k/2.
    young, nu, e1 = sp.symbols("Y nu E1", positive=True)
    u1, u2 = -k * x * y, k * (x**2 + nu * y**2) / 2
    turn = k * x
    assert sp.simplify((u2.diff(x) - u1.diff(y)) / 2 - turn) == 0
    assert u1.diff(y) + u2.diff(x) == 0
    density = young * u1.diff(x) ** 2 / 2 + e1 * turn.diff(x) ** 2 / 2
    moment = 2 * sp.integrate(density, (y, -h / 2, h / 2)) / k**2
    assert sp.simplify(moment - (young * h**3 / 12 + e1 * h)) == 0


@settings(deadline=None, max_examples=10)
@given(moduli)
def test_shear_against_a_numerical_solution(values):
    body = strip(values)
    c, m, e, h = body.shear, body.mu_c, body.bending[1], body.thickness

    def slopes(y, state):
        _, q, dq, tau = state
        du = (tau - 2 * m * q) / (c + m)
        return np.stack([du, dq, (2 * m * du + 4 * m * q) / e, np.zeros_like(tau)])

    grid = np.linspace(-h / 2, h / 2, 101)
    found = solve_bvp(
        slopes,
        lambda a, b: np.array([a[0], b[0] - 1.0, a[1], b[1]]),
        grid,
        np.stack([grid / h + 0.5, 0 * grid, 0 * grid, 0 * grid + c / h]),
        tol=1e-7,
        max_nodes=20_000,
    )
    assert found.success
    assert found.y[3, 0] * h == pytest.approx(body.apparent_shear, rel=1e-5)
    np.testing.assert_allclose(found.sol(grid)[1], body.rotation(grid), atol=1e-5)


@given(moduli)
def test_limits(values):
    body = strip(values)
    c, m = body.shear, body.mu_c
    thick = Strip(body.voigt, body.bending, 1e4 * body.length)
    thin = Strip(body.voigt, body.bending, 1e-4 * body.length)
    assert thick.apparent_shear == pytest.approx(c, rel=1e-3)
    assert thin.apparent_shear == pytest.approx(c + m, rel=1e-3)
    assert thick.bending_ratio > 1
    # Bound rotations: couple stress.
    bound = Strip(body.voigt, body.bending, body.thickness, cosserat=1e7 * c)
    assert bound.apparent_shear == pytest.approx(body.couple_stress_shear, rel=1e-4)
    assert body.apparent_shear < body.couple_stress_shear
    speeds = shear_speed(body.voigt, body.bending[0], [1e-6, 1e6])
    np.testing.assert_allclose(speeds, [c, c + m], rtol=1e-6)


def test_what_is_no_strip_is_refused():
    with pytest.raises(ValueError, match="must be positive"):
        Strip(np.array([[3.0, 2.0, 0], [2.0, 3.0, 0], [0, 0, 1.0]]), (1.0, 1.0))
    with pytest.raises(ValueError, match="orthotropic"):
        Strip(np.array([[3.0, 0.0, 0.2], [0.0, 3.0, 0], [0.2, 0, 1.0]]), (1.0, 1.0))
