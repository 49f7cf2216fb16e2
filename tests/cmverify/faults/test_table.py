"""The fault table: targets that exist, catches that are catches, a map that is true."""

import numpy as np
import pytest
from typer.testing import CliRunner

from cmverify.case import Level
from cmverify.cases import registry as cases
from cmverify.cli import app
from cmverify.faults import page, registry, table, trial
from cmverify.faults.changes import result, scaled
from cmverify.faults.fault import Fault, find
from cmverify.faults.trial import Found
from solver import Load, rectangle
from solver.geometry import Lattice
from tests.cmverify.report import browser

NORM = "cmverify.judge.norms.relative_l2"
PAIR = ("yardsticks", "judges")


@pytest.fixture(scope="module")
def sound():
    return trial.sound(PAIR)


def attempt(change, sound, target=NORM):
    return trial.attempt(Fault("of a test", target, change, "tests"), PAIR, sound)


def test_every_fault_has_a_target_and_a_name_of_its_own():
    faults = registry.all_faults()
    assert len(faults) > 100
    assert len({f.name for f in faults}) == len(faults)
    for fault in faults:
        find(fault.target)


def test_loads_that_are_made_wrong_still_act():
    """A fault that cannot be run at all is caught by whatever runs it, and shows nothing."""
    changed = {
        "solver.problem.loads.Load.source": Load.source,
        "solver.problem.loads.Load.couple": Load.couple,
        "solver.problem.loads.Load.body_force": Load.body_force,
    }
    lattice = Lattice(rectangle(1.0, 1.0), 0.25, 2)
    faults = [f for f in registry.all_faults() if f.target in changed]
    assert len(faults) > 2
    for fault in faults:
        value = (1.0, 2.0) if fault.target.endswith("force") else 1.0
        mask, density = fault.change(changed[fault.target])(value).density(lattice, True, None)
        assert mask.all()
        assert not np.allclose(density, value)


def test_few_faults_are_argued_and_none_of_those_that_must_be_caught():
    argued = [f for f in registry.all_faults() if f.harmless]
    assert len(argued) <= 5
    for fault in argued:
        assert len(fault.harmless) > 30
        assert not any(word in fault.name for word in ("NaN", "sign", "swapped"))


def test_a_fault_is_caught_by_the_check_that_sees_it(sound):
    found = attempt(scaled(0.5), sound)
    assert found.caught.startswith("one per cent")
    assert found.moved
    assert found.called


def test_a_fault_that_changes_nothing_is_not_caught(sound):
    found = attempt(scaled(1.0), sound)
    assert found == Found(*PAIR, "", False, True)
    elsewhere = attempt(scaled(2.0), sound, "references.analytic.compact_tension.shape_factor")
    assert elsewhere == Found(*PAIR, "", False, False)


def test_a_fault_that_moves_a_figure_within_its_bound_is_told(sound):
    found = attempt(scaled(1.0 + 1e-10), sound)
    assert (found.caught, found.moved) == ("", True)


def test_judges_are_wrong_while_they_judge(sound):
    always = result(lambda verdicts: [v for v in verdicts if False])
    assert not attempt(always, sound, "cmverify.judge.verdict.judge").caught
    raised = attempt(lambda right: lambda *a: 1 / 0, sound)
    assert "ZeroDivisionError" in raised.caught


def test_a_search_stops_when_enough_cases_have_caught_it(sound):
    plan = [(PAIR, sound), (PAIR, sound)]
    assert len(trial.search("every error halved", plan, enough=1)) == 1
    # A second method of the same case is not asked.
    assert len(trial.search("every error halved", plan, enough=2)) == 1


def test_a_search_spends_no_more_than_it_may(sound):
    plan = [(PAIR, sound)]
    assert trial.search("every error halved", plan, seconds=0.5 * sound.seconds) == []
    known = [Found("another", "m", "seen", True, True)]
    found = trial.search("every error halved", plan, enough=2, found=known)
    assert [f.case for f in found] == ["another", PAIR[0]]


def test_targets_that_are_called_are_counted(sound):
    assert NORM in sound.called
    assert "solver.recovery.stress" not in sound.called


def test_states():
    fault = Fault("f", NORM, scaled(2.0), "tests")
    states = [
        table.Result(fault, (Found("c", "m", caught, moved, called),)).state
        for caught, moved, called in (
            ("x", True, True), ("", True, True), ("", False, True), ("", False, False)
        )
    ]  # fmt: skip
    assert states == ["caught", "moved but passed", "called but not felt", "never called"]
    assert not table.Result(fault, ()).good


def test_the_map_names_what_there_is():
    known = table.read_map()
    faults = {f.name for f in registry.all_faults()}
    planned = set(trial.pairs())
    assert set(known) <= faults
    for pairs in known.values():
        assert set(pairs) <= planned


def test_a_map_is_read_as_it_was_written(tmp_path, monkeypatch):
    monkeypatch.setattr(table, "files", lambda package: tmp_path)
    fault = Fault("f", NORM, scaled(2.0), "tests")
    found = tuple(Found(f"c{i // 2}", f"m{i}", "x", True, True) for i in range(6))
    table.write_map([table.Result(fault, found)])
    # Of each case one method, of two cases.
    assert table.read_map() == {"f": [("c0", "m0"), ("c1", "m2")]}


def test_the_page_says_what_is_caught_and_what_is_not(tmp_path):
    caught = table.Result(
        Fault("one", NORM, scaled(2.0), "norms"), (Found("c", "m", "q, a/1: 2", True, True),)
    )
    passed = table.Result(Fault("two <b>", NORM, scaled(2.0), "norms"), ())
    text = page.write([caught, passed], "cmverify faults", tmp_path).read_text()
    assert "1 of 2 faults are caught" in text
    assert "q, a/1: 2" in text
    assert "never called" in text
    assert "two &lt;b&gt;" in text
    assert browser.dead_links(tmp_path / page.NAME) == []


@pytest.mark.slow
def test_other_levels_measure_their_own_resolutions():
    name, pair = next(
        (n, p)
        for n, plan in table.read_map().items()
        for p in plan
        if p[0] == "deformational-heating"
    )
    before = trial.sound(pair, Level.STANDARD)
    assert set(before.outcomes) == {6, 12}
    found = trial.attempt(registry.get(name), pair, before, Level.STANDARD)
    assert found.called
    assert found.caught


def test_the_map_is_of_level_quick():
    found = CliRunner().invoke(app, ["faults", "--remember", "--level", "standard"])
    assert found.exit_code == 2
    assert "leave --level out" in found.output


def test_an_unknown_fault_is_refused():
    found = CliRunner().invoke(app, ["faults", "no such fault"])
    assert found.exit_code == 2
    assert "no such fault" in found.output


def test_the_reported_figures_of_new_cases_are_checked():
    """Every quantity of a case of references is judged: nothing is measured for show."""
    for name in (
        "closed-forms",
        "solids",
        "recovered",
        "yardsticks",
        "beside-elements",
        "first-break",
    ):
        case = cases.get(name)
        judged = {(c.method, c.quantity) for c in case.checks}
        for method in case.methods:
            (n,) = method.resolutions[Level.QUICK]
            measured = method.run(n).quantities
            assert {(method.name, q) for q in measured} <= judged
            assert np.isfinite(list(measured.values())).all()


def test_every_method_can_be_tried_alone():
    for name, method in trial.pairs():
        alone = trial._alone(cases.get(name), method)
        assert [m.name for m in alone.methods] == [method]
        assert {c.method for c in alone.checks} | {p.method for p in alone.poses} <= {method}
