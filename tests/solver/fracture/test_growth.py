"""What a run knows of itself: bonds in their order, steps, marks, paths, damage."""

import numpy as np
import pytest

from solver.bonds import damage
from solver.fracture import grow
from tests.solver.fracture.strip import M, N, scene


@pytest.fixture(scope="module")
def run():
    toughness = np.full(scene().family().size, 2.0)
    return grow(scene(), toughness, batch=6, max_solves=10)


def test_breaks_and_steps_tell_the_same_story(run):
    breaks, steps = run.breaks, run.steps
    assert len(breaks) == len(run.broken_bonds) == run.broken.sum() > 0
    assert steps["broken"].sum() == len(breaks)
    assert (np.diff(breaks["step"]) >= 0).all()
    assert (breaks["load_factor"] > 0).all()
    for step in np.unique(breaks["step"]):
        assert (breaks["step"] == step).sum() == steps["broken"][step]


def test_broken_bonds_carry_nothing(run):
    assert not run.bonds.strengths.ravel()[run.broken_bonds].any()
    assert (run.bonds.whole.ravel()[run.broken_bonds] > 0).all()
    assert (run.damage >= damage(run.body.sound.bonds) - 1e-12).all()
    assert (run.damage > damage(run.body.sound.bonds)).any()


def test_the_crack_goes_straight_ahead(run):
    """By symmetry: midpoints mirror each other, and the path stays on the line."""
    assert run.advance > 0
    np.testing.assert_allclose(run.path[:, 1], 0.0, atol=0.51 / N)
    heights = np.sort(run.midpoints[:, 1])
    np.testing.assert_allclose(heights, -heights[::-1], atol=1e-12)
    assert np.abs(run.midpoints[:, 1]).max() <= M / N
    np.testing.assert_array_equal(run.tip, run.path[-1])
    assert run.advance == pytest.approx(np.hypot(*(run.path[-1] - run.path[0])))


def test_the_solution_is_the_last_equilibrium(run):
    np.testing.assert_array_equal(run.solution.displacement, run.unknowns[:2].T)
    unit = run.body.unknowns[:2].T
    np.testing.assert_allclose(run.solution.displacement, run.load_factor * unit, atol=1e-14)
    assert not run.loose.any()


def test_a_run_says_what_it_cannot_answer_well(run):
    assert run.summary()["warnings"] == run.warnings
    assert set(run.cautions) <= set(run.warnings)
