"""Heat, and motion with heat, in time: exact solutions."""

import numpy as np
import pytest

from references.fem.body import Acting, Body, of_solids
from references.fem.in_time import Start, moved_and_warmed, warmed
from references.fem.polygons import polygons

SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
D = np.array([[2.0, 0.5], [0.5, 1.0]])
POINTS = np.array([[0.21, 0.33], [0.77, 0.5], [0.5, 0.9]])


def bodies(size, *components):
    mesh = polygons([(SQUARE, [])], size)
    return [Body(mesh, c, np.zeros(len(mesh.triangles), dtype=np.int64)) for c in components]


def test_what_is_linear_in_time_is_exact():
    """T = (1 + t)(x² + x y), held at the edges: s = c (x² + x y) − (1 + t)(2 D11 + 2 D12)."""
    (body,) = bodies(0.4, 1)

    def held(t):
        return body.held(
            lambda n, e: np.where(e, (1 + t) * (n[:, 0] ** 2 + n[:, 0] * n[:, 1]), np.nan)[:, None]
        )

    def load(t):
        source = lambda x, y: 3.0 * (x**2 + x * y) - (1 + t) * (2 * 2.0 + 2 * 0.5)  # noqa: E731
        return body.load(Acting(volume=[source]))

    initial = body.nodal(lambda x, y: x**2 + x * y)
    found = warmed(body, of_solids(D[None]), [3.0], initial, held, load, [0.0, 0.2, 0.7], steps=2)
    x, y = POINTS.T
    for field, t in zip(found, (0.0, 0.2, 0.7), strict=True):
        np.testing.assert_allclose(field.at(POINTS), (1 + t) * (x**2 + x * y), rtol=1e-10)


def test_a_mode_decays_at_its_rate_and_twice_the_steps_err_a_quarter():
    """T = cos πx exp(−2 π² t/3), insulated."""
    (body,) = bodies(0.15, 1)
    free = np.full(body.basis.N, np.nan)
    initial, silent = body.nodal(lambda x, y: np.cos(np.pi * x)), np.zeros(body.basis.N)
    wanted = np.cos(np.pi * POINTS[:, 0]) * np.exp(-2 * np.pi**2 * 0.3 / 3)
    given = body, of_solids(np.diag([2.0, 1.0])[None]), [3.0], initial, lambda t: free
    errors = [
        np.abs(warmed(*given, lambda t: silent, [0.3], steps=n)[0].at(POINTS) - wanted).max()
        for n in (1, 2, 4)
    ]
    assert errors[2] < 2e-3
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.25)


def test_a_bar_that_no_heat_leaves_is_stiffer():
    """u = sin(πx/2) cos ωt, ω² = (π/2)² (E + T₀ β²/C)/ρ, ϑ = −T₀ β u'/C, σ = 0 at x = 1."""
    body, heat = bodies(0.15, 2, 1)
    young, beta, reference, capacity = 1.0, 0.6, 2.0, 1.5
    omega = 0.5 * np.pi * np.sqrt(young + reference * beta**2 / capacity)

    def held(nodes, edge):
        given = np.full((len(nodes), 2), np.nan)
        given[:, 1] = 0.0
        given[nodes[:, 0] < 1e-9, 0] = 0.0
        return given

    time, errors = 0.3 * np.pi / omega, []
    bend = body.nodal(lambda x, y: np.stack([np.sin(0.5 * np.pi * x), 0 * x]))
    cold = heat.nodal(lambda x, y: -reference * beta / capacity * 0.5 * np.pi
                      * np.cos(0.5 * np.pi * x))  # fmt: skip
    start = Start(bend, np.zeros(body.basis.N), cold)
    stress = lambda x, y, s: np.multiply.outer([beta, 0.0, 0.0], np.ones(x.shape))  # noqa: E731
    for steps in (4, 8):
        u, t = moved_and_warmed(
            body, heat,
            body.stiffness(of_solids(np.diag([young, 1.0, 0.5])[None])), body.mass([1.0]),
            heat.stiffness(of_solids(np.zeros((1, 2, 2)))), heat.mass([capacity]),
            body.coupling(heat, stress),
            (body.held(held), np.full(heat.basis.N, np.nan)),
            (np.zeros(body.basis.N), np.zeros(heat.basis.N)),
            reference, start, time / steps, steps,
        )  # fmt: skip
        wanted = np.sin(0.5 * np.pi * POINTS[:, 0]) * np.cos(omega * time)
        errors.append(np.abs(u.at(POINTS)[:, 0] - wanted).max())
        warm = (-reference * beta / capacity * 0.5 * np.pi * np.cos(omega * time)
                * np.cos(0.5 * np.pi * POINTS[:, 0]))  # fmt: skip
        assert np.abs(t.at(POINTS) - warm).max() < 0.05
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.25)
    assert errors[1] < 5e-3
