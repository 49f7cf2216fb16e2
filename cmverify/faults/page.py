"""The page of the fault table, beside the report of a run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from cmverify.report import pages
from cmverify.report.wording import heading
from cmverify.run.results import write_text

if TYPE_CHECKING:
    from cmverify.faults.table import Result

NAME = "faults.html"


def write(results: Sequence[Result], command: str, folder: Path) -> Path:
    """Write faults.html into a folder; returns its path."""
    kinds = [
        (kind, [r for r in results if r.fault.kind == kind])
        for kind in sorted({r.fault.kind for r in results})
    ]
    text = (
        pages.environment()
        .get_template("faults.html")
        .render(
            css=pages.css(),
            name="faults put in on purpose",
            contents=[(f"kind-{k}", heading(kind)) for k, (kind, _) in enumerate(kinds, 1)],
            kinds=kinds,
            total=len(results),
            good=all(r.good for r in results),
            caught=sum(bool(r.catching) for r in results),
            argued=sum(r.good and not r.catching for r in results),
            every="--all" in command,
            command=command,
        )
    )
    path = folder / NAME
    write_text(path, text)
    return path
