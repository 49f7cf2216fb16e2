"""The page of the stability studies: one self-contained HTML file in the report's style."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cmverify.report import pages
from cmverify.report.picture import Picture
from cmverify.run.results import write_text
from cmverify.studies.stability.assessments import Assessment


@dataclass(frozen=True)
class Section:
    """A study: what it shows and its pictures."""

    title: str
    text: str
    pictures: tuple[Picture, ...]


def write(
    verdicts: Sequence[Assessment], sections: Sequence[Section], command: str, folder: Path
) -> Path:
    """Write stability.html and the figures beside it; returns the page's path."""
    folder.mkdir(parents=True, exist_ok=True)
    drawn = []
    for section in sections:
        pictures = []
        for picture in section.pictures:
            picture.save(folder / picture.name)
            pictures.append(picture)
        drawn.append({"title": section.title, "text": section.text, "pictures": pictures})
    titles = [(f"study-{number}", s.title) for number, s in enumerate(sections, 1)]
    page = (
        pages.environment()
        .get_template("stability.html")
        .render(
            css=pages.css(),
            name="stability of bond models",
            contents=[("verdicts", "Verdicts"), *titles],
            verdicts=verdicts,
            confirmed=all_confirmed(verdicts),
            sections=drawn,
            command=command,
        )
    )
    path = folder / "stability.html"
    write_text(path, page)
    return path


def all_confirmed(verdicts: Sequence[Assessment]) -> bool:
    """Whether there are verdicts and none is contradicted."""
    return bool(verdicts) and all(bool(v.confirmed) for v in verdicts if v.confirmed is not None)


def spoken(margin: np.ndarray) -> str:
    """A map in words."""
    count = margin.size
    return (
        f"{100 * (margin > 0).sum() / count:.0f} % of the map stable, "
        f"{100 * (margin <= 0).sum() / count:.0f} % unstable, "
        f"{100 * np.isnan(margin).sum() / count:.0f} % without such moduli"
    )
