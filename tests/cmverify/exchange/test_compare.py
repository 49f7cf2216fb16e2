"""An answer is judged by the case's norms and bounds, beside ours, and a wrong one fails."""

import json
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

from cmverify.case import Level
from cmverify.cases import registry
from cmverify.cli import app
from cmverify.exchange import compare
from cmverify.exchange.answers import Answer, AnswerError
from cmverify.judge.verdict import judge
from cmverify.report.numbers import read

HOLE = registry.get("hole-tractions-isotropic")
POSE = HOLE.poses[0]
N = 20


@pytest.fixture(scope="module")
def ours():
    return compare.our_record(HOLE, POSE, N, None)


@pytest.fixture(scope="module")
def exact():
    target = POSE.state(N).targets[0]
    return Answer("exact", {"displacement": target.reference}, target.points, seconds=0.1)


def verdicts(found):
    outcomes = {record.method: {found.resolution: record.outcome} for record in found.records}
    return judge(found.case, outcomes)


def test_an_exact_answer_passes_and_one_per_cent_is_seen(ours, exact):
    found = compare.compare(HOLE, POSE, N, [exact], ours)
    assert all(v.passed for v in verdicts(found))
    assert found.absent == {"exact": ("stress",)}
    twisted = np.stack([exact.points[:, 0] ** 2, 0.0 * exact.points[:, 0]], axis=-1)
    spoiled = Answer("bad", {"displacement": exact.values["displacement"] + twisted}, exact.points)
    found = compare.compare(HOLE, POSE, N, [exact, spoiled], ours)
    failed = [v for v in verdicts(found) if not v.passed]
    assert [(v.method, v.quantity) for v in failed] == [("bad", "displacement")]
    scaled = Answer("more", {"displacement": 1.01 * exact.values["displacement"]}, exact.points)
    error = compare.score(POSE.state(N), scaled).quantities["displacement"]
    assert error == pytest.approx(0.01, rel=1e-6)


def test_our_own_answer_scores_what_our_run_says(ours):
    from cmverify.cases.surfaces.round import Problem, scene_of

    solution = scene_of(Problem("hole", "isotropic"), "extrapolated", 5, N).solve(tolerance=1e-11)
    answer = Answer("same", {"displacement": solution.displacement}, solution.points)
    scored = compare.score(POSE.state(N), answer).quantities["displacement"]
    assert scored == pytest.approx(ours.outcome.quantities["displacement"], rel=1e-6)


def test_bounds_of_another_method_and_none_at_all(ours, exact):
    with pytest.raises(ValueError, match="no bound of bond/none"):
        compare.compare(HOLE, POSE, N, [exact], ours, "bond/none")
    with pytest.raises(ValueError, match="no method 'fem/P7'"):
        compare.compare(HOLE, POSE, N, [exact], ours, "fem/P7")
    with pytest.raises(AnswerError, match="same name"):
        compare.compare(HOLE, POSE, N, [exact, exact], ours)


def test_the_resolution_is_a_level_s_finest_or_what_is_said():
    assert compare.resolution_of(HOLE, POSE, Level.PAPER, None) == 100
    assert compare.resolution_of(HOLE, POSE, Level.PAPER, 7) == 7
    with pytest.raises(ValueError, match="positive n"):
        compare.resolution_of(HOLE, POSE, Level.QUICK, 0)


def test_numbers_are_judged_too(tmp_path, monkeypatch):
    """Frequencies, from the command line: one off by a tenth fails and the exit code says so."""
    monkeypatch.chdir(tmp_path)
    case = registry.get("free-plates")
    target = case.poses[0].state(24).targets[0]
    good, bad = tmp_path / "good.json", tmp_path / "bad.csv"
    good.write_text(json.dumps({"frequencies": target.reference.tolist(), "seconds": 0.5}))
    wrong = target.reference * np.where(np.arange(len(target.reference)) == 3, 1.1, 1.0)
    np.savetxt(bad, wrong, header="frequencies", comments="")
    run = CliRunner().invoke
    done = run(app, ["compare", "free-plates", "good.json"])
    assert done.exit_code == 0, done.output
    path = tmp_path / "comparison" / "results.json"
    numbers = json.loads(path.read_text(encoding="utf-8"))
    # Of the format that `report --schema` tells.
    assert {m.kind for m in read(path).cases["free-plates"].measurements} == {"bond", "other"}
    rows = numbers["cases"]["free-plates"]["measurements"]
    assert {row["method"] for row in rows} == {"bond/mild 30°", "good"}
    assert (tmp_path / "comparison" / "index.html").is_file()
    done = run(app, ["compare", "free-plates", "mine=bad.csv", "--out", "other"])
    assert done.exit_code == 1
    assert "mine" in done.output


def test_bad_requests_end_with_a_line_and_code_two(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    np.savez("empty.npz", points=np.ones((3, 2)))
    run = CliRunner().invoke
    for arguments, said in (
        (["compare", "disc-cubic", "empty.npz"], "lacks temperature"),
        (["compare", "disc-cubic", "gone.vtu"], "no such file"),
        (["compare", "particle-counts", "empty.npz"], "poses none"),
        (["export", "disc-qubic"], "did you mean"),
        (["export", "free-plates", "--problem", "star"], "no problem 'star'"),
    ):
        done = run(app, arguments)
        assert done.exit_code == 2, done.output
        assert said in done.output
        assert "Traceback" not in done.output
    assert "lamb" in run(app, ["export"]).output


def test_crack_angles_and_paths_are_judged(ours, tmp_path):
    from cmverify.cases.kinking.angles import straight
    from cmverify.exchange import answers

    case = registry.get("kinking-anisotropic")
    pose = next(pose for pose in case.poses if pose.name == "mixity 45°")
    targets = pose.state(30).targets
    right = float(targets[0].reference[0])
    given = []
    for name, off in (("right", 0.0), ("near", 5.0), ("off", 13.0)):
        # With the old crack before it, and beyond where it is judged.
        path = np.vstack([[[-1.0, 0.0]], straight(right + off, 0.6)])
        np.savez(tmp_path / f"{name}.npz", path=path)
        given.append(answers.read(tmp_path / f"{name}.npz", targets))
    found = compare.compare(case, pose, 30, given, replace(ours, method=pose.method))
    errors = {r.method: r.outcome.quantities for r in found.records[1:]}
    assert [errors[n]["largest"] for n in errors] == pytest.approx([0.0, 5.0, 13.0], abs=1e-9)
    chord = [2 * 0.25 * np.sin(np.radians(off / 2)) for off in (0.0, 5.0, 13.0)]
    assert [errors[n]["path"] for n in errors] == pytest.approx(chord, abs=1e-3)
    failed = {(v.method, v.quantity) for v in verdicts(found) if not v.passed}
    assert {f for f in failed if f[0] in errors} == {("off", "largest")}
    assert found.records[1].outcome.lines[0].curves[0].label == "right"
    np.savez(tmp_path / "short.npz", path=straight(right, 0.1))
    with pytest.raises(AnswerError, match=r"ends 0\.1 from the old tip"):
        answers.read(tmp_path / "short.npz", targets)
