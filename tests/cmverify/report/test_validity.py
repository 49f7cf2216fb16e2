"""The matrix says what checks cover, and shows what they do not."""

import json
import re
from dataclasses import replace
from pathlib import Path

from cmverify.case import Level, Method, Setting
from cmverify.cases import registry
from cmverify.report import summary, validity
from cmverify.report.build import build
from cmverify.report.wording import tidy
from cmverify.run.worker import measure
from solver import ConductivityTensor, Scene, Support, rectangle
from tests.cmverify.report.test_build import INFO, records
from tests.cmverify.toy_registry import toy, trapezium

DOCUMENTED = Path(__file__).parents[3] / "docs" / "validity.json"
BOUND = re.compile(r"(\S+): (.+) ≤ (\S+) at .+/(\d+) \(\S+\)")
VOLUME = Setting("elasticity", "lattice", "volume", 5.0, "constant")
EXTRAPOLATED = Setting("heat conduction", "positive", "extrapolated", 2.5, "conical")


def judged(*scenes, scale=1.0):
    outcomes = {n: replace(trapezium(n, scale), scenes=scenes) for n in (10, 20)}
    return summary.summarise([toy()], records(outcomes))


def test_checks_count_where_their_scenes_are():
    found = validity.matrix(judged(VOLUME))
    assert found.covered == 1
    cell = found.at(("elasticity", "lattice"), ("volume", "5"))
    assert (cell.held, len(cell.verdicts), cell.cases) == (3, 3, ["toy"])
    assert cell.narrowest.asked == "≤ 0.00085"
    assert found.at(("elasticity", "lattice"), ("none", "5")) is None
    assert found.places == 9 * 12


def test_a_measurement_of_several_scenes_counts_for_each():
    found = validity.matrix(judged(VOLUME, EXTRAPOLATED, scale=1.01))
    other = found.at(("heat conduction", "positive"), ("extrapolated", "other"))
    assert found.covered == 2
    assert other.held == 0
    empty = [line for line in validity.as_data(found) if line["held"] == "0"]
    assert len(empty) == found.places - 2


def test_the_page_shows_empty_places(tmp_path):
    page = build(judged(VOLUME), INFO, tmp_path).read_text()
    assert page.count("nothing covers this") == 9 * 12 - 1
    assert "1 of 108" in page
    assert "Validity" not in build(judged(), INFO, tmp_path).read_text()


def test_the_documentation_shows_places_and_cases_that_are():
    """Made by `cmverify validity --json`; a case that is renamed must be renamed there."""
    places = json.loads(DOCUMENTED.read_text(encoding="utf-8"))
    wanted = {(p, c, t, m) for (p, c), (t, m) in empty_places()}
    found = [(one["physics"], one["calibration"], one["treatment"], one["m"]) for one in places]
    assert wanted <= set(found)
    assert len(set(found)) == len(found)
    named = {name for one in places for name in one["cases"].split(", ") if name}
    assert named <= {case.name for case in registry.all_cases()}
    assert any(one["held"] == "0" for one in places)  # if nothing is empty, the page says too much
    for one in places:
        held, _, asked = one["held"].partition("/")
        assert held == (asked or "0"), f"the documentation shows a check that fails: {one}"


def test_the_documentation_shows_bounds_that_are_declared():
    """A bound that is changed must be changed there: by a run, as the page says."""
    cases = {case.name: case for case in registry.all_cases()}
    said = {one["bound"] for one in json.loads(DOCUMENTED.read_text(encoding="utf-8"))} - {""}
    assert len(said) > 10
    for text in said:
        name, quantity, bound, n = BOUND.fullmatch(text).groups()
        declared = {
            tidy(f"{check.bound_at(int(n)):.2g}")
            for check in cases[name].checks
            if check.quantity == quantity and check.bound_at(int(n)) is not None
        }
        assert bound in declared, text


def empty_places():
    found = validity.matrix([])
    return [(row, column) for row in found.rows for column in found.columns]


def test_a_measurement_knows_what_it_solved():
    def solve(n):
        for m in (3, 2, 3):
            Scene(
                rectangle(9.0, 9.0), 1.0, ConductivityTensor.isotropic(1.0), m=m,
                supports=[Support.where(lambda x, y: abs(x) > 3.0, temperature=0.0)],
            ).solve()  # fmt: skip
        return trapezium(n)

    scenes = measure(Method("m", "bond", solve, {Level.QUICK: (10,)}), 10).scenes
    assert scenes == tuple(
        Setting("heat conduction", "lattice", "volume", float(m), "constant") for m in (3, 2)
    )
