"""The least change of a stiffness: states and forces as asked, symmetric, positive."""

import numpy as np
import pytest

from solver.tips.update import best_forces, changed, stretch


def stiffness(size, rng, null=2):
    root = rng.normal(size=(size, size - null))
    return root @ root.T


def test_states_answer_as_asked_and_what_strains_nothing_still_does():
    rng = np.random.default_rng(3)
    bonds = stiffness(12, rng)
    states = rng.normal(size=(12, 3))
    # Forces that make a symmetric pair with the states, and none in the last of them.
    soft = 0.05 * stiffness(12, rng, 6)
    null = np.linalg.svd(bonds)[0][:, -2:]
    still = np.linalg.qr(np.column_stack([states[:, 2], null]))[0]
    keep = np.eye(12) - still @ still.T
    forces = keep @ soft @ keep @ states
    assert np.abs(forces[:, 2]).max() < 1e-12
    change = changed(bonds, states, forces)
    np.testing.assert_allclose(change @ states, forces, atol=1e-10)
    np.testing.assert_allclose(change @ null, 0.0, atol=1e-10)
    np.testing.assert_array_equal(change, change.T)
    after = np.linalg.eigvalsh(bonds + change)
    assert after[0] > -1e-10 * after[-1]
    low, high = stretch(bonds, change)
    assert 0.0 < low <= 1.0 <= high


def test_no_forces_no_change():
    rng = np.random.default_rng(4)
    bonds, states = stiffness(9, rng), rng.normal(size=(9, 2))
    assert np.abs(changed(bonds, states, np.zeros((9, 2)))).max() < 1e-12 * np.abs(bonds).max()


def test_a_state_that_would_give_energy_away_is_refused():
    rng = np.random.default_rng(5)
    bonds, state = stiffness(6, rng, 0), rng.normal(size=(6, 1))
    assert changed(bonds, state, -2.0 * bonds @ state) is None
    assert best_forces(state, state, state, -bonds, state, 1.0) is None


@pytest.mark.parametrize("mu", [1e-4, 1e2])
def test_forces_make_the_error_smaller_and_fade_with_their_weight(mu):
    rng = np.random.default_rng(6)
    bonds = stiffness(10, rng, 0)
    response = np.linalg.inv(bonds + np.eye(10))
    moved = np.vstack([response, 0.1 * rng.normal(size=(20, 10))])
    error, plain = rng.normal(size=(30, 2)), rng.normal(size=(10, 2))
    still = rng.normal(size=(10, 1))
    forces = best_forces(moved, error, plain, bonds, still, mu)
    np.testing.assert_allclose(still.T @ forces, 0.0, atol=1e-9)
    # Betti: both states do the same work on each other's forces.
    assert plain[:, 0] @ forces[:, 1] == pytest.approx(plain[:, 1] @ forces[:, 0], abs=1e-9)
    left = np.linalg.norm(error - moved @ forces) / np.linalg.norm(error)
    assert left < (0.95 if mu < 1 else 1.0 + 1e-12)
    if mu > 1:
        assert np.abs(moved @ forces).max() < 0.01 * np.abs(error).max()
