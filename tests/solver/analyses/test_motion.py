"""Steps of a body in motion: what they conserve, damping, going on after a kill."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from solver import ElasticTensor, Scene, SceneError, Support, rectangle, waves
from solver.analyses import motion
from solver.geometry import Lattice
from solver.operators.assembled import to_csr
from solver.problem import Discretisation
from tests.solver.analyses.moving import DENSITY, square, whole_frequency
from tests.solver.bodies import FIG_7


@pytest.mark.parametrize("surface", ["volume", "extrapolated"])
@pytest.mark.parametrize("options", [{}, {"rotations": "inertia"}, {"scheme": "newmark"}])
def test_a_free_body_keeps_energy_and_momenta(surface, options):
    scene = square(16, surface=surface, region=rectangle(2.0, 1.5, angle=0.3))
    run = waves.run(
        scene,
        lambda x, y: 0.1 * np.stack([np.exp(-9 * (x * x + y * y)), x * y], -1),
        20.0,
        velocity=lambda x, y: np.stack([0.3 - y, x + 0.1], -1),
        **options,
    )
    assert run.statistics.drift < 1e-5
    momentum = run.ledger.momentum
    rounding = 1e-11 if options.get("scheme") != "newmark" else 1e-7
    np.testing.assert_allclose(
        momentum, np.tile(momentum[0], (len(momentum), 1)), atol=rounding * abs(momentum).max()
    )
    # An area of inertia ρ ∫ r² of the rectangle, about its centre.
    wanted = DENSITY * 2.0 * 1.5 * (4.0 + 2.25) / 12
    # Strips act where their particles are, (Δx/height)² nearer; treatments other than
    # `extrapolated` let the body end at its outermost cells.
    share = (0.125 / 1.5) ** 2 if surface == "extrapolated" else 5e-2
    assert momentum[0, 2] == pytest.approx(wanted, rel=share)


@pytest.mark.parametrize("count", [1000, pytest.param(10_000, marks=pytest.mark.slow)])
def test_many_steps_at_nine_tenths_of_the_stable_one(count):
    """A free body that spins, drifts and shakes: asked for are 1e-3 of its energy, and rounding."""
    scene = square(12, m=2)
    short = waves.run(scene, 0.0, 1.0)
    step = 0.9 * short.statistics.stable_step
    run = waves.run(
        scene,
        lambda x, y: np.stack([np.exp(-9 * (x * x + y * y)), 0 * x], -1),
        count * step,
        velocity=lambda x, y: 1e-3 * np.stack([2 - y, x - 1], -1),
        step=step,
    )
    assert run.statistics.steps == count
    assert run.statistics.drift < 1e-4
    energy = run.ledger.energy[1:]
    assert np.ptp(energy) < 1e-4 * energy.mean()
    momentum = run.ledger.momentum
    assert abs(momentum[0]).min() > 1e-3
    # What a rounding of every displacement at each step could add up to, all of one sign.
    rounding = np.finfo(float).eps * count * 4 * np.abs(run.displacement).max() * DENSITY * 4 / step
    assert rounding < 1e-5 * abs(momentum[0]).min()
    assert np.abs(momentum - momentum[0]).max() < rounding


@pytest.mark.parametrize("surface", ["volume", "extrapolated"])
def test_the_stable_step_is_the_bodys_own(surface):
    """Within it no motion grows, five per cent beyond it one does."""
    scene = square(14, surface=surface, region=rectangle(2.0, 1.4, angle=0.3), m=2)
    stable = waves.run(scene, 0.0, 1e-3).statistics.stable_step
    count = Lattice(scene.region, scene.spacing, 2).count
    start = np.random.default_rng(0).standard_normal((count, 2))
    held = waves.run(scene, start, 400 * stable, step=stable)
    assert held.ledger.energy[1:].max() < 1.001 * held.ledger.energy[1]
    with pytest.raises(SceneError, match=r"beyond the stable one of this body, [\d.e-]+ s"):
        waves.run(scene, start, 1.0, step=1.01 * stable)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(motion, "stable_step", lambda *_: 1.06 * stable)
        grown = waves.run(scene, start, 200 * stable, step=1.05 * stable)
    assert grown.ledger.kinetic[-1] > 1e6 * held.ledger.energy[1]


@pytest.mark.parametrize("scheme", ["verlet", "newmark"])
@pytest.mark.parametrize(("alpha", "beta"), [(0.4, 0.0), (0.0, 0.02), (0.3, 0.01)])
def test_rayleigh_damping_of_a_plane_wave(alpha, beta, scheme):
    """Decay of one wave by (α + β ω²)/2, against the undamped amplitude, in the middle."""
    scene = square(60)
    k = 2 * np.pi / (20 * scene.spacing) * np.array([1.0, 0.0])
    frequency, d = whole_frequency(scene, k, 1e-9, 1)

    def shape(x, y):
        return np.multiply.outer(np.cos(k[0] * x), d.real)

    fastest = np.sqrt(np.linalg.eigvalsh(FIG_7)[-1] / DENSITY)
    run = waves.run(
        scene,
        shape,
        0.75 / fastest,
        damping=(alpha, beta),
        step=0.02,
        scheme=scheme,
        probes=[(0.0, 0.0)],
    )
    signal, t = run.history.values[:, :, 0] @ d.real, run.history.times
    rate = 0.5 * (alpha + beta * frequency**2)
    damped = np.sqrt(frequency**2 - rate**2)
    wanted = np.exp(-rate * t) * (np.cos(damped * t) + rate / damped * np.sin(damped * t))
    wanted *= shape(*run.points[run.history.particles[0]]) @ d.real
    assert np.abs(signal - wanted).max() < 0.02 * np.abs(wanted).max()
    undamped = np.abs(np.cos(frequency * t) * wanted[0] - signal).max()
    assert undamped > 5 * np.abs(signal - wanted).max()
    assert run.ledger.dissipated[-1] > 0


def marched_densely(scene, motion_of, rate_of, alpha, beta, end):
    """u at the end by the matrices of the body without supports, Kelvin's damping among them."""
    free = Discretisation.of(replace(scene, supports=[]), free=True)
    held = Discretisation.of(scene.at(0.0)).prescribed
    stiffness = to_csr(free.operator).toarray()
    turning = np.zeros_like(held)
    turning[2] = ~held[2]
    u, r, p = (np.flatnonzero(a) for a in (~held & ~turning, turning, held))
    follow = -np.linalg.solve(stiffness[np.ix_(r, r)], stiffness[np.ix_(r, np.r_[u, p])])
    rows = stiffness[np.ix_(u, np.r_[u, p])] + stiffness[np.ix_(u, r)] @ follow
    mass = np.tile(scene.density * free.volumes, 2)[u]

    def slope(t, state):
        x, v = np.split(state, 2)
        given, moves = (f(t, *free.lattice.points.T)[held] for f in (motion_of, rate_of))
        force = rows @ np.r_[x + beta * v, given + beta * moves]
        return np.r_[v, -force / mass - alpha * v]

    start = np.zeros(2 * len(u))
    found = solve_ivp(slope, (0.0, end), start, "DOP853", rtol=1e-9, atol=1e-12)
    field = motion_of(end, *free.lattice.points.T)
    field[~held & ~turning] = found.y[: len(u), -1]
    return field[:2].T


