"""Work against precision: two passes, a front that knows its uncertainty, a chapter."""

import csv
import json
from dataclasses import replace

import pytest
from typer.testing import CliRunner

from cmverify.case import Level
from cmverify.cases import registry
from cmverify.cli import app
from cmverify.report import precision_chapter
from cmverify.studies import precision
from tests.cmverify.toy_registry import toy

P = precision.Point("c", "a", "bond", 10, 9, 1e-3, 1.0, 0.9, 1.1, 5, 0.0, 0, "again")


def standings(*points):
    return [p.standing for p in precision.judged(points)]


def test_the_front_knows_its_spread():
    quicker = replace(P, method="b", seconds=0.5, fast=0.4, slow=0.6)
    assert standings(P, quicker) == ["beaten", "front"]
    close = replace(P, method="b", seconds=0.95, fast=0.85, slow=1.05)
    assert standings(P, close) == ["perhaps", "perhaps"]
    finer = replace(P, method="b", error=1e-4, seconds=9.0, fast=8.0, slow=10.0)
    assert standings(P, finer) == ["front", "front"]
    elsewhere = replace(quicker, case="d")
    assert standings(P, elsewhere) == ["front", "front"]


def test_times_are_repeated_and_errors_are_not_touched_by_it():
    points, refused = precision.measure([toy()], Level.QUICK, repeats=4)
    assert refused == []
    assert [p.resolution for p in points] == [10, 20]
    for p in points:
        assert p.repeats == 4
        assert p.fast <= p.seconds <= p.slow
        assert p.seconds == pytest.approx(3e-4 * p.resolution)  # what the toy says of itself
        assert f"--resolution {p.resolution}" in p.command
    assert precision.seconds_to(points, 1e-9) == {}
    best = precision.seconds_to(points, 1.0)["bond/trapezium"]
    assert best == (points[0].seconds, points[0].error)


def test_a_posed_problem_is_varied_one_choice_at_a_time():
    case = registry.get("disc-exponential")
    names = [m.name for m in precision.methods_of(case)]
    assert {"fem/P1", "fem/P2"} <= set(names)
    varied = [m for m in precision.methods_of(case) if m not in case.methods and m.kind == "bond"]
    changed = [name for name, _, _ in precision.VARIANTS if name != "continuum"]  # a method
    assert [m.name.split(", ")[1] for m in varied] == [*changed, "assembled"]
    pose = case.poses[0]
    same = precision.vary(case, pose, {}, 1e-13, 10)
    own = case.method(pose.method).run(10)
    assert same.unknowns == own.unknowns
    assert same.quantities[case.primary] == pytest.approx(own.quantities[case.primary], rel=1e-6)
    loose = precision.vary(case, pose, {}, 1e-1, 10)
    assert loose.quantities[case.primary] > same.quantities[case.primary]
    with pytest.raises(ValueError, match="other particles"):
        precision.vary(case, pose, {"spacing": 0.07}, 1e-6, 10)


def test_errors_that_rounding_sets_apart_are_alike():
    """A second code on the same mesh, half as quick: its error is less by rounding only."""
    slower = replace(P, method="b", error=P.error * (1 - 1e-9), seconds=2.0, fast=1.9, slow=2.1)
    assert standings(P, slower) == ["front", "beaten"]
    better = replace(slower, error=P.error * (1 - 1e-2))
    assert standings(P, better) == ["front", "front"]
    assert set(precision.seconds_to([P, slower], slower.error)) == {"a", "b"}


def test_only_points_of_one_problem_are_compared():
    hole = replace(P, problem="hole", seconds=9.0, fast=8.0, slow=10.0)
    assert standings(P, hole) == ["front", "front"]
    plates = precision.methods_of(registry.get("free-plates"))
    assert {m.problem for m in plates} == {"mild 30°", "hole", "crack"}
    alone = "bond/lamina 0°"  # no other method solves that plate
    assert alone not in {m.name for m in plates}
    study = precision_chapter.Study([P, hole], [], "quick", 1, 2, 0.0, "now")
    shown = precision_chapter.sections(study, {"c": "A plate"}, {"c": "error"})
    assert [s["title"] for s in shown] == ["A plate", "A plate: hole"]
    assert len({s["id"] for s in shown}) == 2


def test_errors_that_are_shown_are_those_of_finite_elements_and_a_power_of_ten():
    errors = (5e-4, 4e-7, 3e-6)
    points = [replace(P, method="fem/P1", kind="fem", error=e) for e in errors]
    targets = precision_chapter._targets([P, *points])
    assert targets == pytest.approx([5e-4, 1e-6, 4e-7])
    assert precision_chapter._targets([P]) == [P.error]


def test_cases_of_the_study_are_tagged():
    names = {case.name for case in registry.select([precision.TAG])}
    assert {"disc-exponential", "crack-tip-I", "free-plates", "bimaterial-disc"} <= names
    assert any(name.startswith("hole") for name in names)


def test_files_and_the_chapter(tmp_path):
    points, _ = precision.measure([toy()], Level.QUICK, repeats=3)
    study = precision_chapter.Study(points, ["x: no"], "quick", 1, 2, 3.0, "now", {"commit": "c"})
    precision_chapter.write(study, tmp_path)
    assert precision_chapter.read(tmp_path) == study
    assert study.busy
    rows = list(csv.DictReader((tmp_path / "precision.csv").open()))
    assert [float(row["error"]) for row in rows] == [p.error for p in points]
    (section,) = precision_chapter.sections(study, {"toy": "A toy"}, {"toy": "error"})
    assert b"<svg" in section["picture"].content
    (tmp_path / precision_chapter.NAME).write_text(json.dumps({"format": 7}))
    with pytest.raises(ValueError, match="not of format 1"):
        precision_chapter.read(tmp_path)
    assert precision_chapter.read(tmp_path / "nowhere") is None


def test_the_command_refuses_what_it_does_not_know(tmp_path):
    given = ["precision", "disc-exponential", "--measure", "--method", "fem/P9"]
    found = CliRunner().invoke(app, [*given, "--out", str(tmp_path)])
    assert found.exit_code == 2
    assert "fem/P2" in found.output
