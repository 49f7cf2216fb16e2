"""Motion of elastic bodies in time: exact solutions."""

import numpy as np
import pytest

from references.fem.body import Acting, Body, of_solids
from references.fem.motion import moved
from references.fem.polygons import polygons

SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
VOIGT = np.array([[2.0, 0.4, 0.2], [0.4, 1.0, 0.1], [0.2, 0.1, 0.5]])
POINTS = np.array([[0.21, 0.33], [0.77, 0.5], [0.5, 0.9]])
SLOPE = np.array([[0.3, -0.1], [0.2, 0.5]])


def square(size, voigt=VOIGT, density=1.5):
    mesh = polygons([(SQUARE, [])], size)
    body = Body(mesh, 2, np.zeros(len(mesh.triangles), dtype=np.int64))
    return body, body.stiffness(of_solids(voigt[None])), body.mass([density])


@pytest.mark.parametrize("damping", [(0.0, 0.0), (0.4, 0.1)])
def test_what_is_quadratic_in_time_and_linear_in_space_is_exact(damping):
    """u = (1 + t)² A x, its edges held: ρ ü + α ρ u̇ acts in the volume; stresses are even."""
    body, stiffness, mass = square(0.5)

    def held(t):
        return body.held(lambda n, e: np.where(e[:, None], (1 + t) ** 2 * n @ SLOPE.T, np.nan))

    def load(t):
        force = 1.5 * (2.0 + damping[0] * 2 * (1 + t))
        return body.load(Acting(volume=[lambda x, y: force * np.tensordot(SLOPE, [x, y], 1)]))

    first, speed = (
        body.nodal(lambda x, y, a=a: a * np.tensordot(SLOPE, [x, y], 1)) for a in (1.0, 2.0)
    )
    times = [0.0, 0.13, 0.3, 0.7]
    found = moved(
        body, stiffness, mass, damping, (first, speed), held, load, times, step=0.1
    )  # fmt: skip
    for t, (u, v) in zip(times, found, strict=True):
        np.testing.assert_allclose(u.at(POINTS), (1 + t) ** 2 * POINTS @ SLOPE.T, rtol=1e-8)
        np.testing.assert_allclose(v.at(POINTS), 2 * (1 + t) * POINTS @ SLOPE.T, rtol=1e-6)


def test_a_standing_wave_and_twice_the_steps_err_a_quarter():
    """u₁ = sin(πx/2) cos ωt, ω = π/2 √(E/ρ), of a bar without contraction; and its damping."""
    body, stiffness, mass = square(0.2, np.diag([2.0, 1.0, 0.5]))
    omega = 0.5 * np.pi * np.sqrt(2.0 / 1.5)

    def given(nodes, edge):
        values = np.full((len(nodes), 2), np.nan)
        values[:, 1] = 0.0
        values[nodes[:, 0] < 1e-9, 0] = 0.0
        return values

    still, values = np.zeros(body.basis.N), body.held(given)
    bend = body.nodal(lambda x, y: np.stack([np.sin(0.5 * np.pi * x), 0 * x]))
    end = 0.8 * np.pi / omega
    for beta in (0.0, 0.1):
        # ü + β ω² u̇ + ω² u = 0.
        decay = 0.5 * beta * omega**2
        turn = np.sqrt(omega**2 - decay**2)
        swing = np.cos(turn * end) + decay / turn * np.sin(turn * end)
        wanted = np.exp(-decay * end) * swing * np.sin(0.5 * np.pi * POINTS[:, 0])
        errors = []
        for steps in (8, 16):
            ((u, _),) = moved(
                body, stiffness, mass, (0.0, beta), (bend, still), lambda t: values,
                lambda t: still, [end], end / steps,
            )  # fmt: skip
            errors.append(np.abs(u.at(POINTS)[:, 0] - wanted).max())
        assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.25)
        assert errors[1] < 0.02
