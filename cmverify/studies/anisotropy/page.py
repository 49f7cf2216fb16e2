"""The page of solids beside the report: what bonds make of each, in tables and one figure."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from cmverify.case import Array
from cmverify.report import pages
from cmverify.report.picture import Picture
from cmverify.run.results import write_text
from cmverify.studies.anisotropy.figure import draw
from cmverify.studies.anisotropy.profile import HORIZONS, Profile, lines, ripple

NAME = "materials.html"


def of_the_cases() -> Iterator[tuple[str, Array]]:
    """The elastic solids of the cases, with their names."""
    from cmverify.cases.common import materials

    yield from materials.TENSORS.items()
    yield "tetrachiral", materials.tetrachiral()
    for name in ("isotropic:0.2", "isotropic:0.33333333:stress", "isotropic:0.45:strain"):
        yield name, materials.named(name)


def write(solids: Iterable[Profile], command: str, folder: Path) -> Path:
    """Write the page into a folder; returns its path."""
    shown = [_section(number, solid) for number, solid in enumerate(solids, 1)]
    page = (
        pages.environment()
        .get_template("materials.html")
        .render(
            css=pages.css(),
            name="solids and their bonds",
            contents=[(f"solid-{number}", s["solid"]) for number, s in enumerate(shown, 1)],
            solids=shown,
            horizons=HORIZONS,
            command=command,
        )
    )
    path = folder / NAME
    write_text(path, page)
    return path


def _section(number: int, found: Profile) -> dict[str, Any]:
    caption = (
        "Bonds over the direction; margins of stability over the horizon; energy as the material "
        "turns; plane waves; kinks; a hole's largest hoop stress and a crack's K²/G."
    )
    return {
        "solid": found.solid,
        "m": found.m,
        "advice": found.advice,
        "rows": lines(found),
        "admissible": ", ".join(map(str, found.admissible)),
        "ripples": ", ".join(
            f"{name} {ripple(ratio):.2g}" for name, (_, ratio) in found.energies.items()
        ),
        "picture": Picture.drawn(
            f"solid-{number}", "png", draw(found), caption, f"{found.solid}: {found.advice}",
            wide=True,
        ),
    }  # fmt: skip
