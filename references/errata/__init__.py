"""The paper's equations, judged: printed form, derived form, and a proof that can be run.

The paper is V. Diana, *Anisotropic Continuum-Molecular Models*, Arch. Comput. Methods Eng. (2022).
Every proof starts from the paper's own definitions (or from elasticity and conduction theory) and
shows that the derived form holds; for an entry called wrong it also shows that the printed form
does not.  No proof uses the solver.  What is judged is the text of the open-access article as
extracted: where a fraction bar could have been lost in extraction the entry still stands, since
a reader of that text would compute the wrong number.
"""

from __future__ import annotations

from references.errata import (
    benchmarks,
    conduction,
    coupled,
    disc,
    elasticity,
    fracture,
    kinematics,
    special,
)
from references.errata.model import Entry

__all__ = ["Entry", "entries", "entry", "prove_all"]


def entries() -> list[Entry]:
    """All entries in the order of the paper."""
    modules = (
        kinematics,
        elasticity,
        special,
        benchmarks,
        fracture,
        conduction,
        disc,
        coupled,
    )
    return [item for module in modules for item in module.ENTRIES]


def entry(number: str | int) -> Entry:
    """The entry of an equation, by its number ("79") or by a number inside a range ("74").

    Raises
    ------
    KeyError
        If no entry covers that equation.
    """
    wanted = str(number)
    for item in entries():
        if item.covers(wanted):
            return item
    raise KeyError(f"no erratum or confirmation is recorded for Eq. {wanted}")


def prove_all() -> list[Entry]:
    """Run every proof and return the entries proved.

    Raises
    ------
    AssertionError
        Naming every entry whose proof fails, after all have been run.
    """
    failures = []
    for item in entries():
        try:
            item.prove()
        except AssertionError as error:
            failures.append(f"Eq. {item.number}: {error}")
    if failures:
        raise AssertionError("; ".join(failures))
    return entries()
