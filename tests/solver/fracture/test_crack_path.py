"""Paths, tips and damage read from broken bonds."""

import numpy as np
import pytest

from solver import (
    Crack,
    ElasticTensor,
    Family,
    Scene,
    Support,
    disc,
    fracture,
    recovery,
    rectangle,
)
from solver.bonds import Bonds, damage
from solver.fracture.crack_path import initial_tips, trace
from solver.geometry import Lattice
from tests.solver.bodies import block

ORIGIN = np.zeros((1, 2))


def test_tips_are_the_ends_that_lie_in_the_body():
    cracks = [Crack((-2, 0), (0, 0)), Crack((0.3, 0.3), (0.5, 0.3)), Crack((0.9, 2), (0.9, -2))]
    loop = Crack((0.1, 0), (0.2, 0), (0.2, 0.1), (0.1, 0))
    tips = initial_tips([*cracks, loop], disc(1.0))
    assert tips.tolist() == [[0.0, 0.0], [0.3, 0.3], [0.5, 0.3]]
    assert initial_tips([], disc(1.0)).shape == (0, 2)


def test_ends_that_meet_other_cracks_are_no_tips():
    trunk, branch = Crack((-0.5, 0.0), (0.1, 0.0)), Crack((0.5, 0.0), (0.1, 0.0))
    side = Crack((-0.2, 0.3), (-0.2, 0.0))
    tips = initial_tips([trunk, branch, side], disc(1.0))
    np.testing.assert_array_equal(tips, [(-0.5, 0.0), (0.5, 0.0), (-0.2, 0.3)])


def test_a_straight_row_of_marks():
    marks = np.column_stack([np.arange(0.5, 8.1, 0.5), np.zeros(16)])
    (path,) = trace(ORIGIN, marks, 1.0)
    assert path.tip.tolist() == [8.0, 0.0]
    assert path.advance == path.length == 8.0
    np.testing.assert_allclose(path.points[:, 1], 0.0)
    assert (np.diff(path.points[:, 0]) > 0).all()


def test_strays_and_gaps_do_not_lead():
    marks = np.array([[1.0, 0], [2, 0], [3, 0], [2, 6], [5, 0.2], [6, 0.2]])
    (path,) = trace(ORIGIN, marks, 1.0)
    assert path.tip.tolist() == [3.0, 0.0]
    (other,) = trace(ORIGIN, np.add(marks, [9.0, 0.0]), 1.0)
    assert other.advance == 0.0
    assert trace(np.zeros((0, 2)), marks, 1.0) == []
    assert trace(ORIGIN, np.zeros((0, 2)), 1.0)[0].points.tolist() == [[0.0, 0.0]]


def test_two_marks_abreast_make_one_tip():
    marks = np.array([[1.0, 0.0], [2.0, 0.5], [2.0, -0.5]])
    (path,) = trace(ORIGIN, marks, 1.0)
    assert path.tip.tolist() == [2.0, 0.0]


def test_each_tip_has_its_own_path_and_the_longest_comes_first():
    row = np.column_stack([np.arange(1.0, 6.0), np.zeros(5)])
    marks = np.vstack([row, [-11.0, 0.0]])
    first, second = trace(np.array([[-10.0, 0.0], [0.0, 0.0]]), marks, 1.0)
    assert first.start.tolist() == [0.0, 0.0]
    assert first.tip.tolist() == [5.0, 0.0]
    assert second.start.tolist() == [-10.0, 0.0]
    assert second.advance == 1.0


def test_a_curved_path_is_longer_than_its_advance():
    angle = np.linspace(0.05, np.pi / 2, 30)
    marks = 10 * np.column_stack([np.sin(angle), 1 - np.cos(angle)])
    (path,) = trace(ORIGIN, marks, 1.0)
    assert path.advance == pytest.approx(10 * np.sqrt(2), rel=1e-9)
    # Means within a cell cut the corner a little.
    assert path.length == pytest.approx(5 * np.pi, rel=0.02)


def test_damage_by_hand():
    family = Family(1, 1.0, "full")
    lattice = Lattice(block(3, 3), 1.0, family.reach)
    bonds = Bonds(lattice, family, [Crack((-1, 1), (1.5, 1))])
    # The crack runs between the first two rows, through the first column's vertical bond and not
    # as far as the third's: a corner has two neighbours, the particle above it three.
    lower, upper = 1 / 2, 1 / 3
    cut = damage(bonds).reshape(3, 3)
    assert cut[0, 0] == pytest.approx(lower)
    assert cut[1, 0] == pytest.approx(upper)
    assert not cut[2].any()
    assert not cut[:, 2].any()