@pytest.mark.parametrize(("scheme", "order"), [("verlet", 0.9), ("newmark", 1.7)])
def test_supports_that_move_are_damped_as_the_body_is(scheme, order):
    alpha, beta, end = 0.2, 0.05, 1.2

    def moved(t, x, y):
        return np.stack([np.sin(3 * t) ** 2 * (1 + y), 0 * x, 0 * x])

    def rate(t, x, y):
        return np.stack([3 * np.sin(6 * t) * (1 + y), 0 * x, 0 * x])

    left = lambda x, y: x < -0.3  # noqa: E731
    scene = Scene(
        region=rectangle(1.0, 0.8),
        spacing=0.1,
        m=2,
        material=ElasticTensor.isotropic(1.0, 0.2),
        density=1.5,
        surface="none",  # treatments of edges ask what is held
        supports=[
            Support.where(left, u1=lambda x, y, t: moved(t, x, y)[0], u2=0.0, rotation=0.0),
            Support.where(lambda x, y: x > 0.4, u2=0.0),
        ],
    )
    exact = marched_densely(scene, moved, rate, alpha, beta, end)
    without = marched_densely(scene, moved, lambda *a: 0 * rate(*a), alpha, beta, end)

    def errors(step):
        options = {"damping": (alpha, beta), "scheme": scheme, "step": step}
        run = waves.run(scene, 0.0, end, **options)
        return np.abs(run.displacement[-1] - exact).max() / np.abs(exact).max()

    coarse, fine = errors(0.02), errors(0.01)
    assert np.log2(coarse / fine) > order
    assert fine < 0.02
    assert np.abs(without - exact).max() > 5 * fine * np.abs(exact).max()


