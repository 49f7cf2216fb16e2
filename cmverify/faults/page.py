"""The page of the fault table, beside the report of a run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from cmverify.faults import alone
from cmverify.report import pages
from cmverify.report.wording import heading
from cmverify.run.results import write_text

if TYPE_CHECKING:
    from cmverify.faults.table import Result

NAME = "faults.html"


def write(results: Sequence[Result], command: str, folder: Path, once: bool = False) -> Path:
    """Write faults.html into a folder; returns its path. `once` if one case a fault was enough."""
    tally = alone.Tally.of(results)
    kinds = [
        (kind, [r for r in results if r.fault.kind == kind])
        for kind in sorted({r.fault.kind for r in results})
    ]
    contents = [(f"kind-{k}", heading(kind)) for k, (kind, _) in enumerate(kinds, 1)]
    groups = {} if once else {w[:1].upper() + w[1:]: found for w, found in tally.groups.items()}
    if groups:
        contents.append(("alone", "Caught by one case alone"))
    text = (
        pages.environment()
        .get_template("faults.html")
        .render(
            css=pages.css(),
            name="faults put in on purpose",
            contents=contents,
            kinds=kinds,
            good=all(r.good for r in results),
            sentence=tally.sentence(once),
            groups=groups,
            once=once,
            every="--all" in command,
            command=command,
        )
    )
    path = folder / NAME
    write_text(path, text)
    return path
