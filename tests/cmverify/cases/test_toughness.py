"""Each check of the toughness case fails when the bonds' energies are 1 % off."""

import numpy as np

from cmverify.cases import toughness
from cmverify.judge.verdict import judge
from solver import Family


def failed(measurements):
    verdicts = judge(toughness.CASES[0], {"bond/lattice": measurements})
    return {(v.quantity, v.kind) for v in verdicts if not v.passed}


def test_the_case_holds_and_sees_one_per_cent():
    assert not failed({m: toughness.measure(m) for m in (5, 7)})
    wrong = failed({m: toughness.measure(m, 1.01) for m in (5, 7)})
    assert {("cut", "bound"), ("constants", "bound"), ("integral", "bound")} <= wrong
    assert {("bone", "bound"), ("isotropy", "order"), ("isotropy", "bound")} <= wrong
    assert ("even isotropy", "bound") in wrong
    # The lattice's cuts are too cheap at other angles: cheaper ones still show here.
    assert ("curve", "bound") in failed({5: toughness.measure(5, 0.99)})


def test_a_counted_cut_by_hand():
    # m = 1, whole cells: four neighbours; a level cut breaks one upright bond a column.
    family = Family(1, 0.5, "full")
    critical = np.where(family.offsets[:, 1] != 0, 3.0, 0.0)
    cell = 0.25
    assert toughness.counted_cut(family, critical, (1, 0)) == 3.0 * cell**2 / 0.5
    assert toughness.counted_cut(family, critical, (0, 1)) == 0.0