def test_damage_counts_area_fractions_and_broken_bonds():
    held = [
        Support.where(lambda x, y: y < 1, displacement=(0.0, 0.0), rotation=0.0),
        Support.where(lambda x, y: y > 8, displacement=(0.0, 1.0), rotation=0.0),
    ]
    solid = ElasticTensor.isotropic(1.0, 0.2)
    scene = Scene(block(8, 9), 1.0, solid, m=2, supports=held, cracks=[Crack((-1, 4), (2, 4))])
    run = fracture.grow(scene, 1.0, max_solves=6)
    parts = run.solution.discretisation
    family, count = parts.family, parts.lattice.count
    gone, whole = np.zeros(count), np.zeros(count)
    for o in range(family.size):
        exists = np.zeros(count, dtype=bool)
        rows, columns = parts.lattice.rows_columns
        dx, dy = family.offsets[o]
        exists = parts.lattice.mask[rows + dy, columns + dx]
        whole += family.fraction[o] * exists
        gone += family.fraction[o] * (exists & (parts.bonds.strength(o) == 0))
    np.testing.assert_allclose(run.damage, gone / whole, rtol=1e-12)
    np.testing.assert_allclose(recovery.damage(run.solution), run.damage)
    assert run.damage.max() > 0
    # An untouched body has none, and a stress field can be recovered from the damaged one.
    assert not recovery.damage(Scene(block(8, 9), 1.0, solid, m=2, supports=held).solve()).any()
    assert np.isfinite(recovery.stress(run.solution)).all()


def test_a_body_without_a_crack_starts_its_path_where_it_broke_first():
    held = [
        Support.where(lambda x, y: x < 2, displacement=(0.0, 0.0), rotation=0.0),
        Support.where(lambda x, y: x > 18, displacement=(1.0, 0.0), rotation=0.0),
    ]
    solid = ElasticTensor.isotropic(1.0, 0.2)
    hole = block(20, 10) - disc(1.2, (10.0, 0.0))
    run = fracture.grow(
        Scene(hole, 1.0, solid, m=2, supports=held), 1.0, until=lambda run: run.advance > 3
    )
    assert run.path[0] == pytest.approx([10.0, 1.5], abs=1.6)
    assert run.tip[0] == pytest.approx(10.0, abs=1.5)
    assert run.tip[1] > 4


def test_a_crack_that_begins_in_the_middle_has_two_tips():
    x = np.arange(-7.0, 7.1, 0.5)
    marks = np.column_stack([x, 0.02 * x**2])
    first, second = trace(np.zeros((0, 2)), marks, 1.0, np.abs(x).astype(int))
    assert {first.tip[0], second.tip[0]} == {-7.0, 7.0}
    assert first.advance == pytest.approx(second.advance, rel=0.1)
    assert abs(first.start[0]) <= 0.5
    # Mirror-symmetric marks: not one tip in the middle between the two.
    assert abs(first.tip[0]) == 7.0


def test_cracks_far_from_the_scenes_have_paths_of_their_own_and_strays_none():
    row = np.column_stack([np.arange(1.0, 6.0), np.zeros(5)])
    marks = np.vstack([row, np.add(row, [20.0, 3.0]), [[10.0, 10.0]]])
    steps = np.r_[np.arange(5), np.arange(5)[::-1], 9]
    first, second = trace(ORIGIN, marks, 1.0, steps)
    tips = {tuple(first.tip), tuple(second.tip)}
    assert tips == {(5.0, 0.0), (21.0, 3.0)}
    assert len(trace(ORIGIN, marks, 1.0)) == 1


def test_a_branch_is_a_tip_of_its_own():
    stem = np.column_stack([np.arange(1.0, 12.0), np.zeros(11)])
    arm = np.column_stack([5.0 + np.arange(1.0, 8.0) * 0.3, np.arange(1.0, 8.0)])
    marks = np.vstack([stem, arm])
    paths = trace(ORIGIN, marks, 1.0, np.arange(len(marks)))
    assert {tuple(p.tip) for p in paths} == {tuple(arm[-1]), (11.0, 0.0)}
    assert len(trace(ORIGIN, marks, 1.0, np.arange(len(marks)), branch=9.0)) == 1


@pytest.mark.parametrize("surface", ["volume", "extrapolated"])
def test_a_holed_plate_has_a_crack_on_either_side(surface):
    pull = Support.where(
        lambda x, y: abs(y) > 10, displacement=lambda x, y: y[:, None] * [0, 1e-3], rotation=0.0
    )
    scene = Scene(
        rectangle(24, 24) - disc(4), 1.0, ElasticTensor.isotropic(1.0, 0.2), m=3,
        supports=[pull], surface=surface,
    )  # fmt: skip
    run = fracture.grow(scene, 1e-6, until=lambda run: run.advance > 4)
    left, right = sorted(run.paths[:2], key=lambda path: path.tip[0])
    np.testing.assert_allclose(left.tip, [-1, 1] * right.tip, atol=1e-9)
    assert right.tip[0] > 8
    assert abs(right.start[0] - 4) < 1.6
    assert run.advance > 4
