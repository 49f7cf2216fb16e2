"""The audit on the command line: one equation, all of them, as data."""

import dataclasses
import json
from pathlib import Path

import pytest
from rich.console import Console
from typer.testing import CliRunner

from cmverify import errata as audit
from cmverify.cli import app
from references import errata as paper
from references.errata import Verdict

cli = CliRunner()
FEW = [paper.entry(n) for n in ("1", "37", "79", "109", "Sect. 3.1.2 (K)")]


@pytest.fixture
def few(monkeypatch):
    """Let the command line see a few entries only: the others have tests of their own."""
    monkeypatch.setattr(paper, "entries", lambda: FEW)


def test_one_equation_in_full():
    found = cli.invoke(app, ["errata", "79"])
    assert found.exit_code == 0, found.output
    for part in ("wrong", "2*S16*mu**3", "test_proof_holds[79]", "holds", "read as"):
        assert part in found.output


def test_what_is_not_judged_is_refused():
    found = cli.invoke(app, ["errata", "182"])
    assert found.exit_code == 2
    assert "1 to 181" in found.output


def test_the_list_shows_what_differs(few):
    found = cli.invoke(app, ["errata"], env={"COLUMNS": "200"})
    assert found.exit_code == 0, found.output
    flat = " ".join(found.output.split())
    assert "4 of 4 proofs hold" in flat
    assert (
        "4 numbered equations judged: 1 right, 1 right, frame or symbol not said, 2 wrong" in flat
    )
    assert "linearised" not in flat
    assert "eta_n/xi" not in flat
    every = cli.invoke(app, ["errata", "--all"], env={"COLUMNS": "200"})
    assert "eta_n/xi" in every.output


def test_everything_as_data(few):
    found = cli.invoke(app, ["errata", "--json"])
    assert found.exit_code == 0, found.output
    entries = {e["number"]: e for e in json.loads(found.output)["entries"]}
    assert set(entries) == {e.number for e in FEW}
    assert entries["109"]["verdict"] == Verdict.UNSAID.value
    assert entries["Sect. 3.1.2 (K)"]["proof"] == "none"
    assert "0.707" in entries["37"]["effect"]


def test_a_proof_that_fails_is_seen(monkeypatch):
    item = paper.entry("1")
    broken = dataclasses.replace(item, forms=(paper.Form("xi"), item.forms[1]))
    monkeypatch.setattr(paper, "entries", lambda: [broken])
    assert not audit.print_errata(Console(quiet=True))
    assert cli.invoke(app, ["errata"]).exit_code == 1
    assert cli.invoke(app, ["errata", "1"]).exit_code == 1
    assert cli.invoke(app, ["errata", "--json"]).exit_code == 1


def test_tests_that_the_page_names_are_there():
    source = Path(__file__).parents[2] / audit.TESTS
    assert "def test_proof_holds(item):" in source.read_text()


def test_the_results_page_counts_as_the_audit_does():
    counts = paper.coverage()
    equations, others = (sum(c[k] for c in counts.values()) for k in (0, 1))
    wrong = counts[Verdict.WRONG]
    text = (Path(__file__).parents[2] / "docs/results.md").read_text()
    assert (
        f"{equations} of {paper.EQUATIONS} judged, {wrong[0]} of them wrong; "
        f"{others} numbers and statements, {wrong[1]} wrong"
    ) in text
