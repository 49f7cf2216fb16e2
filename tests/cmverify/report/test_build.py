"""The report: self-contained, complete, and honest about failures."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cmverify.case import Failed
from cmverify.report import figures, maps, summary
from cmverify.report.build import build
from cmverify.run import results
from tests.cmverify.toy_registry import toy, trapezium

INFO = summary.RunInfo("quick", 2, 1, "cmverify run", "2026-01-01T00:00:00", 1.0, {
    "processor": "p", "cores": 2, "memory_gb": 8.0, "system": "s", "python": "CPython 3",
    "versions": {"numpy": "2"}, "commit": "abc",
})  # fmt: skip


def records(outcomes):
    return [
        results.Record("toy", "bond/trapezium", n, outcome, 1, 0.1, "code")
        for n, outcome in outcomes.items()
    ]


def report(tmp_path: Path, outcomes) -> str:
    judged = summary.summarise([toy()], records(outcomes))
    return build(judged, INFO, tmp_path).read_text()


def test_the_page_holds_everything_it_shows(tmp_path):
    page = report(tmp_path, {10: trapezium(10), 20: trapezium(20)})
    assert "All 3 checks of 1 case hold" in page
    sources = re.findall(r'(?:src|href)="([^"#]+)"', page)
    outside = [s for s in sources if not s.startswith("data:")]
    assert len(list((tmp_path / "figures").iterdir())) == 4
    assert all((tmp_path / s).is_file() for s in outside)  # fields to download, nothing else
    assert not re.search(r"https?://", re.sub(r'"data:[^"]*"', "", page))
    main = page[page.index("<main") :]  # the opening page shows some of them too
    assert main.count('src="data:image/svg') == 3  # convergence, error against time, one line
    assert len(re.findall('src="data:image/(png|webp)', main)) == 1
    assert all(alt for alt in re.findall(r'<img [^>]*alt="([^"]*)"', page))
    assert "cmverify run toy --level quick" in page


def test_failures_come_first_and_with_their_message(tmp_path):
    failed = Failed("ArithmeticError", "no <luck>", "Traceback …")
    page = report(tmp_path, {10: trapezium(10, 1.01), 20: failed})
    assert "checks fail" in page
    assert "no &lt;luck&gt;" in page
    failing = page[
        page.index('id="failing"') : page.index("</section>", page.index('id="failing"'))
    ]
    verdicts = re.findall(r'<td class="verdict">(.*?)</td>', failing)
    assert verdicts.count("✗ crashed") == 1
    assert set(verdicts) == {"✗ crashed", "✗ fails"}
    case = page[page.index('<section id="toy">') :]
    assert re.findall(r'<td class="verdict">(.*?)</td>', case)[0].startswith("✗")


def test_a_run_without_cases_is_no_success(tmp_path):
    assert "Nothing was judged" in build([], INFO, tmp_path).read_text()
    assert not summary.all_passed([])


def test_json_has_every_number_and_no_nan(tmp_path):
    outcomes = {10: trapezium(10), 20: Failed("E", "m")}
    judged = summary.summarise([toy()], records(outcomes))
    data = json.loads(summary.as_json(judged, INFO))
    case = data["cases"]["toy"]
    assert data["passed"] is False
    assert case["measurements"][0]["quantities"]["integral"] > 0
    assert case["measurements"][1]["failure"]["message"] == "m"
    assert len(case["work_precision"]) == 1


def test_what_the_solver_said_is_on_the_page_and_in_the_numbers(tmp_path):
    said = replace(trapezium(10), warnings=("thin <members>", "a layer"))
    more = replace(trapezium(20), warnings=("thin <members>",))
    page = report(tmp_path, {10: said, 20: more})
    assert "says of these scenes (2)" in page
    assert page.count("thin &lt;members&gt;") == 1
    assert "bond/trapezium, a/10; bond/trapezium, a/20" in page
    assert "says of these scenes" not in report(tmp_path, {10: trapezium(10)})
    judged = summary.summarise([toy()], records({10: said}))
    (row,) = json.loads(summary.as_json(judged, INFO))["cases"]["toy"]["measurements"]
    assert row["warnings"] == list(said.warnings)


def test_run_information_round_trips(tmp_path):
    summary.save_info(INFO, tmp_path)
    assert summary.load_info(tmp_path) == INFO
    with pytest.raises(ValueError, match="holds no finished run"):
        summary.load_info(tmp_path / "none")


def test_lattice_values_become_an_image():
    points = np.array([[0.05, 0.05], [0.15, 0.05], [0.05, 0.15]])
    image, extent = maps.as_image(points, np.array([1.0, 2.0, 3.0]), 0.1)
    np.testing.assert_array_equal(image, [[1.0, 2.0], [3.0, np.nan]])
    assert extent == pytest.approx((0.0, 0.2, 0.0, 0.2))


def test_markers_follow_the_drawn_curve():
    x = np.linspace(0.01, 1.0, 500)
    shown = figures.markers(x, 1.0 / x, count=20)
    assert shown[0] == 0
    assert shown[-1] == 499
    assert np.diff(shown).min() == 1  # every particle where it is steep
    assert 10 <= len(shown) <= 20
    assert list(figures.markers(x[:5], x[:5])) == [0, 1, 2, 3, 4]


def test_methods_stand_beside_each_other():
    """One reference line and the first curve of every method, each in its own colour."""
    from cmverify.case import Curve, LinePlot

    x = np.linspace(0.0, 1.0, 5)

    def plot(shift):
        curve = Curve("f", x, x + shift, x)
        return LinePlot("f", "x", "f", (curve,), over_methods=True, reference_label="truth")

    methods = {"bond/none": plot(0.2), "bond/volume": plot(0.1), "bond/extrapolated": plot(0.0)}
    line = methods["bond/extrapolated"]
    (axis,) = figures.line_plot(line, {10: line}, methods=methods).axes
    assert axis.get_legend_handles_labels()[1] == ["truth", *methods]
    np.testing.assert_allclose(axis.lines[1].get_ydata(), x + 0.2)
    assert len({tuple(drawn.get_color()) for drawn in axis.lines}) == 4


def test_a_case_whose_featured_method_is_not_measured_shows_another(tmp_path):
    """As at a quick level, where a cheaper method stands for it."""
    case = toy()
    other = replace(case.methods[0], name="dearer")
    case = replace(case, methods=(other, *case.methods), featured="dearer")
    (judged,) = summary.summarise([case], records({10: trapezium(10), 20: trapezium(20)}))
    assert judged.featured == toy().methods[0].name
    page = build([judged], INFO, tmp_path).read_text()
    main = page[page.index("<main") :]
    assert main.count('src="data:image/svg') == 3
    assert len(re.findall('src="data:image/(png|webp)', main)) == 1


@pytest.mark.parametrize("low", [1e-17, 1.2e-3, 2.0e-3, 3.1e-1, 9.6e2])
@pytest.mark.parametrize("span", [1.03, 1.4, 2.0, 7.0, 1e3, 1e12])
def test_every_log_axis_has_two_labelled_ticks_that_differ(low, span):
    """A reader tells the scale of an axis from two numbers on it."""
    from matplotlib.figure import Figure

    axis = Figure().subplots()
    axis.set(xscale="log", xlim=(low, low * span))
    figures._decades(axis.xaxis)
    ticks = axis.xaxis.get_majorticklocs()
    shown = [t for t in ticks if low * (1 - 1e-9) <= t <= low * span * (1 + 1e-9)]
    labels = {figures._log_label(t, "") for t in shown}
    assert len(labels) == len(shown) >= 2
    assert len(shown) <= 10


def test_legends_have_no_loose_commas():
    from cmverify.judge.precision import Point

    points = [Point("bond/one", "bond", 10, 9, 1.0, 1e-3)]
    (axis,) = figures.convergence_plot(toy(), points).axes
    assert axis.get_legend_handles_labels()[1] == ["bond/one"]
