"""Paths of grown cracks, judged as our own are."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cmverify.cases import registry
from cmverify.cases.experiments import bone, pair
from cmverify.exchange import answers, compare
from cmverify.exchange.case_export import write_case

TIP = np.array([bone.TIP, 0.0])


def posed(name, pose):
    case = registry.get(name)
    return case, next(one for one in case.poses if one.name == pose)


def scored(folder, pose, n, path, name="bone-compact-tension", header="x,y"):
    statement = posed(name, pose)[1].state(n)
    file = folder / "mine.csv"
    np.savetxt(file, path, delimiter=",", header=header, comments="")
    return compare.score(statement, answers.read(file, statement.targets)).quantities


@settings(max_examples=20, deadline=None)
@given(st.floats(-80.0, 80.0), st.integers(2, 40), st.floats(0.0, 1e-4))
def test_a_straight_crack_goes_where_it_goes(angle, count, off):
    """However few points the path has; from the mouth on it is the same."""
    ray = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    path = TIP + np.linspace(0.0, 1.2 * bone.EARLY, count)[:, None] * ray
    mouth = np.vstack([TIP - [[5e-3, off], [3e-3, 0.0]], path])
    read = posed("bone-compact-tension", "45°")[1].state(2).targets[0].read
    least = bone.heading(bone.criterion(45.0))
    wanted = max(0.0, angle - 45.0, least - angle)
    for one in (path, mouth):
        assert read(one)[0] == pytest.approx(wanted, abs=1e-6)


def test_a_file_is_judged_by_the_bounds_of_ours(tmp_path):
    line = TIP + np.linspace(0.0, 8e-3, 30)[:, None] * [1.0, 0.0]
    assert scored(tmp_path, "0°", 5, line) == {"straying": 0.0}
    bent = line + np.column_stack([0 * line[:, 0], np.linspace(0, 1e-3, 30)])
    assert scored(tmp_path, "0°", 5, bent)["straying"] == pytest.approx(1e-3 / bone.WIDTH)
    found = scored(tmp_path, "60°", 5, TIP + np.array([[0.0, 0.0], [1e-3, 5e-3]]))
    assert found["beyond the fibres"] == pytest.approx(np.degrees(np.arctan2(5, 1)) - 60.0)
    for wrong, message in ((line + np.array([0, 5e-3]), "old tip"), (line[:2], "judged to")):
        with pytest.raises(answers.AnswerError, match=message):
            scored(tmp_path, "45°", 5, wrong)


def test_cracks_that_pass_each_other_hook_into_the_other_s_flank(tmp_path):
    """A path that ends on the right crack is no horizon from it; a short one has not passed."""
    start, lift = np.array([-pair.INNER, -0.25 * pair.HALF]), 0.25 * pair.HALF
    hook = np.array([start, [0.0, -1.4 * lift], [pair.INNER, 0.0], [pair.INNER + 1e-3, lift]])
    found = scored(tmp_path, "offset", 16, hook, "crack-pair")
    assert found["short of passing"] == 0.0
    assert found["from the flank"] < 0.02
    stuck = np.array([start, [-0.3 * pair.INNER, start[1]]])
    found = scored(tmp_path, "offset", 16, stuck, "crack-pair")
    assert found["short of passing"] == pytest.approx(0.6 * pair.INNER / pair.HALF)
    case, pose = posed("crack-pair", "offset")
    bounds = compare.bounds_of(case, pose.method, 16)
    assert {"from the flank", "short of passing"} <= set(bounds)
    assert found["from the flank"] > bounds["from the flank"].bound_at(16)


def test_the_specimen_can_be_exported(tmp_path):
    write_case(*posed("bone-compact-tension", "0°"), 1, tmp_path)
    assert "pin" in (tmp_path / "case.json").read_text(encoding="utf-8")
