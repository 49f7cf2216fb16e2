"""asv's result files as a page: what moved is drawn, everything is listed, nothing is fetched."""

import json
import math

import pytest
from typer.testing import CliRunner

from cmverify.cli import app
from cmverify.report import history
from tests.cmverify.report import browser

cli = CliRunner()


@pytest.fixture
def results(tmp_path):
    """Two commits, the later one written first; one benchmark with parameters, one that fails."""
    folder = tmp_path / "results"
    (folder / "vm").mkdir(parents=True)
    about = {"b.time_case": {"unit": "seconds"}, "version": 2}
    (folder / "benchmarks.json").write_text(json.dumps(about))
    (folder / "vm" / "machine.json").write_text("{}")
    for commit, date, fast, slow in (("b" * 40, 200, 1.0, 3.0), ("a" * 40, 100, 2.0, None)):
        data = {
            "version": 2, "commit_hash": commit, "date": date,
            "result_columns": ["result", "params", "version"],
            "results": {
                "b.time_case": [[fast, slow], [["'quick <1>'", "'slow'"]], "v"],
                "b.track_error": [[1e-3], [], "v"],
                "b.gone": [None, [], "v"],
            },
        }  # fmt: skip
        (folder / "vm" / f"{commit[:8]}-env.json").write_text(json.dumps(data))
    return folder


def test_series_follow_the_dates_of_their_commits(results):
    found = {(s.benchmark, s.parameters): s for s in history.read(results)}
    assert set(found) == {
        ("b.time_case", "quick <1>"), ("b.time_case", "slow"), ("b.track_error", "")
    }  # fmt: skip
    quick = found["b.time_case", "quick <1>"]
    assert quick.commits == ("a" * 8, "b" * 8)
    assert quick.values == (2.0, 1.0)
    assert (quick.unit, quick.ratio, quick.once) == ("seconds", 0.5, True)
    slow = found["b.time_case", "slow"]
    assert math.isnan(slow.values[0])
    assert slow.known == [("b" * 8, 3.0)]


def test_the_command_writes_a_page_that_stands_alone(results, tmp_path):
    given = ["history", "--results", str(results), "--out", str(tmp_path / "out")]
    done = cli.invoke(app, given)
    assert done.exit_code == 0, done.output
    page = tmp_path / "out" / history.NAME
    text = page.read_text(encoding="utf-8")
    assert browser.dead_links(page) == []
    assert "quick &lt;1&gt;" in text
    assert "2 commits on 1 machine" in text
    assert text.count("Measured once at each commit") == 1  # an error is the same however often
    assert text.count("<img") == 2
    if browser.find():
        seen = browser.look(page, 1400)
        assert seen["console"] == []
        assert seen["page"] <= seen["window"]
        assert seen["wide"] == []


def test_no_results_and_damaged_ones_are_refused(results, tmp_path):
    empty = cli.invoke(app, ["history", "--results", str(tmp_path / "none")])
    assert empty.exit_code == 2
    assert "asv run" in empty.output
    path = next((results / "vm").glob("*-env.json"))
    path.write_text('{"version": 1}')
    with pytest.raises(ValueError, match="version 2"):
        history.read(results)
    path.write_text("[")
    with pytest.raises(ValueError, match="cannot be read"):
        history.read(results)
