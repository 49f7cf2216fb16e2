"""The audit on the command line: one equation, all of them, as data and as a page."""

import dataclasses
import json
import re
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


def test_the_page_opens_with_coverage_and_what_matters_most(few, tmp_path):
    page = tmp_path / "audit" / "errata.html"
    found = cli.invoke(app, ["errata", "--page", str(page)])
    assert found.exit_code == 0, found.output
    text = page.read_text()
    assert text.index("numbered equations judged") < text.index("Half a stiffness")
    assert text.index("Half a stiffness") < text.index('id="eq-1"')
    assert text.count("data:image/svg+xml") == 1  # Eqs. 87 and 169 are not among the few
    for entry in FEW:
        assert entry.number in text
    (link,) = set(re.findall(r'href="([^"#]+)"', text))
    assert (page.parent / link).resolve() == Path(__file__).parents[2] / audit.TESTS


def test_every_foremost_mistake_has_its_figure(tmp_path):
    from cmverify.report.errata_page import FOREMOST, write_page

    numbers = [number for group in FOREMOST for number in group[0]]
    page = tmp_path / "errata.html"
    assert write_page([audit.judge(paper.entry(n)) for n in numbers], page) == 0
    assert page.read_text().count("data:image/svg+xml") == len(FOREMOST) == 3


def test_a_proof_that_fails_is_seen(monkeypatch, tmp_path):
    item = paper.entry("1")
    broken = dataclasses.replace(item, forms=(paper.Form("xi"), item.forms[1]))
    monkeypatch.setattr(paper, "entries", lambda: [broken])
    assert not audit.print_errata(Console(quiet=True))
    assert cli.invoke(app, ["errata"]).exit_code == 1
    assert cli.invoke(app, ["errata", "1"]).exit_code == 1
    assert cli.invoke(app, ["errata", "--json"]).exit_code == 1
    page = tmp_path / "errata.html"
    assert cli.invoke(app, ["errata", "--page", str(page)]).exit_code == 1
    assert "1 of 1 proofs fail" in page.read_text()


def test_tests_that_the_page_names_are_there():
    source = Path(__file__).parents[2] / audit.TESTS
    assert "def test_proof_holds(item):" in source.read_text()


def test_the_readme_counts_as_the_audit_does():
    counts = paper.coverage()
    equations, others = (sum(c[k] for c in counts.values()) for k in (0, 1))
    wrong = counts[Verdict.WRONG]
    text = (Path(__file__).parents[2] / "README.md").read_text()
    assert (
        f"{equations} of {paper.EQUATIONS} judged, {wrong[0]} of them wrong; "
        f"{others} numbers and statements, {wrong[1]} wrong"
    ) in text
