"""`cmverify errata`: run every proof of `references.errata` and show what it proves."""

from __future__ import annotations

from rich.console import Console
from rich.markup import escape
from rich.table import Table


def print_errata(console: Console, wrong_only: bool = True) -> bool:
    """Prove every entry and print the wrong equations; True if no proof failed.

    Parameters
    ----------
    wrong_only : bool
        Leave out equations that were confirmed (they are proved and counted all the same).
    """
    from references.errata import entries

    view = Table(header_style="bold", show_lines=True, pad_edge=False)
    for column in ("Eq.", "printed", "derived", "how it shows", "proof"):
        view.add_column(column, overflow="fold")
    failures, wrong, confirmed = [], 0, 0
    with console.status("proving"):
        for entry in entries():
            try:
                entry.prove()
                proof = "[green]✓[/]"
            except AssertionError as error:
                failures.append(f"Eq. {entry.number}: {error}")
                proof = f"[red]✗ {escape(str(error))}[/]"
            wrong += entry.verdict == "wrong"
            confirmed += entry.verdict == "confirmed"
            if entry.verdict == "wrong" or not wrong_only or "✗" in proof:
                texts = (entry.number, entry.printed, entry.derived, entry.shows)
                view.add_row(*(escape(text) for text in texts), proof)
    console.print(view)
    console.print(
        f"{wrong} printed equations do not hold, {confirmed} are confirmed; "
        f"{wrong + confirmed - len(failures)} of {wrong + confirmed} proofs hold."
    )
    return not failures
