"""The opening page: counts that agree, the best figure, and a run that goes wrong."""

from dataclasses import replace

from cmverify.case import Failed
from cmverify.report import opening, summary
from cmverify.report.build import build
from tests.cmverify.report.test_build import INFO, records, report
from tests.cmverify.toy_registry import toy, trapezium


def judged(outcomes):
    return summary.summarise([toy()], records(outcomes))


def test_the_best_figure_is_one_that_holds():
    (line,) = opening.lines(judged({10: trapezium(10), 20: trapezium(20)}))
    assert line.counts.good_checks == line.counts.checks == 3
    assert line.best.where == "a/20"
    assert line.best.value == trapezium(20).quantities["integral"]
    (line,) = opening.lines(judged({10: trapezium(10, 1.01), 20: trapezium(20, 1.01)}))
    assert line.best is None


def test_a_crash_drops_out_of_no_count(tmp_path):
    good, bad = judged({10: trapezium(10), 20: trapezium(20)}), judged(
        {10: trapezium(10), 20: Failed("E", "m")}
    )  # fmt: skip
    before, after = summary.tally(good), summary.tally(bad)
    assert (before.checks, before.measurements) == (after.checks, after.measurements) == (3, 2)
    assert after.good_checks == 1
    assert after.crashed == 1
    assert after.sentence == "2 of 3 checks fail; 1 measurement crashed."
    page = build(bad, INFO, tmp_path).read_text()
    assert after.sentence in page
    assert "1 of 3" in page
    assert "2 measurements, 1 crashed" in page.replace("<b>", "").replace("</b>", "")
    assert "bond/trapezium crashed at a/20: E: m" in page


def test_a_nan_is_an_incident_and_no_check():
    wrong = replace(trapezium(10), seconds={"setup": float("nan"), "solve": 1.0})
    counts = summary.tally(judged({10: wrong, 20: trapezium(20)}))
    assert counts.checks == counts.good_checks == 3
    assert not counts.passed
    assert counts.sentence == "3 checks hold, but not every case is sound."


def test_a_page_of_nothing_and_of_one(tmp_path):
    assert opening.lines([]) == []
    page = report(tmp_path, {10: trapezium(10)})
    assert "All 1 check of 1 case hold" in page or "1 check" in page
