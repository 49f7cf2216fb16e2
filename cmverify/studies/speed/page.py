"""The page of the speed study, in the report's style: figure, what must hold, every table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from cmverify.judge.verdict import Verdict
from cmverify.report import pages
from cmverify.report.picture import Picture
from cmverify.run.results import write_text

NAME = "speed.html"
#: Columns that a page is wide enough for.
ROOM = 9


def write(document: Mapping[str, Any], verdicts: Sequence[Verdict], image: Path) -> Path:
    """Write speed.html beside the figure of the study; returns its path.

    Parameters
    ----------
    document : mapping
        What speed.json holds: ``machine``, ``level``, ``command`` and ``tables`` (rows with
        ``name`` and ``values`` by title).
    verdicts : sequence of Verdict
    image : Path
        speed.png.
    """
    tables = [_table(title, rows) for title, rows in document["tables"].items()]
    alt = "; ".join(f"{v.method} {v.quantity}: {v.value:.3g}" for v in verdicts)
    picture = Picture(
        "speed",
        "png",
        image.read_bytes(),
        "A product with the stiffness and a whole solve beside other formats and solvers, both "
        "relative to ours; time a particle as the lattice grows.",
        alt or "Bars of times relative to the bond solver's, and time a particle over size.",
        wide=True,
    )
    contents = [("picture", "At a glance"), *([("verdicts", "What must hold")] if verdicts else [])]
    contents += [(f"table-{k}", table["title"]) for k, table in enumerate(tables, 1)]
    text = (
        pages.environment()
        .get_template("speed.html")
        .render(
            css=pages.css(),
            name="speed beside what one would otherwise use",
            contents=contents,
            verdicts=sorted(verdicts, key=lambda v: v.passed),
            held=sum(v.passed for v in verdicts),
            good=all(v.passed for v in verdicts),
            judged=document["level"] != "quick",
            level=document["level"],
            machine=document["machine"],
            picture=picture,
            tables=tables,
            command=document["command"],
        )
    )
    path = image.with_name(NAME)
    write_text(path, text)
    return path


def _table(title: str, rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    columns = list(dict.fromkeys(name for row in rows for name in row["values"]))
    parts = -(-len(columns) // ROOM)
    size = -(-len(columns) // parts)
    blocks = []
    for part in (columns[k : k + size] for k in range(0, len(columns), size)):
        lines = [(row["name"], [_cell(row["values"].get(c)) for c in part]) for row in rows]
        blocks.append({"columns": [c.replace("_", " ") for c in part], "rows": lines})
    return {"title": title, "blocks": blocks}


def _cell(value: Any) -> str:
    if value is None:
        return ""
    return f"{value:.3g}" if isinstance(value, float) else str(value)
