"""Changes of a form are of every kind, differ from it, and none is made twice."""

import pytest

from references.errata.mutation import mutants


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a + b", "a - b"),
        ("a - b", "a + b"),
        ("a*b", "a / b"),
        ("a/b", "a * b"),
        ("a*b", "b"),
        ("a/b", "a"),
        ("-a", "a"),
        ("a", "-(a)"),
        ("a", "2*(a)"),
        ("a + b", "a + 2 * b"),
        ("3*a**2", "4 * a ** 2"),
        ("3*a**2", "3 * a ** 3"),
        ("C11 + C22", "C22 + C22"),
        ("u1q - u1", "u1 - u1"),
        ("c*x", "s * x"),
        ("0 if w >= wc else 1", "0 if w > wc else 1"),
        ("0 if w >= wc else 1", "1 if w >= wc else 0"),
        ("A @ B", "B"),
        ("p and q", "p"),
    ],
)
def test_changes_of_a_kind(text, expected):
    assert expected in mutants(text)


@pytest.mark.parametrize("text", ["S11*mu**4 - 2*S16*mu**3", "f(lambda w, wc: w*wc)", "[1, 2]"])
def test_changes_differ_and_are_made_once(text):
    found = mutants(text)
    assert len(found) == len(set(found))
    assert text.replace("*", " * ").replace(" *  * ", " ** ") not in found
    assert found


def test_the_last_digit_counts():
    assert mutants("33.97", digits=True) == ["33.96", "33.98", "34.07"]
