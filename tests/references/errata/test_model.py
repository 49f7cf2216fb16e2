"""What a form says about itself is checked, and a form that says too little is refused."""

import pytest

from references.errata.algebra import names
from references.errata.model import Entry, Form, Verdict

KNOWN = names("a b")


def check(form, truth="a + b"):
    form.check(KNOWN, eval(truth, {}, KNOWN), exact=True)


@pytest.mark.parametrize(
    "form",
    [
        Form("b + a"),
        Form("a - b", "a + b", off="-2*b"),
        Form("2*a + 2*b", "a + b", ratio="2"),
    ],
)
def test_forms_that_stand_as_they_say(form):
    check(form)


@pytest.mark.parametrize(
    ("form", "reason"),
    [
        (Form("a - b"), "is not what is derived"),
        (Form("a - b", "a + b", off="2*b"), "is not what is derived"),
        (Form("a - b", "a + b"), "is not what is derived"),
        (Form("a - b", "a - b", off="-2*b"), "is not what is derived"),
        (Form("a + b", "b + a", off="0*a"), "does not differ"),
        (Form("2*a + b", "a + b", ratio="2"), "is not what is derived"),
        (Form("a + unknown"), "cannot be evaluated"),
    ],
)
def test_forms_that_do_not(form, reason):
    with pytest.raises(AssertionError, match=reason):
        check(form)


@pytest.mark.parametrize(
    ("form", "truth", "holds"),
    [
        (Form("2.3", digits=True), 2.26, True),
        (Form("2.3", digits=True), 2.36, False),
        (Form("2.3", "2.4", off="-0.1", digits=True), 2.36, True),
        (Form("2.3", "2.5", off="-0.1", digits=True), 2.36, False),
        (Form("2.3", digits=True, truncated=True), 2.36, True),
    ],
)
def test_printed_numbers(form, truth, holds):
    if holds:
        form.check({}, truth, exact=True)
    else:
        with pytest.raises(AssertionError):
            form.check({}, truth, exact=True)


def test_an_entry_wants_a_truth_for_every_form():
    item = Entry(
        "0", "t", Verdict.RIGHT, (Form("a"), Form("b")), lambda: (KNOWN["a"],), lambda: KNOWN
    )
    with pytest.raises(ValueError, match="shorter"):
        item.prove()


def test_numbers_are_put_into_effect_and_readings():
    item = Entry(
        "0", "t", Verdict.RIGHT, (), tuple, readings=("{x:.1f} so",), effect="{x:.2f}",
        measure=lambda: {"x": 1.25},
    )  # fmt: skip
    assert item.effect_in_numbers() == "1.25"
    assert item.readings_in_numbers() == ("1.2 so",)
