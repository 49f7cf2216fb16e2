"""The paper, judged: every numbered equation, and the numbers of its text, tables and captions.

The paper is V. Diana, *Anisotropic Continuum-Molecular Models*, Arch. Comput. Methods Eng. (2022),
as its open-access text was extracted.  Every proof derives what should stand from the paper's own
definitions, or from elasticity and conduction theory, without seeing the print, and holds the
print against it; where they differ the difference is stated exactly.  No proof uses the solver.
"Wrong" is said only where no reading helps, and the entry says which readings were tried.

================  ==============================================================================
`pairs`           Eqs. 1-22: measures, pair energy and actions, balance of momentum
`discrete`        Eqs. 23-39: matrices of a pair, the assembled system (`cloud`: what it must be)
`tensors`         Eqs. 40-57: turned axes, strains of a bond, energy of a horizon
`correspondence`  Eqs. 58-78: macro- and micromoduli, isotropy, turned solids
`crack_tip`       Eqs. 79-85: crack-tip field, stress of a section, rotation
`blocks`          Eqs. 86-91: tetrachiral block lattice
`cuts`            Eqs. 92-105: critical energies, broken bonds, damage
`materials`       Eqs. 106-110: solids, energy release rate, peak load
`heat`            Eqs. 111-135: heat and current, assembled
`conductivity`    Eqs. 136-167: macro- and microconductivities
`disc`            Eqs. 168-172: the heated disc
`coupled`         Eqs. 173-181: damage sensing, thermal expansion, polar solids
`statements_...`  numbers and statements of text, tables and captions, by section
================  ==============================================================================

`expression` reads forms and compares them, `mutation` changes them for the tests.
"""

from __future__ import annotations

from references.errata import (
    blocks,
    conductivity,
    correspondence,
    coupled,
    crack_tip,
    cuts,
    disc,
    discrete,
    heat,
    materials,
    pairs,
    statements_conduction,
    statements_elasticity,
    statements_fracture,
    tensors,
)
from references.errata.model import Entry, Form, Verdict

__all__ = ["EQUATIONS", "Entry", "Form", "Verdict", "coverage", "entries", "entry", "prove_all"]

#: The paper numbers its equations from 1 to this.
EQUATIONS = 181

_MODULES = (
    pairs,
    discrete,
    tensors,
    correspondence,
    crack_tip,
    blocks,
    statements_elasticity,
    cuts,
    materials,
    statements_fracture,
    heat,
    conductivity,
    disc,
    coupled,
    statements_conduction,
)


def entries() -> list[Entry]:
    """All entries: the numbered equations in order, then numbers and statements of the text."""
    found = [item for module in _MODULES for item in module.ENTRIES]
    equations = sorted((e for e in found if e.is_equation), key=lambda e: int(e.number))
    return equations + [e for e in found if not e.is_equation]


def entry(number: str | int) -> Entry:
    """The entry of an equation, or of a statement by its place ("Sect. 4.3.1 (ratio)").

    Raises
    ------
    KeyError
        If nothing of that name is judged.
    """
    wanted = str(number).strip().removeprefix("Eq. ")
    for item in entries():
        if item.number == wanted:
            return item
    raise KeyError(f"nothing is judged under {wanted!r}: equations are numbered 1 to {EQUATIONS}")


def coverage() -> dict[Verdict, tuple[int, int]]:
    """How many equations, and how many statements, have each verdict."""
    found = entries()
    return {
        verdict: (
            sum(e.is_equation for e in found if e.verdict is verdict),
            sum(not e.is_equation for e in found if e.verdict is verdict),
        )
        for verdict in Verdict
    }


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
