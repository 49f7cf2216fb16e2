"""Errata: every proof runs, and the tools of the proofs can fail."""

import subprocess
import sys

import pytest
import sympy as sp

from references import errata
from references.errata import model

ENTRIES = errata.entries()


@pytest.mark.parametrize("item", ENTRIES, ids=[e.number for e in ENTRIES])
def test_proof_holds(item):
    item.prove()


def test_entries_say_what_a_reader_needs():
    numbers = [e.number for e in ENTRIES]
    assert len(set(numbers)) == len(numbers)
    for e in ENTRIES:
        assert e.title
        assert e.printed
        assert e.derived
        assert e.shows
        assert e.verdict in ("confirmed", "wrong")
        assert (e.derived == "as printed") <= (e.verdict == "confirmed")


def test_lookup_by_number_and_range():
    assert errata.entry("79").verdict == "wrong"
    assert errata.entry(74) is errata.entry("73-74")
    assert errata.entry("Sect. 4.3.1 (ratio)").verdict == "wrong"
    with pytest.raises(KeyError, match="9999"):
        errata.entry("9999")


@pytest.mark.parametrize(
    "number",
    # The mistakes named in the project's first notes, and those found since.
    [
        *("31", "73", "75", "79", "83", "87", "107", "109", "120", "138"),
        *("142", "145", "162", "166", "169", "170", "172", "176"),
    ],
)
def test_known_mistakes_are_listed_as_wrong(number):
    assert errata.entry(number).verdict == "wrong"


def test_a_false_statement_fails_its_proof():
    x = sp.symbols("x")
    with pytest.raises(AssertionError, match="not zero"):
        model.vanishes(sp.Rational(101, 100) * x - x, "one per cent")
    with pytest.raises(AssertionError, match="does not differ"):
        model.differs((x + 1) ** 2 - x**2 - 2 * x - 1, "the same form")
    with pytest.raises(AssertionError, match="false"):
        model.require(False, "false")


def test_one_per_cent_in_a_constant_fails_the_proof(monkeypatch):
    from references.errata import conduction

    right = conduction.cosine_constants
    monkeypatch.setattr(
        conduction,
        "cosine_constants",
        lambda n: (right(n)[0] * sp.Rational(101, 100), right(n)[1]),
    )
    with pytest.raises(AssertionError, match="n = 2"):
        errata.entry(163).prove()


def test_prove_all_names_what_fails(monkeypatch):
    broken = model.Entry("0", "t", "p", "d", "wrong", "s", lambda: model.require(False, "no"))
    monkeypatch.setattr(errata, "entries", lambda: [ENTRIES[0], broken])
    with pytest.raises(AssertionError, match=r"Eq\. 0: no"):
        errata.prove_all()


def test_circle_integral_against_quadrature():
    psi = sp.Symbol("psi")
    law = 3 * model.COS**4 * model.SIN**2 - model.COS**3 * model.SIN + 2
    direct = law.subs({model.COS: sp.cos(psi), model.SIN: sp.sin(psi)})
    assert sp.simplify(model.circle_integral(law) - sp.integrate(direct, (psi, 0, 2 * sp.pi))) == 0


def test_proofs_do_not_know_the_solver():
    code = (
        "import sys; from references import errata; errata.prove_all(); "
        "assert not {'solver', 'cmverify'} & {m.split('.')[0] for m in sys.modules}"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
