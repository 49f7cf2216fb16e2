"""Rigid pins and equal unknowns, against dense elimination of the very same equations."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import (
    ConductivityTensor,
    Crack,
    ElasticTensor,
    Load,
    Scene,
    SceneError,
    Support,
    disc,
    fracture,
    rectangle,
)
from solver.errors import MechanismError
from solver.operators import BondOperator
from solver.operators.assembled import to_csr
from solver.reactions import reaction, residual
from tests.solver.bodies import few

STIFF = ElasticTensor([[3.0, 0.8, 0.2], [0.8, 2.0, 0.1], [0.2, 0.1, 1.1]])
LOW, HIGH = disc(1.8, (0.0, -6.0)), disc(1.8, (0.3, 6.0))


def pinned(material=STIFF, surface="volume", n=9, **motion):
    """A plate on two pins that turn; the upper one is moved."""
    motion = motion or {"displacement": (0.1, 0.4)}
    return Scene(
        rectangle(n, 18), 1.0, material, m=2, surface=surface,
        supports=[Support.pin(LOW, displacement=(0.0, 0.0)), Support.pin(HIGH, **motion)],
        loads=[Load.body_force((0.01, -0.02), where=lambda x, y: x > 1)],
    )  # fmt: skip


def dense(scene):
    """The same by elimination of all unknowns from the assembled matrix."""
    parts = scene.discretise(constrained=True)
    open_to = parts.prescribed & ~parts.constraints.slaves
    whole = BondOperator(parts.bonds, parts.moduli, open_to)
    assert not open_to.any()
    matrix = to_csr(whole).toarray()
    if whole.ended_stiffness is not None:
        matrix = np.column_stack([whole.matvec(e) for e in np.eye(whole.shape[0])])
    free = np.diag((~parts.constraints.slaves.ravel()).astype(float))
    T = np.column_stack([free[:, free.any(axis=0)], parts.constraints.basis.toarray()])
    given = np.where(parts.constraints.slaves, parts.values, 0.0).ravel()
    right = T.T @ (parts.load.ravel() - matrix @ given)
    reduced = T.T @ matrix @ T
    return (given + T @ np.linalg.solve(reduced, right)).reshape(parts.load.shape)


@few
@given(
    st.sampled_from(["none", "volume", "extrapolated"]),
    st.sampled_from([STIFF, *(ElasticTensor.isotropic(1.0, nu) for nu in (1 / 3, 0.4))]),
    st.sampled_from(
        [{"displacement": (0.1, 0.4)}, {"u1": 0.3}, {"u2": 0.2, "rotation": 0.05}]
    ),
)  # fmt: skip
def test_pins_are_exact_elimination(surface, material, motion):
    scene = pinned(material, surface, **motion)
    solution = scene.solve(tolerance=1e-10)
    exact = dense(scene)
    np.testing.assert_allclose(solution.unknowns, exact, rtol=0, atol=1e-7 * np.abs(exact).max())


@pytest.mark.parametrize("n", [9, 70])
@pytest.mark.parametrize("surface", ["volume", "extrapolated"])
def test_a_pin_is_rigid_and_bears_no_moment_where_it_turns(surface, n):
    scene = pinned(surface=surface, n=n)
    solution = scene.solve(tolerance=1e-11)
    chosen = np.hypot(solution.points[:, 0] - 0.3, solution.points[:, 1] - 6.0) < 1.8
    x, y = (solution.points[chosen] - solution.points[chosen].mean(axis=0)).T
    turn = solution.rotation[chosen]
    np.testing.assert_allclose(turn, turn[0], rtol=1e-12)
    assert abs(turn[0]) > 1e-4
    np.testing.assert_allclose(
        solution.displacement[chosen], np.stack([0.1 - turn * y, 0.4 + turn * x], axis=-1)
    )
    up, down = reaction(solution, HIGH), reaction(solution, LOW)
    scale = np.abs(up.force).max()
    assert abs(up.moment) <= 1e-8 * scale
    assert abs(down.moment) <= 1e-8 * scale
    # Supports and loads balance, and nothing else is held.
    load = solution.discretisation.load.sum(axis=1)[:2]
    np.testing.assert_allclose(up.force + down.force + load, 0.0, atol=1e-8 * scale)
    left = residual(solution.discretisation, solution.unknowns)
    left[:, solution.prescribed] = 0.0
    assert np.abs(left).max() <= 1e-8 * scale
    # Held against turning it bears one.
    stiff = pinned(surface=surface, displacement=(0.1, 0.4), rotation=0.0).solve()
    assert abs(reaction(stiff, HIGH).moment) > 1e-3 * np.abs(reaction(stiff, HIGH).force).max()


def test_a_border_costs_no_iterations():
    free = pinned(n=70).solve()
    clamped = pinned(n=70, displacement=(0.1, 0.4), rotation=0.0)
    fixed = Scene(
        clamped.region, 1.0, STIFF, m=2, loads=clamped.loads,
        supports=[
            Support.where(LOW, displacement=(0.0, 0.0), rotation=0.0),
            Support.where(HIGH, displacement=(0.1, 0.4), rotation=0.0),
        ],
    ).solve()  # fmt: skip
    assert free.statistics.iterations <= fixed.statistics.iterations + 4


def test_an_edge_that_stays_level():
    top = rectangle(12, 1, (0.0, 5.5))
    pull = Load.body_force((0.0, 1.0), where=lambda x, y: (y > 5) & (x > 0))
    held = Support.where(lambda x, y: y < -5, displacement=(0.0, 0.0), rotation=0.0)
    scene = Scene(
        rectangle(12, 12), 1.0, STIFF, m=2, supports=[held, Support.equal(top, "u2")], loads=[pull]
    )
    solution = scene.solve(tolerance=1e-12)
    chosen = solution.points[:, 1] > 5
    u1, u2 = solution.displacement[chosen].T
    np.testing.assert_allclose(u2, u2[0])
    assert np.ptp(u1) > 1e-3
    # The tie does no work: Clapeyron.
    free = Scene(scene.region, 1.0, STIFF, m=2, supports=[held], loads=[pull]).solve()
    assert u2[0] > 0
    loaded = free.points[:, 1] > 5
    assert np.ptp(free.displacement[loaded, 1]) > 0.1 * u2[0]
    assert reaction(solution, top).force[1] == pytest.approx(0.0, abs=1e-8)


def test_one_temperature_on_an_edge():
    held = Support.where(lambda x, y: y < -5, temperature=0.0)
    edge = rectangle(12, 1, (0.0, 5.5))
    scene = Scene(
        rectangle(12, 12), 1.0, ConductivityTensor([[2.0, 0.5], [0.5, 1.0]]), m=2,
        supports=[held, Support.equal(edge, "temperature")],
        loads=[Load.source(1.0, where=lambda x, y: (y > 5) & (x > 3))],
    )  # fmt: skip
    hot = scene.solve().temperature[scene.solve().points[:, 1] > 5]
    assert hot[0] > 0
    np.testing.assert_allclose(hot, hot[0])


@pytest.mark.parametrize(
    ("supports", "message"),
    [
        ([Support.pin(LOW), Support.pin(HIGH)], "left free"),
        ([Support.pin(LOW, displacement=(0, 0))], "rotation"),
    ],
)
def test_what_pins_do_not_hold_is_refused(supports, message):
    scene = Scene(rectangle(9, 18), 1.0, STIFF, m=2, supports=supports)
    with pytest.raises(MechanismError, match=message):
        scene.solve()


@pytest.mark.parametrize(
    "supports",
    [
        [Support.pin(LOW, displacement=(0, 0), rotation=0)],
        [Support.pin(LOW, displacement=(0, 0)), Support.pin(HIGH, u1=0.0)],
        [Support.pin(LOW, displacement=(0, 0)), Support.equal(rectangle(9, 1, (0, 8.5)), "u2")],
        # Equal u1 over some height cannot turn.
        [Support.pin(LOW, displacement=(0, 0)), Support.equal(HIGH, "u1")],
    ],
)
def test_what_pins_hold_is_solved(supports):
    load = Load.body_force((0.01, 0.02), where=lambda x, y: y > 0)
    solution = Scene(
        rectangle(9, 18), 1.0, STIFF, m=2, supports=supports, loads=[load]
    ).solve()  # fmt: skip
    assert np.isfinite(solution.unknowns).all()


def test_supports_that_contradict_each_other_are_refused():
    body = rectangle(9, 18)
    both = [Support.pin(LOW), Support.where(LOW, u1=0.0)]
    for supports in (both, both[::-1], [both[0], both[0]]):
        with pytest.raises(SceneError, match="not overlap"):
            Scene(body, 1.0, STIFF, m=2, supports=supports).solve()
    with pytest.raises(SceneError, match="two particles"):
        Scene(body, 1.0, STIFF, m=2, supports=[Support.pin(disc(0.3, (0.0, 0.5)))]).solve()
    with pytest.raises(SceneError, match="statics and fracture only"):
        pinned().discretise()
    with pytest.raises(SceneError, match="to tie"):
        Scene(body, 1.0, STIFF, m=2, supports=[Support.equal(LOW, "temperature")]).solve()
    warm = ConductivityTensor.isotropic(1.0)
    with pytest.raises(SceneError, match="no rigid pins"):
        Scene(body, 1.0, warm, m=2, supports=[Support.pin(LOW, rotation=0.0)]).solve()


@pytest.mark.parametrize("surface", ["volume", "extrapolated"])
def test_a_crack_between_pins_grows_straight_and_its_energies_balance(surface, tmp_path):
    pins = disc(1.9, (-5.0, -6.0)), disc(1.9, (-5.0, 6.0))
    scene = Scene(
        rectangle(20, 20), 1.0, ElasticTensor.isotropic(1.0, 0.2), m=3, surface=surface,
        supports=[
            Support.pin(pins[0], displacement=(0.0, -1e-3)),
            Support.pin(pins[1], u2=1e-3, u1=0.0),
        ],
        cracks=[Crack((-11, 0), (-3, 0))],
    )  # fmt: skip

    def run(solves, **options):
        # Solved more tightly than the balance is asked for: pins have long levers.
        return fracture.grow(
            scene, 1e-6, max_solves=solves, no_fail=pins, tolerance=1e-9, **options
        )

    whole = run(24, monitors={"up": lambda run: reaction(run.solution, pins[1]).force[1]})
    h = whole.history
    assert whole.tip[1] == pytest.approx(0.0, abs=1e-9)
    assert whole.advance > 1
    assert np.abs(h.imbalance).max() <= 1e-8 * h.work.max()
    # Force conjugate to the load factor: the pins' forces times their unit displacements.
    np.testing.assert_allclose(h.force, 2e-3 * h.up, atol=1e-6 * np.abs(h.force).max())
    turn = whole.solution.rotation[pins[1].contains(*whole.solution.points.T)]
    assert abs(turn[0]) > 1e-5 * h.load_factor[-1]
    np.testing.assert_allclose(turn, turn[0])
    path = tmp_path / "run.npz"
    run(13, checkpoint=path)
    later, plain = run(24, checkpoint=path), run(24)
    np.testing.assert_array_equal(later.body.x, plain.body.x)
    np.testing.assert_array_equal(later.body.masters, plain.body.masters)
