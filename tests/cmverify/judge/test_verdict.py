"""Each kind of check passes on the truth and fails on a perturbation of 1 %."""

import math
from dataclasses import replace

import pytest

from cmverify.case import Case, Check, Failed, Measurement, OrderBand
from cmverify.judge.norms import relative_l2
from cmverify.judge.verdict import judge, unjudged
from tests.cmverify.toy_registry import toy, trapezium


def outcomes(run, ladder=(10, 20, 40)):
    return {"bond/trapezium": {n: run(n) for n in ladder}}


def failed_kinds(case: Case, run) -> set[str]:
    return {v.kind for v in judge(case, outcomes(run)) if not v.passed}


def test_the_truth_passes_every_kind():
    verdicts = judge(toy(), outcomes(trapezium))
    assert {v.kind for v in verdicts} == {"ran", "bound", "order"}
    assert all(v.passed for v in verdicts)


def test_one_percent_fails_the_absolute_bound_and_the_order():
    assert failed_kinds(toy(), lambda n: trapezium(n, 1.01)) == {"bound", "order"}


def test_an_order_check_alone_sees_one_percent():
    case = toy(checks=(Check("bond/trapezium", "integral", order=OrderBand(1.9, 2.1)),))
    assert failed_kinds(case, trapezium) == set()
    assert failed_kinds(case, lambda n: trapezium(n, 1.01)) == {"order"}


def test_too_high_an_order_fails_as_well():
    case = toy(checks=(Check("bond/trapezium", "integral", order=OrderBand(0.5, 1.5)),))
    assert failed_kinds(case, trapezium) == {"order"}


def test_an_exact_count_fails_on_one_more():
    check = Check("bond/trapezium", "count", equals={10: 100.0})
    case = replace(toy(checks=()), checks=(check,), quantities={"integral": "", "count": ""})

    def counts(value):
        measured = Measurement(1, {"integral": 0.0, "count": value})
        return {"bond/trapezium": {10: measured}}

    assert all(v.passed for v in judge(case, counts(100.0)))
    for wrong in (101.0, 99.0, math.nan):  # 1 % of 100 is one particle
        assert not all(v.passed for v in judge(case, counts(wrong)))


def test_a_fitted_order_uses_all_resolutions():
    def uneven(n):  # second order on the whole, but one mesh in the middle is lucky
        return replace(trapezium(n), quantities={"integral": n**-2.0 * (0.5 if n == 20 else 1.0)})

    for fitted, wanted in ((False, {"order"}), (True, set())):
        band = OrderBand(1.5, 2.5, fitted=fitted)
        case = toy(checks=(Check("bond/trapezium", "integral", order=band),))
        assert failed_kinds(case, uneven) == wanted
    assert failed_kinds(case, lambda n: trapezium(n, 1.01)) == {"order"}
    broken = outcomes(trapezium)
    broken["bond/trapezium"][40] = replace(trapezium(40), quantities={"integral": math.nan})
    assert not next(v for v in judge(case, broken) if v.kind == "order").passed


def test_nan_and_missing_quantities_fail():
    nan = replace(trapezium(10), quantities={"integral": math.nan})
    none = replace(trapezium(10), quantities={})
    for broken in (nan, none):
        verdicts = judge(toy(), {"bond/trapezium": {10: broken, 20: trapezium(20)}})
        assert not any(v.passed for v in verdicts if v.kind in ("bound",) and v.where == "a/10")
        assert not any(v.passed for v in verdicts if v.kind == "order")
    assert any(v.kind == "ran" and not v.passed for v in judge(toy(), outcomes(lambda n: nan)))


def test_a_method_that_raised_fails_even_without_a_check():
    case = toy(checks=())
    (verdict,) = judge(case, {"bond/trapezium": {10: Failed("ArithmeticError", "no luck")}})
    assert not verdict.passed
    assert "no luck" in verdict.message


def test_noise_is_judged_by_the_bound_and_not_by_its_order():
    def rounding(n):
        return replace(trapezium(n), quantities={"integral": 1e-15 * n})

    verdicts = judge(toy(), outcomes(rounding))
    assert {v.kind for v in verdicts} == {"ran", "bound"}
    assert all(v.passed for v in verdicts)


def test_a_bound_holds_until_a_finer_one_is_listed():
    check = Check("m", "q", at_most={10: 1.0, 40: 0.1})
    assert [check.bound_at(n) for n in (5, 10, 20, 40, 80)] == [None, 1.0, 1.0, 0.1, 0.1]


def test_checks_that_a_level_does_not_reach_are_named():
    check = Check("bond/trapezium", "integral", at_most={100: 1e-5})
    case = toy(checks=(check,))
    assert unjudged(case, judge(case, outcomes(trapezium))) == [check]


def test_a_check_that_cannot_fail_is_refused():
    with pytest.raises(ValueError, match="can never fail"):
        Check("m", "q")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"featured": "none"}, "featured"),
        ({"primary": "none"}, "primary"),
        ({"checks": (Check("none", "integral", {1: 1.0}),)}, "unknown method"),
        ({"checks": (Check("bond/trapezium", "none", {1: 1.0}),)}, "undescribed"),
    ],
)
def test_inconsistent_cases_are_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        replace(toy(), **changes)


def test_relative_l2():
    assert relative_l2([3.0, 4.0], [3.0, 0.0]) == pytest.approx(4.0 / 3.0)
    assert relative_l2([[1.01, 1.01]], [[1.0, 1.0]]) == pytest.approx(0.01)
    assert math.isnan(relative_l2([math.nan], [1.0]))
    with pytest.raises(ValueError, match="vanishes"):
        relative_l2([1.0], [0.0])
    with pytest.raises(ValueError, match="match"):
        relative_l2([1.0, 2.0], [1.0])
    with pytest.raises(ValueError, match="no points"):
        relative_l2([], [])
