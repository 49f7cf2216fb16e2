"""Formulas: checked when they are read, safe and exact when they are evaluated."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cmverify.exchange.expressions import Formula, FormulaError

X, Y = np.array([0.5, 2.0, -1.0]), np.array([1.0, -1.0, 0.0])


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("abs(x, x)", "takes 1 argument, not 2"),
        ("maximum(x, y, -x)", "takes 2 arguments, not 3"),
        ("where(x > 0, x)", "takes 3 arguments, not 2"),
        ("sin(x, out=x)", "takes 1 argument"),
        ("(-8)**(1/3)", "no finite real value"),
        ("sqrt(-1)", "no finite real value"),
        ("9**9**9", "no finite real value"),
        ("x + 1/0", "no finite real value"),
        ("where(x > 0, 1/0, 1)", "no finite real value"),
        ("1j*x", "numbers are real"),
        ("x^2", r"write x\*\*2"),
        ("x < 1 and y < 2", "for 'and'"),
        ("(x < 1) & (y < 2)", "for 'and'"),
        ("0 < x < 1", "for 'and'"),
        ("x if x > 0 else y", "write where"),
        ("-(x < 1)", "calculates with the condition"),
        ("sin(x < 1)", "calculates with the condition"),
        ("where(x, 1, 2)", "first argument of where is a condition"),
        ("where(x < 1, y < 1, 2)", "between a condition and a value"),
        ("x == 1", "something else than"),
        ("True", "not allowed"),
        ("1" * 400, "too large"),
        ("(" * 5000 + "x" + ")" * 5000, "characters"),
        ("-" * 1900 + "x", "deeply nested|not a formula"),
        ("x" + "+x" * 900, "too long|not a formula"),
        ("", "not a formula"),
        ("x\x00", "not a formula"),
        ("lambda: x", "not allowed"),
    ],
)
def test_what_is_no_formula_is_refused_when_it_is_read(text, why):
    with pytest.raises(FormulaError, match=why):
        Formula(text)


@pytest.mark.parametrize(
    ("text", "point"),
    [
        ("sqrt(x)", r"x = \(-1, 0\)"),
        ("1/y", r"x = \(-1, 0\)"),
        ("exp(999*x)", r"x = \(2, -1\)"),
        ("where(x > 3, 1, 1/y)", r"x = \(-1, 0\)"),
        ("sqrt(x) < 9", r"x = \(-1, 0\)"),
        ("where(x < 9, sqrt(x) < 9, y < 9)", r"x = \(-1, 0\)"),
    ],
)
def test_values_that_are_not_finite_are_refused_with_their_point(text, point):
    with pytest.raises(FormulaError, match=point):
        Formula(text)(X, Y)


def test_the_branch_that_is_not_taken_does_not_matter():
    np.testing.assert_array_equal(
        Formula("where(x > 0, sqrt(x), 0)")(X, Y), [np.sqrt(0.5), np.sqrt(2.0), 0.0]
    )


def test_conditions_are_told_from_values():
    assert Formula("(x < 1) * (y < 2)").condition
    assert Formula("where(x < 1, y < 1, y > 1)").condition
    assert not Formula("(x < 1) * 2").condition
    assert Formula("(x < 1) + (y < 0)")(X, Y).tolist() == [True, True, True]


@given(st.sampled_from(["x", "+x", "abs(x)", "minimum(x, y)", "where(x < 0, x, y)", "x*1"]))
def test_what_a_formula_is_given_stays_as_it_was(text):
    x, y = X.copy(), Y.copy()
    result = Formula(text)(x, y)
    result[:] = 99.0
    np.testing.assert_array_equal(x, X)
    np.testing.assert_array_equal(y, Y)


def test_time_is_known_where_it_is_allowed():
    formula = Formula("x*sin(t) + where(t < 1, 0, y)", time=True)
    assert formula.timed
    assert not Formula("x + 1", time=True).timed
    for t in (0.5, 2.0):
        np.testing.assert_allclose(formula(X, Y, t), X * np.sin(t) + (t >= 1) * Y)
    assert Formula("cos(t)", time=True)(X, Y, 1.0).shape == X.shape
    with pytest.raises(FormulaError, match="depends on the time t: only values of supports"):
        Formula("sin(t)")
    with pytest.raises(FormulaError, match="may use x and y, t, pi"):
        Formula("sin(s)", time=True)
    with pytest.raises(FormulaError, match=r"log\(t\)' in .* at t = 0 s"):
        Formula("log(t)", time=True)(X, Y, 0.0)
    with pytest.raises(FormulaError, match=r"at x = \(-1, 0\), t = 3 s"):
        Formula("sqrt(x)*t", time=True)(X, Y, 3.0)
