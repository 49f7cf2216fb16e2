"""Forms are read exactly, and what is compared can differ."""

import numpy as np
import pytest
import sympy as sp

from references.errata import expression
from references.errata.algebra import COS, SIN, circle_integral, half_circle_integral, names


def test_literals_are_exact_where_symbols_are():
    assert expression.evaluate("1/3 + 0.1", {}) == sp.Rational(13, 30)
    assert expression.evaluate("1/3", {}, exact=False) == pytest.approx(1 / 3)


@pytest.mark.parametrize("text", ["1/0*nothing", "u[7]", "u.no", "Matrix(u)*Matrix(u)"])
def test_what_cannot_be_evaluated_is_an_assertion(text):
    with pytest.raises(AssertionError, match="cannot be evaluated"):
        expression.evaluate(text, names(u=[1, 2]))


def test_equal_expressions_are_equal_by_algebra():
    known = names("a b")
    one = expression.evaluate("(a + b)**2*(c**2 + s**2)", known)
    other = expression.evaluate("a**2 + 2*a*b + b**2", known)
    assert expression.same(one, other)
    assert not expression.same(one, other * sp.Rational(100001, 100000))


@pytest.mark.parametrize(
    ("first", "second", "equal"),
    [
        (np.array([1.0, 2.0]), np.array([1.0, 2.0 + 1e-12]), True),
        (np.array([1.0, 2.0]), np.array([1.0, 2.0 + 1e-7]), False),
        (np.array([1.0, 2.0]), np.array([1.0, 2.0, 3.0]), False),
        (np.array([1.0, np.nan]), np.array([1.0, 2.0]), False),
        (sp.eye(2), sp.Matrix([1, 0, 0, 1]), False),
        (sp.eye(2), sp.Integer(1), False),
        ([1, 0], [1, 0], True),
        ([1, 0], [1, 1], False),
    ],
)
def test_values_of_every_kind(first, second, equal):
    assert expression.same(first, second) is equal


@pytest.mark.parametrize(
    ("text", "value", "truncated", "right"),
    [
        ("33.97", 33.9706, False, True),
        ("33.96", 33.9706, False, False),
        ("3.65", 3.65714, False, False),
        ("3.65", 3.65714, True, True),
        ("45244", 45244, False, True),
        ("45344", 45244, False, False),
    ],
)
def test_printed_digits(text, value, truncated, right):
    assert expression.agrees_in_digits(float(text), value, text, truncated) is right


@pytest.mark.parametrize(
    ("integral", "ends"), [(circle_integral, (0, 2)), (half_circle_integral, (-0.5, 0.5))]
)
def test_moments_against_quadrature(integral, ends):
    law = 3 * COS**4 * SIN**2 - COS**3 * SIN + 2 + COS
    node, weight = np.polynomial.legendre.leggauss(60)
    low, high = (np.pi * end for end in ends)
    psi = low + (high - low) * (node + 1) / 2
    values = sp.lambdify((COS, SIN), law)(np.cos(psi), np.sin(psi))
    assert float(integral(law)) == pytest.approx((high - low) / 2 * np.sum(weight * values))
