"""FEniCSx beside scikit-fem; here scikit-fem, right or wrong by a factor, plays FEniCSx."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import typer

from cmverify import cases as room
from cmverify.case import Level
from cmverify.cases import registry
from cmverify.console import console
from cmverify.report import crosscheck_chapter as chapter
from cmverify.report import summary
from cmverify.report.build import build
from cmverify.studies import crosscheck, crosscheck_command
from references.fem.conduction import steady_conduction
from references.fem.elasticity import solve_elasticity
from references.fem.mesh import rectangle
from references.fenicsx import bridge
from tests.cmverify.report import browser
from tests.cmverify.report.test_build import INFO, records
from tests.cmverify.toy_registry import toy, trapezium

QUICK = Level.QUICK
FX = bridge.Fenicsx("python", "a test", {"dolfinx": "0"})


def play(monkeypatch, factor=1.0):
    """Let scikit-fem times a factor be FEniCSx."""

    def heat(**given):
        return factor * steady_conduction.__wrapped__(**given).values

    def motion(**given):
        return factor * solve_elasticity.__wrapped__(**given).values

    monkeypatch.setattr(bridge, "steady_conduction", heat)
    monkeypatch.setattr(bridge, "solve_elasticity", motion)


def disc():
    """The disc by quadratic elements only, on a coarse mesh."""
    case = registry.get("disc-exponential")
    method = replace(case.method("fem/P2"), resolutions={QUICK: (12,)})
    return replace(case, methods=(method,), checks=(), featured="fem/P2", poses=())


def pull():
    """A plate that nothing holds: displacements are known but for a rigid motion."""
    mesh = rectangle(2, 1, 0.4, holes=[(0, 0, 0.2)])
    return solve_elasticity(
        mesh, np.diag([1.0, 1.0, 0.4]), tractions={"left": (-1, 0), "right": (1, 0)}
    )


def named(**elements):
    return replace(toy(), elements=elements)


def test_a_method_is_solved_twice_and_its_error_falls_on_the_finer_mesh(monkeypatch):
    play(monkeypatch)
    (row,) = crosscheck.rows([disc()], QUICK)
    assert (row.problem, row.solver, row.order) == ("fem/P2, a/12", "steady heat", 2)
    assert row.difference == 0.0
    assert row.ours == row.theirs > 4 * row.finer > 0
    assert 0 < row.change < 0.01
    assert row.passed
    assert 3.5 * row.nodes < row.finer_nodes < 4 * row.nodes


def test_named_elements_are_solved_once_of_each_kind(monkeypatch):
    play(monkeypatch)

    def several():
        for _ in range(2):
            pull()
        raise AssertionError("one is enough")

    (row,) = crosscheck.rows([named(plate=several)], QUICK)
    assert row.passed
    assert (row.case, row.problem, row.solver) == ("toy", "plate", "elasticity")
    assert row.quantity == ""


@pytest.mark.parametrize("factor", [1.01, 1 + 1e-8])
def test_a_code_that_differs_is_seen(monkeypatch, factor):
    play(monkeypatch, factor)
    found = crosscheck.rows([disc(), named(plate=pull)], QUICK)
    assert [row.passed for row in found] == [False, False]
    # Over the largest displacement, most of which is where the body is held.
    assert 0.2 * (factor - 1) < found[1].difference < 1.001 * (factor - 1)


def test_an_error_that_does_not_fall_and_a_mesh_that_is_too_coarse_fail():
    row = crosscheck.Row("c", "p", "heat", 2, 9, 30, 1e-14, 1e-3, "error", 1e-3, 1e-3, 1e-4)
    assert row.passed
    assert not replace(row, finer=1.1e-3).passed
    assert not replace(row, change=0.1).passed
    assert not replace(row, difference=float("nan")).passed
    assert not crosscheck.Row("c", "p", failure="it raised").passed


def test_what_cannot_be_solved_fails_by_name(monkeypatch):
    def missing(**given):
        raise bridge.FenicsxError("no such thing")

    monkeypatch.setattr(bridge, "solve_elasticity", missing)
    (row,) = crosscheck.rows([named(plate=pull)], QUICK)
    assert not row.passed
    assert row.failure == "FenicsxError: no such thing"
    (row,) = crosscheck.rows([named(nothing=lambda: None)], QUICK)
    assert "no finite elements" in row.failure


def test_every_stored_reference_that_a_case_loads_is_cross_checked():
    """But the lattice's, whose homogenised square is, and paths in the specimen of the pins."""
    others = {"compact-tension-paths", "tetrachiral-clamped", "tetrachiral-free"}
    loaded: set[str] = set()
    for path in Path(room.__file__).parent.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        loaded |= set(re.findall(r'\bload\(\s*f?"([\w-]+)', text))
        loaded |= set(re.findall(r'else "(tetrachiral-\w+)"', text))
    assert len(loaded) > 8
    names = [name for case in registry.all_cases() for name in case.elements]
    for name in loaded - others:
        assert any(known.startswith(f"stored {name}") for known in names), name
    free = [c.name for c in registry.all_cases() if "homogenised square" in c.elements]
    assert free == ["tetrachiral-modes-free", "tetrachiral-modes-clamped"]
    assert {f"stored kinks-{m}" for m in ("silicon", "anisotropic")} <= set(names)


