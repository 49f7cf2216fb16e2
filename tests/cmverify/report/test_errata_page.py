"""The audit as a page: coverage first, then what matters most, then every judgement."""

import dataclasses
import re
from pathlib import Path

from typer.testing import CliRunner

from cmverify import errata as audit
from cmverify.cli import app
from cmverify.report.errata_page import FOREMOST, write_page
from references import errata as paper
from tests.cmverify.report import browser

cli = CliRunner()
FEW = [paper.entry(n) for n in ("1", "37", "109", "Sect. 3.1.2 (K)")]


def test_the_page_opens_with_coverage_and_what_matters_most(tmp_path, monkeypatch):
    monkeypatch.setattr(paper, "entries", lambda: FEW)
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
    assert (page.parent / link).resolve() == Path(__file__).parents[3] / audit.TESTS


def test_every_foremost_mistake_has_its_figure(tmp_path):
    numbers = [number for group in FOREMOST for number in group[0]]
    page = tmp_path / "errata.html"
    assert write_page([audit.judge(paper.entry(n)) for n in numbers], page) == 0
    assert page.read_text().count("data:image/svg+xml") == len(FOREMOST) == 3
    # A page outside the checkout leads to the tests of this one.
    assert [link for link in browser.dead_links(page) if link.startswith("#")] == []


def test_a_proof_that_fails_is_seen(monkeypatch, tmp_path):
    item = paper.entry("1")
    broken = dataclasses.replace(item, forms=(paper.Form("xi"), item.forms[1]))
    monkeypatch.setattr(paper, "entries", lambda: [broken])
    page = tmp_path / "errata.html"
    assert cli.invoke(app, ["errata", "--page", str(page)]).exit_code == 1
    assert "1 of 1 proofs fail" in page.read_text()
