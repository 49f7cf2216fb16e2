"""Worker processes: results on disk at once, failures that stay failures, resume."""

import os
from dataclasses import replace

import pytest

from cmverify.case import Failed, Level
from cmverify.run import results, runner
from cmverify.run.threads import (
    VARIABLES,
    available_cores,
    thread_environment,
    threads_per_worker,
)
from tests.cmverify import toy_registry
from tests.cmverify.toy_registry import CASES

REGISTRY = toy_registry.__name__


def run(names, folder, **options):
    events = []
    cases = [CASES[name] for name in names]
    records = runner.run(
        cases, Level.QUICK, folder, listen=events.append, registry=REGISTRY, **options
    )
    return records, [event.kind for event in events]


def test_two_workers_measure_everything(tmp_path):
    records, kinds = run(["toy", "napping"], tmp_path, jobs=2)
    assert [(r.case, r.resolution) for r in records] == [
        ("toy", 10), ("toy", 20), ("napping", 10), ("napping", 20),
    ]  # fmt: skip
    assert not any(r.failed for r in records)
    assert kinds.count("finished") == 4
    assert all(r.threads == threads_per_worker(2) for r in records)


def test_a_method_that_raises_is_a_recorded_failure(tmp_path):
    records, kinds = run(["raising", "toy"], tmp_path, jobs=1)
    failures = [r.outcome for r in records if r.failed]
    assert [f.message for f in failures] == [f"no luck at {n} [/brackets]" for n in (10, 20)]
    assert all(f.error == "ArithmeticError" and "raises" in f.traceback for f in failures)
    assert kinds.count("finished") == 2


def test_no_worker_is_started_for_nothing(tmp_path, monkeypatch):
    started, start = [], runner._start
    monkeypatch.setattr(runner, "_start", lambda *a: started.append(1) or start(*a))
    _, kinds = run(["toy"], tmp_path, jobs=7)
    assert kinds.count("finished") == 2
    assert len(started) == 2
    assert run(["toy"], tmp_path, jobs=7, resume=True)[1] == ["reused"] * 2
    assert len(started) == 2


def test_a_worker_that_dies_costs_only_its_task(tmp_path):
    records, kinds = run(["dying", "toy"], tmp_path, jobs=1)
    failures = [r.outcome for r in records if r.failed]
    assert len(failures) == 2
    assert all(isinstance(f, Failed) and "exit code 7" in f.message for f in failures)
    assert kinds.count("finished") == 2


def test_a_measurement_that_takes_too_long_is_given_up(tmp_path):
    records, kinds = run(["sleeping"], tmp_path, jobs=1, timeout=2.0)
    assert [r.outcome.error for r in records] == ["TimeoutError"] * 2
    assert kinds == ["started", "failed"] * 2  # the killed worker was replaced


def test_resume_reuses_what_the_same_code_measured(tmp_path):
    run(["toy"], tmp_path)
    results.stem(tmp_path, "toy", "bond/trapezium", 20).with_suffix(".json").unlink()
    records, kinds = run(["toy"], tmp_path, resume=True)
    assert kinds == ["reused", "started", "finished"]
    assert len(records) == 2


def test_resume_does_not_trust_other_code_or_failures(tmp_path):
    path = results.stem(tmp_path, "toy", "bond/trapezium", 10).with_suffix(".json")
    run(["toy", "raising"], tmp_path)
    results.save(replace(results.load(path), fingerprint="other code"), tmp_path)
    _, kinds = run(["toy", "raising"], tmp_path, resume=True)
    assert kinds.count("reused") == 1
    assert kinds.count("failed") == 2


def test_a_killed_run_keeps_what_was_finished(tmp_path):
    def stop(event):
        if event.kind == "finished":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        runner.run([CASES["napping"]], Level.QUICK, tmp_path, listen=stop, registry=REGISTRY)
    assert [r.resolution for r in results.load_all(tmp_path)] == [20]  # longest first


def test_threads_are_divided_and_the_environment_is_left_alone(tmp_path):
    cores = available_cores()
    assert threads_per_worker(1) == cores
    assert threads_per_worker(10 * cores) == 1
    assert set(thread_environment(3).values()) == {"3"}
    before = {name: os.environ.get(name) for name in VARIABLES}
    run(["toy"], tmp_path)
    assert before == {name: os.environ.get(name) for name in VARIABLES}
    with pytest.raises(ValueError, match="at least one job"):
        threads_per_worker(0)
