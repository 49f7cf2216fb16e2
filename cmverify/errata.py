"""`cmverify errata`: run the proofs of `references.errata` and show what they prove."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console

    from references.errata import Entry

TESTS = "tests/references/errata/test_proofs.py"


@dataclass(frozen=True)
class Judgement:
    """One entry with its numbers computed and its proof run.

    Attributes
    ----------
    number, title, verdict, printed, derived, how, effect, needs : str
        As in `references.errata.Entry`.
    readings : tuple of str
    equation : bool
        Whether it is a numbered equation.
    proof : str
        "holds", "none" where nothing can be judged, or why it fails.
    source, test : str
        Module of the derivation, and the test that runs the proof.
    """

    number: str
    title: str
    verdict: str
    printed: str
    derived: str
    how: str
    readings: tuple[str, ...]
    effect: str
    needs: str
    equation: bool
    proof: str
    source: str
    test: str

    @property
    def failed(self) -> bool:
        """Whether there is a proof and it fails."""
        return self.proof not in ("holds", "none")

    @property
    def differs(self) -> bool:
        """Whether a reader of the print should know something."""
        return self.verdict not in ("right", "definition", "cannot be judged")


def judge(entry: Entry) -> Judgement:
    """Run an entry's proof and compute its numbers."""
    proof = "none"
    if entry.forms:
        try:
            entry.prove()
            proof = "holds"
        except AssertionError as error:
            proof = str(error)
    return Judgement(
        number=entry.number,
        title=entry.title,
        verdict=entry.verdict.value,
        printed=entry.printed,
        derived=entry.derived,
        how=entry.how,
        readings=entry.readings_in_numbers(),
        effect=entry.effect_in_numbers(),
        needs=entry.needs,
        equation=entry.is_equation,
        proof=proof,
        source=entry.truth.__module__ if entry.forms else "",
        test=f"{TESTS}::test_proof_holds[{entry.number}]" if entry.forms else "",
    )


def coverage_line(judged: Iterable[Judgement]) -> str:
    """How many equations are judged how, in one sentence."""
    from references.errata import Verdict

    equations = [j for j in judged if j.equation]
    counts = {v.value: sum(j.verdict == v.value for j in equations) for v in Verdict}
    parts = ", ".join(f"{count} {verdict}" for verdict, count in counts.items() if count)
    return f"{len(equations)} numbered equations judged: {parts}."


def print_errata(console: Console, differing_only: bool = True) -> bool:
    """Prove everything and print what differs; True if no proof failed.

    Parameters
    ----------
    differing_only : bool
        Leave out what is right as printed or cannot be judged (proved and counted all the same).
    """
    from rich.table import Table
    from rich.text import Text

    from cmverify.console import mark
    from references.errata import entries

    view = Table(header_style="bold", show_lines=True, pad_edge=False)
    for column in ("Eq.", "verdict", "printed", "as it should be", "effect", "proof"):
        view.add_column(column, overflow="fold", no_wrap=column in ("Eq.", "verdict"))
    with console.status("proving"):
        judged = [judge(entry) for entry in entries()]
    for item in judged:
        if item.differs or item.failed or not differing_only:
            signs = {"holds": mark(True), "none": Text("–")}
            view.add_row(
                item.number, item.verdict, item.printed, item.derived, item.effect or item.needs,
                signs.get(item.proof) or Text(f"✗ {item.proof}", style="red"),
            )  # fmt: skip
    console.print(view)
    failed, proved = sum(j.failed for j in judged), sum(j.proof != "none" for j in judged)
    others = [j for j in judged if not j.equation]
    console.print(
        f"{coverage_line(judged)} Beside them {len(others)} numbers and statements, "
        f"{sum(j.differs for j in others)} of which differ. {proved - failed} of {proved} proofs "
        "hold.",
        soft_wrap=True,
    )
    return not failed


def print_one(console: Console, number: str) -> bool:
    """Print one judgement in full; True unless its proof fails.

    Raises
    ------
    KeyError
        If nothing of that name is judged.
    """
    from references.errata import entry

    item = judge(entry(number))
    head = f"Eq. {item.number}" if item.equation else item.number
    console.print(f"{head}: {item.title}: {item.verdict}", style="bold", soft_wrap=True)
    lines = [("printed", item.printed), ("should be", item.derived), ("derived from", item.how)]
    lines += [("read as", reading) for reading in item.readings]
    lines += [("effect", item.effect), ("needed", item.needs), ("proof", item.proof)]
    lines += [("test", item.test)]
    for label, text in lines:
        if text:
            console.print(f"  {label:13s}{text}", soft_wrap=True)
    return not item.failed


def as_json(judged: Iterable[Judgement]) -> str:
    """Everything as one JSON document."""
    items = list(judged)
    document: dict[str, Any] = {
        "paper": "V. Diana, Anisotropic Continuum-Molecular Models, "
        "Arch. Comput. Methods Eng. (2022)",
        "coverage": coverage_line(items),
        "entries": [asdict(item) for item in items],
    }
    return json.dumps(document, indent=1, ensure_ascii=False)
