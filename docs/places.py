"""A directive that sets which checks cover what: ``coverage``, from `cmverify validity --json`."""

from __future__ import annotations

import json
from itertools import groupby
from pathlib import Path

from docutils import nodes

#: Of the file's treatments of surfaces, what a reader calls them.
TREATMENTS = {
    "none": "Surfaces left as they are",
    "volume": "Volume correction",
    "extrapolated": "Bonds end at the surface (extrapolated)",
}


def _cell(place) -> nodes.entry:
    """How many checks hold, whose they are, and the narrowest bound; hatched if there is none."""
    if place["held"] == "0":
        return nodes.entry("", nodes.paragraph(text="–"), classes=["nothing"])
    held, all_of_them = place["held"].split("/")
    cases = place["cases"].split(", ")
    more = f" and {len(cases) - 2} more" if len(cases) > 2 else ""
    said = nodes.paragraph("", "", nodes.strong(text=f"{held} of {all_of_them}"))
    said += nodes.Text(f" in {', '.join(cases[:2])}{more}")
    found = [said]
    if place["bound"]:
        found.append(nodes.paragraph(text=place["bound"], classes=["bound"]))
    return nodes.entry("", *found)


def _row(head: str, cells: list[nodes.entry]) -> nodes.row:
    first = nodes.entry("", nodes.paragraph(text=head))
    return nodes.row("", first, *cells)


def _table(treatment: str, places) -> nodes.container:
    horizons = list(dict.fromkeys(place["m"] for place in places))
    group = nodes.tgroup(cols=1 + len(horizons))
    group += [nodes.colspec(colwidth=1, stub=1), *(nodes.colspec(colwidth=1) for _ in horizons)]
    heads = [f"m = {m}" if m != "other" else "other m" for m in horizons]
    names = [nodes.entry("", nodes.paragraph(text=head)) for head in heads]
    group += nodes.thead("", _row(TREATMENTS.get(treatment, treatment), names))
    body = nodes.tbody()
    for (physics, calibration), row in groupby(
        places, lambda place: (place["physics"], place["calibration"])
    ):
        body += _row(f"{physics}, {calibration}", [_cell(place) for place in row])
    group += body
    return nodes.container("", nodes.table("", group, classes=["matrix"]), classes=["wide"])


def setup(app):
    from sphinx.util.docutils import SphinxDirective

    class Coverage(SphinxDirective):
        """A table for each treatment of surfaces."""

        required_arguments = 1

        def run(self) -> list[nodes.Node]:
            source = Path(self.env.srcdir, self.arguments[0])
            self.env.note_dependency(str(source))
            places = json.loads(source.read_text(encoding="utf-8"))
            covered = sum(place["held"] != "0" for place in places)
            share = (
                f"{covered} of {len(places)} places are covered; of the others nothing is known."
            )
            found: list[nodes.Node] = [nodes.paragraph(text=share)]
            for treatment in dict.fromkeys(place["treatment"] for place in places):
                some = [place for place in places if place["treatment"] == treatment]
                found.append(_table(treatment, some))
            return found

    app.add_directive("coverage", Coverage)
    return {"parallel_read_safe": True}
