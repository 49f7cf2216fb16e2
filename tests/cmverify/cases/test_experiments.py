"""The paper's experiments at the coarsest spacings: what is judged is seen, pictures are kept."""

from dataclasses import replace

import numpy as np
import pytest

from cmverify.cases.experiments import CASES, bone, inclusion, notched_plate, pair
from cmverify.cases.experiments.running import unmirrored
from cmverify.report.stages import stages_figure
from cmverify.run.results import Record, load, save


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
    assert len(stages_figure(pulled).axes) == 1 + len(pulled.stages.stages)


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


def test_every_method_of_an_experiment_is_judged():
    for case in CASES:
        assert {check.method for check in case.checks} == {m.name for m in case.methods}
