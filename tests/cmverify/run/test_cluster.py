"""Cases on a Dask cluster: nothing finished is lost with a worker, nothing is done twice."""

import dataclasses
import os
import signal
from collections import Counter

import pytest
from typer.testing import CliRunner

from cmverify.case import Level
from cmverify.cli import app
from cmverify.run import cluster, results, runner, worker
from tests.cmverify import toy_registry


def measured(folder, name="toy", n=10, fingerprint=None, mark=None, threads=1):
    code = fingerprint or results.source_fingerprint()
    given = (toy_registry.__name__, name, "bond/trapezium", n, str(folder))
    if mark is not None or not folder.is_dir():
        return worker.measured(*given, mark or "none", threads, code)
    with cluster.marked(folder) as own:
        return worker.measured(*given, own, threads, code)


def log(folder):
    lines = [line.split() for line in (folder / worker.LOG).read_text().splitlines()]
    return Counter((what, key) for what, key, _ in lines)


def test_a_worker_looks_first_whether_it_is_done(tmp_path):
    first = measured(tmp_path)
    assert measured(tmp_path).wall_seconds == first.wall_seconds
    assert sorted(log(tmp_path).values()) == [1, 1]
    # Of other code it is no record, and other code's workers measure nothing.
    path = results.stem(tmp_path, "toy", "bond/trapezium", 10).with_suffix(".json")
    path.write_text(path.read_text().replace(first.fingerprint, "0" * len(first.fingerprint)))
    measured(tmp_path)
    assert sorted(log(tmp_path).values()) == [2, 2]
    with pytest.raises(RuntimeError, match="another version"):
        measured(tmp_path, fingerprint="other")


def test_a_worker_with_other_disks_gives_the_record_back(tmp_path):
    record = measured(tmp_path / "nowhere")
    assert not record.failed
    assert not list(tmp_path.iterdir())


def test_a_folder_of_the_same_name_is_no_shared_one(tmp_path):
    """Another machine's disk may have such a folder, with an earlier run's records in it."""
    first = measured(tmp_path)
    before = {path: path.read_bytes() for path in sorted(tmp_path.rglob("*")) if path.is_file()}
    again = measured(tmp_path, mark="another head's")
    assert not again.failed
    assert again.wall_seconds != first.wall_seconds
    assert before == {p: p.read_bytes() for p in sorted(tmp_path.rglob("*")) if p.is_file()}
    # The mark of a run that was killed goes with the next one.
    (tmp_path / ".shared-old").write_text("old")
    with cluster.marked(tmp_path) as mark:
        assert cluster.is_shared(tmp_path, mark)
        assert not cluster.is_shared(tmp_path, "old")
        (tmp_path / f".shared-{mark}").write_text("of another head")
        assert not cluster.is_shared(tmp_path, mark)
    assert not list(tmp_path.glob(".shared-*"))


def test_records_of_other_thread_counts_are_measured_anew(tmp_path):
    first = measured(tmp_path)
    assert first.threads == 1
    path = results.stem(tmp_path, "toy", "bond/trapezium", 10).with_suffix(".json")
    results.save(dataclasses.replace(first, threads=7), tmp_path)
    assert measured(tmp_path).threads == 1
    assert results.load(path).threads == 1
    before = cluster.threads_here()
    with worker.at_most(1) as used:
        assert used == cluster.threads_here() == 1
    assert cluster.threads_here() == before


def test_no_scheduler_is_a_wrong_request(tmp_path, monkeypatch):
    monkeypatch.setattr(cluster, "find_spec", lambda name: None)
    found = CliRunner().invoke(app, ["run", "patch", "--dask", "x", "--out", str(tmp_path / "o")])
    assert found.exit_code == 2
    assert "cmverify[cluster]" in found.output
    assert not (tmp_path / "o").exists()


def test_an_address_that_nobody_answers_at_is_told():
    pytest.importorskip("distributed", reason="pip install 'cmverify[cluster]'")
    for address in ("tcp://127.0.0.1:1", "nonsense://x"):
        with pytest.raises(cluster.ClusterError, match="no Dask scheduler answers"):
            cluster.connected(address, timeout=0.5)


@pytest.mark.slow
def test_a_worker_is_killed_and_nothing_is_lost_or_done_twice(tmp_path):
    distributed = pytest.importorskip("distributed", reason="pip install 'cmverify[cluster]'")
    killed: list[int] = []
    kinds: list[str] = []
    cases = [toy_registry.CASES[name] for name in ("napping", "toy", "raising")]
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as local:
        with distributed.Client(local) as client:
            pids = list(client.run(os.getpid).values())

        def listen(event):
            kinds.append(event.kind)
            if not killed:
                os.kill(pids[0], signal.SIGKILL)
                killed.append(pids[0])

        given = {"registry": toy_registry.__name__, "dask": local.scheduler_address}
        records = runner.run(cases, Level.STANDARD, tmp_path, listen=listen, **given)
        assert [(r.case, r.resolution, r.failed) for r in records] == [
            (case.name, n, case.name == "raising") for case in cases for n in (10, 20, 40)
        ]
        assert Counter(kinds) == {"finished": 6, "failed": 3}
        told = log(tmp_path)
        assert {count for (what, _), count in told.items() if what == "finished"} == {1}
        (threads,) = {r.threads for r in records}
        other = next(r for r in records if not r.failed)
        # As a run of this machine's own processes might have left it.
        results.save(dataclasses.replace(other, threads=threads + 1), tmp_path)
        kinds.clear()
        runner.run(cases, Level.STANDARD, tmp_path, resume=True, listen=listen, **given)
        assert Counter(kinds) == {"reused": 5, "finished": 1, "failed": 3}
        # What has been finished is not sent again.
        kinds.clear()
        runner.run(cases, Level.STANDARD, tmp_path, resume=True, listen=listen, **given)
        assert Counter(kinds) == {"reused": 6, "failed": 3}
