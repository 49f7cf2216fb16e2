"""Names, counts and figures as they are spelt."""

import re

import pytest

from cmverify.cases import registry
from cmverify.report.wording import counted, drawn, heading, mathtext, number, tidy


@pytest.mark.parametrize(
    ("value", "text"),
    [(float("nan"), "n/a"), (2828.0, "2\u202f828"), (1.234e-14, "1.2e-14"), (1.348, "1.35")],
)
def test_figures_are_printed_with_few_digits(value, text):
    assert number(value) == text


@pytest.mark.parametrize(
    ("name", "text"),
    [("critical K", "Critical K"), ("flux by Eq. 170", "Flux by Eq. 170"), ("K", "K"),
     ("a/W", "a/W"), ("bond/lattice at a/60", "bond/lattice at a/60"), ("rms near", "rms near"),
     ("m = 3", "m = 3"), ("1 − MAC", "1 − MAC"), ("δ/H", "δ/H"), ("σ₂₂", "σ₂₂")],
)  # fmt: skip
def test_words_are_capitalised_and_symbols_are_not(name, text):
    assert heading(name) == text


def test_no_name_of_a_quantity_loses_a_letter_but_its_first():
    for case in registry.all_cases():
        for name in case.quantities:
            assert heading(name)[1:] == name[1:]
            assert not re.search("[a-z]{2}_", name), f"{case.name}: {name} is a key and no name"


def test_exponents_and_counts():
    assert tidy("≤ 2e-06") == "≤ 2e-6"
    assert tidy("order 1e+10 … 1e-12") == "order 1e10 … 1e-12"
    assert counted(1, "check") == "1 check"
    assert counted(1200, "worker process", "worker processes") == "1\u202f200 worker processes"


@pytest.mark.parametrize(
    ("label", "plain", "shown"),
    [
        ("Stress $\\sigma_{22}$ (K/√a)", "Stress σ₂₂ (K/√a)", "Stress σ₂₂ (K/√a)"),
        ("$\\Delta\\phi/\\Delta\\phi_0$", "Δφ/Δφ₀", "Δφ/Δφ₀"),
        ("$10^{-3}$ Pa", "10⁻³ Pa", "10⁻³ Pa"),
        ("$u^*$ (mm)", "u* (mm)", "u* (mm)"),
        ("$K_\\mathrm{II}$", "K_II", "$K_\\mathrm{II}$"),  # figures set what Unicode lacks
        ("a_b costs 5 $", "a_b costs 5 $", "a_b costs 5 $"),
    ],
)
def test_mathtext_is_plain_where_unicode_has_it(label, plain, shown):
    assert mathtext(label) == plain
    assert drawn(label) == shown
