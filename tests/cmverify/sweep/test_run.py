"""Sweeps: one row a point, nothing done twice, nothing finished lost."""

import csv
import multiprocessing
import os
import signal
from collections import Counter
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cmverify.cli import app
from cmverify.exchange import budget
from cmverify.run import cluster
from cmverify.sweep import grid, run, work
from solver.analyses import statics
from tests.cmverify.sweep.test_grid import SCENE

GRID = {"m": [2, 3], "surface": ["volume", "none"]}


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "plate.toml"
    path.write_text(SCENE)
    return path


def states(listened):
    return Counter(state for _, state in listened)


def finished(folder: Path) -> Counter:
    lines = [line.split() for line in (folder / "sweep.log").read_text().splitlines()]
    return Counter(key for what, key, _ in lines if what == "finished")


@pytest.mark.parametrize("when", ["before", "meanwhile"])
def test_too_little_memory_is_no_answer_of_the_model(scene, tmp_path, monkeypatch, when):
    def none(*_, **__):
        raise MemoryError

    (tmp_path / "points").mkdir()
    (point,) = grid.points(scene, {"m": [2]})
    with monkeypatch.context() as patch:
        if when == "before":
            patch.setattr(budget, "free_memory", lambda: 1.0)
        else:
            patch.setattr(statics, "solve", none)
        with pytest.raises(ValueError, match="memory"):
            work.solve(point, str(tmp_path))
    assert work.load(tmp_path, point.key) is None
    assert work.solve(point, str(tmp_path))["refused"] == ""


def test_a_folder_of_the_same_name_is_no_shared_one(scene, tmp_path):
    (point,) = grid.points(scene, {"m": [2]})
    (tmp_path / "points").mkdir()
    work.save(tmp_path, {"key": point.key, "of": "another sweep"})
    with cluster.marked(tmp_path) as mark:
        assert work.solve(point, str(tmp_path), mark)["of"] == "another sweep"
    record = work.solve(point, str(tmp_path), "another head's")
    assert "of" not in record
    assert work.load(tmp_path, point.key) == {"key": point.key, "of": "another sweep"}
    assert not (tmp_path / "sweep.log").exists()


def test_one_row_a_point_and_none_twice(scene, tmp_path, monkeypatch):
    heard: list = []
    # In this process: two of its own are the next test's.
    monkeypatch.setattr(
        run, "on_processes", lambda todo, f, jobs: ((p, work.solve(p, str(f))) for p in todo)
    )
    out = tmp_path / "out"
    found = run.sweep(scene, GRID, out, listen=lambda *said: heard.append(said))
    assert states(heard) == {"done": 4}
    assert [(r["m"], r["surface"]) for r in found.rows] == [
        (2, "volume"), (2, "none"), (3, "volume"), (3, "none"),
    ]  # fmt: skip
    with open(out / "sweep.csv", encoding="utf-8") as stream:
        table = list(csv.DictReader(stream))
    assert [float(row["largest displacement"]) for row in table] == [
        row["largest displacement"] for row in found.rows
    ]
    heard.clear()
    # A finer grid takes what is there; a damaged record is done again.
    record = next((out / "points").glob("*.json"))
    record.write_text(record.read_text()[:50])
    wider = {**GRID, "m": [2, 3, 4]}
    again = run.sweep(scene, wider, out, listen=lambda *said: heard.append(said))
    assert states(heard) == {"reused": 3, "done": 3}
    assert len(again.rows) == 6
    assert sorted(finished(out).values()) == [1, 1, 1, 1, 1, 2]


def test_what_the_model_refuses_is_a_row(scene, tmp_path, monkeypatch):
    monkeypatch.setattr(
        run, "on_processes", lambda todo, f, jobs: ((p, work.solve(p, str(f))) for p in todo)
    )
    asked = {"material.nu": [0.2, 0.49], "material.plane": ["strain"]}
    found = run.sweep(scene, asked, tmp_path / "out")
    assert [bool(row["refused"]) for row in found.rows] == [False, True]
    assert "plate.toml" in found.rows[1]["refused"]
    assert not found.missing