def test_without_fenicsx_it_is_skipped_aloud(tmp_path, capsys):
    crosscheck_command.crosschecked([disc()], QUICK, tmp_path, None, console())
    said = capsys.readouterr().out
    assert said.startswith("The cross-check is skipped. FEniCSx not found.")
    assert "pip install 'cmverify[fenicsx]'" in said
    assert said.count("\n") == 1
    assert chapter.read(tmp_path).skipped == bridge.INSTALL


def test_a_wrong_setting_is_refused_before_anything_runs(monkeypatch):
    monkeypatch.setenv(bridge.VARIABLE, "/no/python")
    with pytest.raises(typer.Exit):
        crosscheck_command.found()


def test_rows_are_kept_beside_those_of_other_cases(monkeypatch, tmp_path, capsys):
    play(monkeypatch)
    other = crosscheck.Row("other", "p", "heat", 2, 9, 30, 1e-14, 1e-3)
    stale = replace(other, case="disc-exponential")
    chapter.write(chapter.CrossCheck([stale, other], "old", "", "then"), tmp_path)
    new = crosscheck_command.crosschecked([disc()], QUICK, tmp_path, FX, console())
    assert [row.case for row in new.rows] == ["disc-exponential"]
    assert [row.case for row in chapter.read(tmp_path).rows] == ["disc-exponential", "other"]
    assert "1 of 1 problems agree" in capsys.readouterr().out
    kept = chapter.read(tmp_path)
    assert kept.makers == {new.now: 1, "old; then": 1}
    crosscheck_command.crosschecked([disc()], QUICK, tmp_path, None, console())
    assert chapter.read(tmp_path).makers == {"old; then": 1}  # skipped: it made nothing
    (tmp_path / chapter.NAME).write_text("{}")
    with pytest.raises(ValueError, match="no cross-check"):
        chapter.read(tmp_path)


def test_the_report_has_its_column_and_says_what_fails(tmp_path):
    good = crosscheck.Row("toy", "fem <1>", "heat", 2, 9, 30, 1e-14, 1e-3, "e", 1e-3, 1e-3, 1e-4)
    bad = replace(good, problem="second", difference=0.5)
    lost = crosscheck.Row("gone", "third", failure="it raised")
    judged = summary.summarise([toy()], records({10: trapezium(10), 20: trapezium(20)}))
    for rows, sign in (([good], "✓ 1e-14"), ([good, bad, lost], "✗ 5e-01")):
        chapter.write(chapter.CrossCheck(rows, str(FX), "", "now"), tmp_path)
        page = build(judged, INFO, tmp_path)
        text = page.read_text(encoding="utf-8")
        assert sign in text
        assert "fem &lt;1&gt;" in text
        assert ("FEniCSx does not confirm" in text) == (len(rows) == 3)
        assert browser.dead_links(page) == []
