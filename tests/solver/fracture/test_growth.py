"""What a run knows of itself, and that bonds break as in finished solves."""

import numpy as np
import pytest

from solver import Crack, ElasticTensor, Programme, Scene, Support, Toughness, rectangle
from solver.bonds import damage
from solver.fracture import grow, growth
from solver.linear import nearby
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


def _scene(surface: str, cracks: list[Crack], shear: float) -> Scene:
    grips = Support.where(
        lambda x, y: np.abs(y) > 18, rotation=0.0,
        displacement=lambda x, y: np.sign(y)[:, None] * [shear, 1.0],
    )  # fmt: skip
    voigt = np.array([[1, 0.2, 0.1], [0.2, 0.8, 1 / 6], [0.1, 1 / 6, 1 / 3]])
    material = ElasticTensor(voigt) if shear else ElasticTensor.isotropic(1.0, 1 / 3)
    return Scene(rectangle(32, 40), 1.0, material, [grips], m=3, cracks=cracks, surface=surface)


def _slender(length: float, height: float, cracks: list[Crack], bent: bool) -> Scene:
    held = [Support.where(lambda x, y: x < 2 - length / 2, displacement=0.0, rotation=0.0)]
    if bent:
        held += [Support.where(lambda x, y: x > length / 2 - 1, u2=1.0)]
    else:
        held += [Support.where(lambda x, y: x > length / 2 - 2, displacement=(1.0, 0.0))]
    return Scene(
        rectangle(length, height), 1.0, ElasticTensor.isotropic(1.0, 0.3), held, m=2,
        cracks=cracks,
    )  # fmt: skip


def _sheared() -> Scene:
    """Small, slow to converge: bonds creep up to what breaks them over many iterations."""
    grips = Support.where(
        lambda x, y: np.abs(y) > 4.8, rotation=0.0,
        displacement=lambda x, y: np.sign(y)[:, None] * [1.0, 0.0],
    )  # fmt: skip
    return Scene(
        rectangle(23, 14), 1.0, ElasticTensor.isotropic(1.0, 0.3), [grips], m=2, surface="none",
        cracks=[Crack((-12.5, -0.4345), (-8.99979, -0.04425))],
    )  # fmt: skip


def _notched(length: float, height: float, bent: bool) -> Scene:
    top = [(x, height / 2 + 1) for x in (-0.3 * length, 0.2 * length)]
    return _slender(
        length, height, [Crack((x, y), (x, y - 1 - 0.3 * height)) for x, y in top], bent
    )


@pytest.mark.parametrize(
    ("body", "batch", "overload"),
    [
        (_scene("volume", [Crack((-17, 0.3), (-8, 0.3))], 0.8), None, 0.02),
        (_scene("extrapolated", [Crack((-17, 0.3), (-8, 0.3))], 0.3), None, 0.02),
        # Mirror images break together; no rotations.
        (_scene("none", [Crack((-17, 0), (-10, 0)), Crack((10, 0), (17, 0))], 0.0), None, 0.02),
        (_sheared(), 5, 0.5),
        (_notched(60, 8, bent=True), 3, 0.5),
        (_notched(70, 6, bent=False), 3, 0.5),
        (_notched(60, 40, bent=True), 3, 0.5),
    ],
    ids=["volume", "extrapolated", "none", "sheared", "bent strip", "strip", "bent"],
)
def test_the_same_bonds_break_as_in_finished_solves(monkeypatch, body, batch, overload):
    def run() -> growth.Growth:
        programme = Programme(overload=overload)
        return grow(body, Toughness(1.0), programme, batch=batch, max_solves=20)

    monkeypatch.setattr(nearby, "_AROUND", 6)
    quick = run()
    monkeypatch.setattr(growth, "_ROUGH", 1.1e-8)
    monkeypatch.setattr(nearby, "_SHARE", 0.0)
    slow = run()
    assert len(slow.broken_bonds) > 15
    np.testing.assert_array_equal(quick.breaks["step"], slow.breaks["step"])
    np.testing.assert_array_equal(quick.broken_bonds, slow.broken_bonds)
    np.testing.assert_allclose(quick.breaks["load_factor"], slow.breaks["load_factor"], rtol=1e-6)
    # A slender cantilever's first answer is as exact as its tolerance and its condition allow.
    assert abs(quick.history.imbalance).max() < 1e-6 * abs(quick.history.work).max()


@pytest.mark.parametrize("ends", [{"max_solves": 3}, {"until": lambda run: len(run.steps) > 2}])
def test_a_run_that_ends_within_an_avalanche_hands_out_an_equilibrium(ends):
    body = _scene("volume", [Crack((-17, 0.3), (-8, 0.3))], 0.8)
    run = grow(body, Toughness(1.0), Programme(overload=0.02), tolerance=1e-9, **ends)
    assert not run.resting
    assert run.solution.statistics.residual < 2e-9
    assert len(run.steps) == 3


def test_who_looks_on_does_not_change_what_breaks():
    body = _scene("volume", [Crack((-17, 0.3), (-8, 0.3))], 0.8)
    looked = grow(
        body, Toughness(1.0), Programme(overload=0.02), max_solves=8,
        listen=lambda run: run.bonds.utilisation(3.0 * run.unknowns),
    )  # fmt: skip
    alone = grow(body, Toughness(1.0), Programme(overload=0.02), max_solves=8)
    np.testing.assert_array_equal(looked.broken_bonds, alone.broken_bonds)
