"""Kinking: how angles are read, that checks can fail, and a growth at the coarsest spacing."""

from dataclasses import replace

import numpy as np
import pytest

from cmverify.cases.kinking import CASES, angles, measure, problem
from cmverify.cases.kinking.problem import Kink
from cmverify.judge.verdict import judge
from references.analytic.kinking import hoop_kink_angle

SILICON, ANISOTROPIC = CASES


def failed(case, measurements):
    verdicts = judge(case, {"bond/lattice": measurements})
    return {v.quantity for v in verdicts if not v.passed}


def line(degrees, shift=(0.0, 0.0), length=0.25):
    along = np.linspace(0.0, length, 40)[:, None]
    return np.array(shift) + along * [np.cos(np.radians(degrees)), np.sin(np.radians(degrees))]


@pytest.mark.parametrize("degrees", [0.0, -26.0, -77.0, 40.0, -110.0])
def test_a_line_is_read_wherever_it_starts(degrees):
    marks = line(degrees, (-0.01, 0.004))
    assert angles.read_angle(marks) == pytest.approx(degrees, abs=1e-9)
    assert angles.chord_angle(line(degrees)) == pytest.approx(degrees, abs=1e-12)


def test_marks_outside_the_range_or_behind_the_tip_do_not_count():
    bent = np.vstack([line(-30.0, length=0.1), line(20.0, (0.15, -0.1), 0.1), [[-0.05, 0.0]]])
    assert angles.read_angle(bent, 0.1) == pytest.approx(-30.0, abs=1e-9)
    assert np.isnan(angles.read_angle(bent[:2]))


def test_criteria_agree_with_what_is_known():
    # Sect. 3.1.1: silicon in mode I goes straight by both; pure mode II of the closed form
    assert angles.energy_angle("silicon", 0.0) == pytest.approx(0.0, abs=0.1)
    assert angles.hoop_angle("silicon", 0.0) == pytest.approx(0.0, abs=1e-9)
    rate = angles.energy_release("silicon", 45.0, np.linspace(-90.0, 90.0, 361))
    assert rate.argmax() * 0.5 - 90.0 == pytest.approx(
        angles.energy_angle("silicon", 45.0), abs=0.3
    )


@pytest.mark.parametrize("case", [SILICON, ANISOTROPIC], ids=["silicon", "anisotropic"])
def test_quick_level_holds_and_every_check_can_fail(case):
    plan = case.methods[0].run.args[0]
    found = measure.study(plan, 30)
    assert not failed(case, {30: found})
    # All angles 15° off and a path that is not the mirrored one's image by a hundredth of a cell:
    # what the bounds are there to notice.
    off = dict(found.quantities)
    off |= {"rms": off["rms"] + 15.0, "largest": off["largest"] + 15.0, "mirror": 0.01 / 30}
    if "straight" in off:
        off["straight"] += 1.1
    wrong = replace(found, quantities=off)
    expected = {"rms", "largest", "mirror"} | ({"straight"} & set(off))
    assert failed(case, {30: wrong}) == expected


def test_a_material_that_is_not_its_own_mirror_image_shows():
    """The mirror check sees the sign of the coupling moduli."""
    kink = Kink("fully anisotropic", 45.0, 20)
    path = problem.grow_kink(kink).path
    wrong = problem.grow_kink(Kink("fully anisotropic", -45.0, 20)).path * [1.0, -1.0]
    right = problem.grow_kink(replace(kink, mirrored=True)).path * [1.0, -1.0]
    np.testing.assert_allclose(right, path, atol=1e-9)
    assert wrong.shape != path.shape or np.abs(wrong - path).max() > 1e-3


def test_a_crack_at_an_angle_to_the_lattice_sees_the_same_material():
    turned = Kink("fully anisotropic", 30.0, 20, turn=35.0)
    x, y = np.array([0.3, -0.2]), np.array([0.1, 0.4])
    own = np.stack([x, y], axis=-1) @ turned.axes
    straight = Kink("fully anisotropic", 30.0, 20)
    np.testing.assert_allclose(
        turned.displacement(x, y) @ turned.axes, straight.displacement(*own.T), atol=1e-14
    )
    np.testing.assert_allclose(turned.rotation(x, y), straight.rotation(*own.T), atol=1e-14)


@pytest.mark.parametrize(("m", "count"), [(5, 84), (3, 18)])
def test_a_batch_is_what_a_cut_breaks_per_cell(m, count):
    assert problem.batch(Kink("silicon", 0.0, 60, m=m)) == pytest.approx(count, abs=1)
    assert problem.batch(Kink("silicon", 0.0, 60, front=1e-9)) == 1


# Kinks that a row ahead of the crack holds back, and those that leave it, α_K in degrees.
@pytest.mark.slow
@pytest.mark.parametrize(
    ("m", "mixity", "held"), [(3, 12.0, True), (5, 4.0, True), (5, 12.0, False), (7, 6.0, False)]
)
def test_a_row_of_the_lattice_holds_small_kinks_and_the_fewer_the_larger_m(m, mixity, held):
    """Led by few bonds: up to 22° are held at m = 3, 8° and not 22° at m = 5, not 12° at m = 7."""
    grown = problem.grow_kink(Kink("isotropic:0.2", mixity, 24, m=m, front=1 / 8))
    found = angles.read_angle(grown.marks)
    wanted = np.degrees(
        hoop_kink_angle(grown.kink.voigt, np.cos(np.radians(mixity)), np.sin(np.radians(mixity)))
    )
    assert wanted == pytest.approx(-1.9 * mixity, abs=1.0)
    assert found == pytest.approx(0.0 if held else wanted, abs=1e-9 if held else 3.0)
