"""The audit of the paper as one HTML page: coverage, what matters most, every judgement."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from cmverify.errata import TESTS, Judgement, coverage_line
from cmverify.report import pages
from cmverify.report.picture import Picture
from cmverify.run.results import write_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: What misleads somebody who implements the model most: equations, headline, text, figure.
FOREMOST = (
    (
        ("169", "172"),
        "The heated disc has another solution",
        "Eq. 169 does not conduct without sources. A program that solves the problem with its "
        "boundary values finds another field, and is blamed for it.",
        "disc",
    ),
    (
        ("87",),
        "The block lattice is stiffer",
        "Eq. 87 has cos 4β in its denominator where cos 2β belongs: natural frequencies of the "
        "homogenised square fall short of those of the blocks.",
        "tetrachiral",
    ),
    (
        ("34", "37", "129", "132"),
        "Half a stiffness",
        "The incidence matrix at the end of Eqs. 34, 37, 129 and 132 keeps the columns of one "
        "particle only. Eq. 175 prints the same matrices without it, and is right.",
        "half",
    ),
)


def write_page(judged: Sequence[Judgement], path: Path) -> int:
    """Write the page; returns how many proofs failed.

    Parameters
    ----------
    judged : sequence of Judgement
        In the order of the page's table.
    path : Path
        Of the HTML file; its figures are inside it.
    """
    by_number = {item.number: item for item in judged}
    foremost = [
        {
            "title": title,
            "text": text,
            "items": [by_number[number] for number in numbers if number in by_number],
            "picture": _picture(name),
        }
        for numbers, title, text, name in FOREMOST
        if any(number in by_number for number in numbers)
    ]
    wrong = [
        (f"eq-{item.number.replace(' ', '-')}", f"Eq. {item.number}: wrong")
        for item in judged
        if item.equation and item.verdict == "wrong"
    ]
    page = (
        pages.environment()
        .get_template("errata.html")
        .render(
            css=pages.css(),
            name="the paper, audited",
            contents=[
                ("foremost", "What matters most"),
                ("equations", "Every numbered equation"),
                *wrong,
                ("statements", "Numbers and statements"),
            ],
            tests=_tests_seen_from(path.resolve().parent),
            coverage=coverage_line(judged),
            foremost=foremost,
            equations=[item for item in judged if item.equation],
            statements=[item for item in judged if not item.equation],
            failed=sum(item.failed for item in judged),
            proved=sum(item.proof != "none" for item in judged),
            command="cmverify errata --page errata.html",
        )
    )
    write_text(path, page)
    return sum(item.failed for item in judged)


def _tests_seen_from(folder: Path) -> str:
    """Relative path of the proofs' tests, or nothing where the package came without them."""
    tests = Path(__file__).resolve().parents[2] / TESTS
    return Path(os.path.relpath(tests, folder)).as_posix() if tests.is_file() else ""


def _picture(name: str) -> Picture:
    from cmverify.report import errata_figures

    drawings: dict[str, tuple[Callable[[], Figure], str]] = {
        "disc": (
            errata_figures.disc,
            "Temperature along x₁ = 0: Eq. 169 as printed, the exact solution for its boundary "
            "values, and the corrected field; and the source that the print leaves.",
        ),
        "tetrachiral": (
            errata_figures.tetrachiral,
            "Free circular frequencies of 25 × 25 blocks and of the homogenised square, Eq. 87 as "
            "printed and corrected (quadratic finite elements).",
        ),
        "half": (
            errata_figures.half_a_stiffness,
            "Frequencies of a cloud of five particles (unit masses) with the stiffness of Eq. 37 "
            "as printed, against those of its energy.",
        ),
    }
    draw, caption = drawings[name]
    return Picture.drawn(name, "svg", draw(), caption, caption)
