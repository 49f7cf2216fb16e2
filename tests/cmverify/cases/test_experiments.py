"""The paper's experiments at the coarsest spacings: what is judged is seen, pictures are kept."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from cmverify.case import Measurement
from cmverify.cases.experiments import CASES, bone, inclusion, notched_plate, pair
from cmverify.cases.experiments.running import unmirrored
from cmverify.judge.verdict import judge
from cmverify.report.stages import stages_figure
from cmverify.run.results import Record, load, save
from solver.fracture.crack_path import CrackPath


@pytest.fixture(scope="module")
def pulled():
    return inclusion.bond(inclusion.Plate(m=3), 18)


def test_an_inclusion_cracks_symmetrically_and_its_stages_are_kept(pulled, tmp_path):
    assert pulled.quantities["unmirrored"] == 0
    assert pulled.quantities["balance"] < 1e-6
    assert pulled.statistics["tips"] == 2
    record = Record("inclusion", "steps", 18, pulled, 1, 1.0, "none")
    again = load(save(record, tmp_path)).outcome
    assert [s.label for s in again.stages.stages] == [s.label for s in pulled.stages.stages]
    for one, other in zip(again.stages.stages, pulled.stages.stages, strict=True):
        np.testing.assert_array_equal(one.values, other.values)
    for one, other in zip(again.stages.outlines, pulled.stages.outlines, strict=True):
        np.testing.assert_array_equal(one, other)
    # The curve, the maps and what their colours mean.
    assert len(stages_figure(pulled).axes) == 2 + len(pulled.stages.stages)
    # Marks lie on the curve.
    curve = pulled.lines[0].curves[0]
    for stage in pulled.stages.stages:
        assert curve.abscissa.min() <= stage.at[0] <= curve.abscissa.max()
        assert curve.computed.min() <= stage.at[1] <= curve.computed.max()


def test_one_bond_without_its_image_is_seen():
    run = inclusion.Plate(m=3).led(18).run
    assert unmirrored(run) == 0
    broken = run.bonds.broken
    whole = np.flatnonzero(run.bonds.strengths.ravel())
    _, p, q = run.bonds.ends(whole)
    x = run.bonds.lattice.points[:, 0]
    broken.add(whole[(x[p] > 0) & (x[q] > 0)][:1], 99, 1.0, False)
    assert unmirrored(run) == 1


def test_stiffness_of_the_notched_plate_sees_one_per_cent():
    found = []
    for scale in (1.0, 1.01):
        scene, _ = replace(notched_plate.Plate(True, m=3), stiffness=scale).scene(3)
        solution = scene.solve()
        from solver.reactions import reaction

        upper = reaction(solution, lambda x, y: np.hypot(x + 0.0125, y - 0.04) < 0.0067)
        found.append(upper.force[1] / notched_plate.MOVE)
    error = np.array(found) / notched_plate.reference_stiffness(True) - 1
    assert error[1] - error[0] == pytest.approx(0.01, rel=0.1)
    assert abs(error[0]) < 0.06


def _parted(m: int, n: int, *rows: tuple[float, list[tuple[float, float]]], own=(0, 1)):
    """What `notched_plate.happened` reads of a run: bonds that parted at each load, in a.

    `own` rows make the notch's path.
    """
    marks = np.array([mark for _, row in rows for mark in row])
    loads = np.array([load for load, row in rows for _ in row])
    breaks = np.zeros(len(marks), dtype=[("step", "i8"), ("load_factor", "f8")])
    breaks["step"], breaks["load_factor"] = np.arange(len(marks)), loads
    unit = notched_plate.UNIT
    path = CrackPath(unit * np.array([(-4.5, 1.0), *(x for k in own for x in rows[k][1])]))
    return SimpleNamespace(
        bonds=SimpleNamespace(lengths=lambda bonds: np.full(len(bonds), unit / n)),
        broken_bonds=np.arange(len(marks)),
        midpoints=unit * marks,
        breaks=breaks,
        paths=[path],
    )


def test_events_of_the_notched_plate_are_read_off_in_their_order():
    n, m = 5, 3
    way = [(x, 1.0 - 0.2 * max(0.0, x + 1.0)) for x in np.arange(-4.4, -0.7, 0.2)]
    first, second = way[:6], way[6:]
    right = [(x, -1.8) for x in np.arange(2.9, 6.5, 0.2)]
    hole = np.hypot(*np.subtract(second[-1], notched_plate.HOLE)) - 2.0
    assert hole > 0.0
    run = _parted(m, n, (0.3, first), (0.35, second), (0.7, right[:5]), (1.2, right[5:]))
    found = notched_plate.happened(run, m, n)
    # It has not come to the hole yet.
    assert list(found) == ["crack", "second crack", "through"]
    assert [load for load, _ in found.values()] == pytest.approx([0.3, 0.7, 1.2])
    to_hole = np.subtract(notched_plate.HOLE, second[-1])
    reach = [
        tuple(second[-1] + s * to_hole / np.hypot(*to_hole)) for s in np.arange(0.2, hole, 0.2)
    ]
    run = _parted(m, n, (0.3, first), (0.36, second + reach), (0.7, right[:5]), (1.2, right[5:]))
    found = notched_plate.happened(run, m, n)
    assert list(found) == list(notched_plate.EVENTS)
    load, step = found["in the hole"]
    # To a cell and a half.
    assert load == 0.36
    assert 0 <= len(first) + len(second) + len(reach) - 1 - step <= 2
    # What breaks at the hole's edge later is not when it came.
    beside = [tuple(np.add(reach[-1], (0.2, 0.1)))]
    run = _parted(
        m, n, (0.3, first), (0.36, second + reach), (0.7, right[:5]), (1.0, beside),
        (1.2, right[5:]), own=(0, 1, 3),
    )  # fmt: skip
    assert notched_plate.happened(run, m, n)["in the hole"] == (load, step)


def test_the_bone_specimen_is_near_the_standard():
    # Bonded pins and anisotropy against E399's factor (isotropic, pins in loose holes).
    assert bone.critical_load() == pytest.approx(bone.THEORY, rel=0.15)
    stiffness = [bone.reference(d)[0] for d in (0.0, 45.0, 90.0)]
    assert len(set(np.round(stiffness, -3))) == 3
    # Fibres along and across the crack: mode I alone.
    for degrees in (0.0, 90.0):
        _, KI, KII = bone.reference(degrees)
        assert abs(KII) < 1e-3 * KI


def test_compliance_says_how_far_a_crack_has_grown_and_what_is_released():
    grown, release = bone.released(1.0, bone.critical_load())
    assert abs(grown) < 1e-12
    # Two meshes of the same specimen.
    assert release == pytest.approx(1.0, abs=2e-3)
    softer = bone.released(0.8, bone.critical_load())
    assert 5e-4 < softer[0] < 2e-3
    assert bone.released(0.8, 1.1 * bone.critical_load())[1] == pytest.approx(1.21 * softer[1])


@pytest.mark.parametrize("offset", [False, True])
def test_a_pair_of_cracks_breaks_alike_under_half_a_turn(offset):
    run = pair.Pair(offset, m=3).led(4, max_solves=30).run
    assert len(run.broken_bonds)
    assert pair._turned(run) == 0
    run.bonds.broken.add(np.flatnonzero(run.bonds.strengths.ravel())[:1], 99, 1.0, False)
    assert pair._turned(run) == 1


def test_a_direction_within_its_sector_is_not_too_good_to_be_true():
    """It is nought degrees beyond, which no error of a method would be."""
    case = next(case for case in CASES if case.name == "bone-compact-tension")
    for beyond, holds in ((0.0, True), (9.4, True), (9.6, False)):
        quantities = dict.fromkeys(case.quantities, 0.0) | {"beyond the fibres": beyond}
        found = {3: Measurement(1, quantities, {"solve": 1.0})}
        verdicts = judge(case, {"ζ = 45°": found})
        (own,) = [
            v for v in verdicts if v.quantity == "beyond the fibres" and v.method == "ζ = 45°"
        ]
        assert own.passed == holds


def test_every_method_of_an_experiment_is_judged():
    for case in CASES:
        assert {check.method for check in case.checks} == {m.name for m in case.methods}