class Killed(Exception):
    """Stands for a signal."""


def killer(after):
    calls = []

    def progress(share):
        calls.append(share)
        if len(calls) == after:
            raise Killed

    return progress


@pytest.mark.parametrize(
    ("options", "surface"),
    [
        ({}, "extrapolated"),
        ({"rotations": "inertia"}, "volume"),
        ({"scheme": "newmark", "step": 0.02}, "volume"),
    ],
)
def test_a_killed_run_goes_on_bit_for_bit(tmp_path, options, surface):
    scene = square(
        16,
        m=2,
        surface=surface,
        supports=[
            Support.where(
                lambda x, y: x < -0.8,
                displacement=lambda x, y, t: np.stack([np.sin(9 * t) + 0 * x, 0 * x], -1),
            ),
            Support.where(lambda x, y: y > 0.9, u2=0.0),
        ],
    )
    arguments = scene, lambda x, y: 0.1 * np.stack([x * y, x], -1), 1.0
    options = options | {"times": [0.0, 0.333, 0.7, 1.0], "probes": [(0.2, 0.3)]}
    whole = waves.run(*arguments, series=tmp_path / "whole", **options)
    state = tmp_path / "state.npz"
    parts = options | {"checkpoint": state, "every": 7, "series": tmp_path / "part"}
    after = int(0.6 * whole.statistics.steps)
    with pytest.raises(Killed):
        waves.run(*arguments, progress=killer(after), **parts)
    found = waves.run(*arguments, **parts)
    for name in ("displacement", "velocity", "rotation"):
        np.testing.assert_array_equal(getattr(found, name), getattr(whole, name))
    np.testing.assert_array_equal(found.history.values, whole.history.values)
    np.testing.assert_array_equal(found.ledger.energy, whole.ledger.energy)
    assert found.statistics.products == whole.statistics.products
    for k in range(4):
        a, b = (tmp_path / f"{stem}_{k:05d}.vtu" for stem in ("whole", "part"))
        assert a.read_bytes() == b.read_bytes()
    again = waves.run(*arguments, progress=killer(1), **parts)
    np.testing.assert_array_equal(again.displacement, whole.displacement)
    with pytest.raises(SceneError, match="belongs to another"):
        waves.run(arguments[0], 0.0, 1.0, **parts)


def test_fields_between_steps_are_interpolated():
    scene = square(16, m=2)
    start = lambda x, y: np.stack([np.exp(-4 * (x * x + y * y)), 0 * x], -1)  # noqa: E731
    fine = waves.run(scene, start, 1.0, step=0.002, times=[0.5137])
    coarse = waves.run(scene, start, 1.0, times=[0.5137], step=0.03)
    size = np.abs(fine.displacement).max()
    assert np.abs(coarse.displacement - fine.displacement).max() < 4e-3 * size
    assert np.abs(coarse.velocity - fine.velocity).max() < 2e-2 * np.abs(fine.velocity).max()
    assert set(fine.fields()) == {"displacement", "velocity", "rotation"}
    assert fine.summary()["steps"] == 500
