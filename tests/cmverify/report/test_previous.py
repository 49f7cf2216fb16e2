"""A run beside the one before it."""

import json
from dataclasses import replace

import pytest

from cmverify.report import numbers, previous, summary
from cmverify.report.build import build
from tests.cmverify.report.test_build import INFO, records
from tests.cmverify.toy_registry import toy, trapezium


def at(day: int):
    return replace(INFO, started=f"2026-01-{day:02d}T00:00:00")


def of(outcomes, run):
    return summary.summarise([toy()], records(outcomes), run)


def write(folder, outcomes, run):
    (folder / "results.json").write_text(summary.as_json(of(outcomes, run), run))


def test_what_moved_and_what_broke_is_told(tmp_path):
    write(tmp_path, {10: trapezium(10), 20: trapezium(20)}, at(1))
    previous.set_aside(tmp_path)
    assert not (tmp_path / "results.json").exists()
    now = of({10: trapezium(10), 20: trapezium(20, 1.01)}, at(2))
    page = build(now, at(2), tmp_path).read_text()
    assert "then 3 of 3 checks held in 1 case, now 1 of 3 in 1" in page
    assert "Held then, fail now" in page
    found = previous.compare(
        tmp_path, numbers.Results.model_validate_json(summary.as_json(now, at(2)))
    )
    (change,) = found.figures
    assert (change.method, change.where, change.quantity) == ("bond/trapezium", "a/20", "integral")
    assert change.ratio > 10
    assert found.common == 2
    assert found.time_ratio == pytest.approx(1.0)


def test_a_case_that_is_kept_is_not_compared_with_itself(tmp_path):
    write(tmp_path, {10: trapezium(10)}, at(1))
    previous.set_aside(tmp_path)
    kept = numbers.Results.model_validate_json(
        summary.as_json(of({10: trapezium(10)}, at(1)), at(2))
    )
    assert previous.compare(tmp_path, kept).common == 0


def test_no_run_before_and_one_that_cannot_be_read(tmp_path):
    previous.set_aside(tmp_path)
    judged = of({10: trapezium(10)}, INFO)
    assert "run before" not in build(judged, INFO, tmp_path).read_text().split("<main")[0]
    (tmp_path / previous.NAME).write_text(json.dumps({"format": 99}))
    page = build(judged, INFO, tmp_path).read_text()
    assert "is not of format 1: format" in page