def test_the_command_and_what_it_says(scene, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("sweep.toml").write_text('scene = "plate.toml"\n[grid]\nm = [2, 3]\n')
    invoke = CliRunner().invoke
    done = invoke(app, ["sweep", "sweep.toml", "--out", "out"])
    assert done.exit_code == 0, done.output
    assert "2 of 2 points are done" in done.output
    done = invoke(app, ["sweep", "sweep.toml", "--out", "out"])
    assert done.output.count("reused") == 2
    Path("bad.toml").write_text('scene = "plate.toml"\n[grid]\nm = 3\n')
    done = invoke(app, ["sweep", "bad.toml"])
    assert done.exit_code == 2
    assert "a list of values" in done.output
    assert "Traceback" not in done.output


@pytest.mark.slow
def test_a_process_is_killed_and_nothing_is_lost(scene, tmp_path):
    scene.write_text(SCENE.replace("spacing = 0.25", "spacing = 0.0125"))
    out, killed = tmp_path / "out", []

    def listen(point, state):
        if not killed and state == "done":
            child = multiprocessing.active_children()[0]
            killed.append(child.pid)
            child.kill()

    asked = {"m": [2, 3, 4], "material.nu": [0.1, 0.2]}
    found = run.sweep(scene, asked, out, jobs=2, listen=listen)
    assert killed
    assert len(found.rows) == 6
    assert not found.missing
    assert set(finished(out).values()) == {1}


def test_a_point_that_kills_its_process_is_given_up_alone(tmp_path, monkeypatch):
    """Pools are played here: which points are tried with which others."""
    tried: list[list[str]] = []

    def pool(todo, folder, workers, jobs):
        tried.append([point.key for point in todo])
        for point in todo:
            work.journal(folder, "started", point.key)
            if point.key == "bad":
                break
            work.journal(folder, "finished", point.key)
            yield point, {"key": point.key}
        lost = todo[[p.key for p in todo].index("bad") :] if "bad" in tried[-1] else []
        yield from ((point, None) for point in lost)

    monkeypatch.setattr(run, "_pool", pool)
    points = [grid.Point(key, {}, "", "", ()) for key in ("one", "bad", "two", "three")]
    done = {point.key: answer for point, answer in run.on_processes(points, tmp_path, 2)}
    assert done["bad"] == "its process died"
    assert all(done[key] == {"key": key} for key in ("one", "two", "three"))
    assert tried == [["one", "bad", "two", "three"], ["two", "three"], ["bad"]]


@pytest.mark.slow
def test_a_worker_of_a_cluster_is_killed_and_nothing_is_lost(scene, tmp_path):
    distributed = pytest.importorskip("distributed", reason="pip install 'cmverify[cluster]'")
    scene.write_text(SCENE.replace("spacing = 0.25", "spacing = 0.0125"))
    out = tmp_path / "out"
    killed: list[int] = []
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as cluster:
        with distributed.Client(cluster) as client:
            pids = list(client.run(os.getpid).values())

        def listen(point, state):
            if not killed and state == "done":
                os.kill(pids[0], signal.SIGKILL)
                killed.append(pids[0])

        asked = {"m": [2, 3, 4], "surface": ["volume", "none"], "material.nu": [0.1, 0.2]}
        found = run.sweep(scene, asked, out, dask=cluster.scheduler_address, listen=listen)
    assert killed
    assert len(found.rows) == 12
    assert not found.missing
    # Each was finished once; what was begun twice had been on the process that died.
    assert set(finished(out).values()) == {1}
    lines = [line.split() for line in (out / "sweep.log").read_text().splitlines()]
    begun = Counter(key for what, key, _ in lines if what == "started")
    lost = {key for what, key, who in lines if what == "started" and who.endswith(f":{killed[0]}")}
    assert {key for key, times in begun.items() if times > 1} <= lost
