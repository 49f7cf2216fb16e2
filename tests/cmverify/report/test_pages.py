"""The page as a browser shows it: nothing sticks out, links lead somewhere, all can read it."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from cmverify.case import Failed
from cmverify.report import crosscheck_chapter, pages, summary
from cmverify.report.build import build
from cmverify.studies.crosscheck import Row
from tests.cmverify.report import browser
from tests.cmverify.report.test_build import INFO, records
from tests.cmverify.toy_registry import toy, trapezium

needs_chromium = pytest.mark.skipif(
    browser.find() is None, reason="no Chromium here to look at the page with: install chromium"
)


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """A failing run: a figure that is wrong, a crash with a long message, a cross-check, too."""
    failed = Failed("ArithmeticError", "no <luck> " * 40, "in a_very_long_name_of_a_function" * 30)
    judged = summary.summarise([toy()], records({10: trapezium(10, 1.01), 20: failed}))
    folder = tmp_path_factory.mktemp("page")
    row = Row("toy", "a long name of a problem", "conduction of a strained body", 2, 9, 30, 1e-14,
              1e-3, "error", 1e-3, 1e-3, 1e-4)  # fmt: skip
    rows = [row, replace(row, difference=0.5), Row("gone", "another", failure="no <luck> " * 40)]
    crosscheck_chapter.write(crosscheck_chapter.CrossCheck(rows, "dolfinx", "", "now"), folder)
    return build(judged, INFO, folder)


@needs_chromium
@pytest.mark.parametrize("width", [1400, 700, "sheet"])
def test_a_browser_finds_nothing_wrong(page, width):
    printed = width == "sheet"
    seen = browser.look(page, browser.SHEET if printed else width, printed=printed, opened=True)
    assert seen["console"] == []
    assert seen["page"] <= seen["window"], "the page scrolls sideways"
    assert seen["unreachable"] == 0, "a table that scrolls cannot be reached by keyboard"
    assert seen["blind"] == 0, "a picture does not load or has no text beside it"
    if width != 700:  # on a narrow screen tables scroll in their own box
        assert seen["wide"] == []


@needs_chromium
def test_a_sheet_shows_every_check(tmp_path):
    """On a screen they are folded; a reader of paper could not unfold them."""
    judged = summary.summarise([toy()], records({n: trapezium(n) for n in (10, 20)}))
    whole = build(judged, INFO, tmp_path)
    assert browser.look(whole, 1400)["folded"] == 1
    assert browser.look(whole, browser.SHEET, printed=True)["folded"] == 0


def test_every_link_resolves(page, tmp_path):
    assert browser.dead_links(page) == []
    broken = tmp_path / "broken.html"
    broken.write_text('<a href="#gone">x</a><a href="https://a.b/c">y</a><p id="there">')
    assert browser.dead_links(broken) == ["#gone", "https://a.b/c"]


def test_every_page_has_contents_a_way_to_the_top_and_a_dark_dress():
    """Whoever writes a page of its own extends one of these two."""
    folder = Path(pages.__file__).parent
    files = [*folder.glob("*.html"), *folder.parent.rglob("*.py")]
    whole = [path for path in files if "<!doctype" in path.read_text(encoding="utf-8")]
    assert {path.name for path in whole} == {"study.html", "template.html"}
    for path in whole:
        text = path.read_text(encoding="utf-8")
        for part in ('class="contents"', 'class="skip"', 'class="to-top"', 'content="light dark"'):
            assert part in text


def test_texts_stand_out_from_what_is_behind_them():
    """WCAG 2.1 asks for 4.5 : 1, in light, dark and print."""
    blocks = re.findall(r":root \{([^}]*)\}", pages.css())
    assert len(blocks) == 3
    for block in blocks:
        colour = dict(re.findall(r"--([\w-]+): (#\w+)", block))
        pairs = [(ink, "paper") for ink in ("ink", "soft", "blue", "good", "bad")]
        pairs += [("good", "good-bg"), ("bad", "bad-bg"), ("soft", "side"), ("blue", "side")]
        pairs += [("blue", "bad-bg"), ("ink", "code"), ("ink", "bad-bg")]
        for front, back in pairs:
            assert _contrast(colour[front], colour[back]) >= 4.5, (front, back)


def _contrast(one: str, other: str) -> float:
    light, dark = sorted((_luminance(one), _luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def _luminance(colour: str) -> float:
    digits = colour[1:] if len(colour) == 7 else "".join(2 * c for c in colour[1:])
    parts = [int(digits[i : i + 2], 16) / 255 for i in (0, 2, 4)]
    linear = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
