"""Each kind of check passes on the truth and fails on a perturbation of 1 %."""

import math
from dataclasses import replace

import pytest

from cmverify.case import Case, Check, Failed, Level, Measurement, OrderBand
from cmverify.judge.norms import relative_l2, worst
from cmverify.judge.verdict import declared, judge, unjudged
from tests.cmverify.toy_registry import toy, trapezium


def outcomes(run, ladder=(10, 20, 40)):
    return {"bond/trapezium": {n: run(n) for n in ladder}}


def failed_kinds(case: Case, run) -> set[str]:
    return {v.kind for v in judge(case, outcomes(run)) if not v.passed}


def test_the_truth_passes_every_kind():
    verdicts = judge(toy(), outcomes(trapezium))
    assert {v.kind for v in verdicts} == {"bound", "order"}
    assert all(v.passed for v in verdicts)


def test_a_bound_that_holds_reads_as_if_it_held():
    """In two digits 0.155 had become 0.15, beside 0.152 that was measured."""
    check = Check("bond/trapezium", "integral", at_most={10: 0.155})
    within = replace(trapezium(10), quantities={"integral": 0.152})
    (verdict,) = judge(toy(checks=(check,)), {"bond/trapezium": {10: within}})
    assert verdict.passed
    assert f"{verdict.value:.3g} {verdict.asked}" == "0.152 ≤ 0.155"


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
    ran, silent = judge(case, {"bond/trapezium": {10: Failed("ArithmeticError", "no luck")}})
    assert (ran.kind, ran.passed) == ("ran", False)
    assert "no luck" in ran.message
    assert (silent.kind, silent.passed) == ("silent", False)


def test_a_case_that_judges_nothing_fails():
    case = toy(checks=(Check("bond/trapezium", "integral", {100: 1.0}),))
    (verdict,) = judge(case, outcomes(trapezium))
    assert not verdict.passed
    assert "judges" in verdict.message


def zero(n):
    return replace(trapezium(n), quantities={"integral": 0.0})


def test_errors_too_good_to_be_true_fail():
    """The trapezium rule is not exact for exp, and its order is two."""
    for wrong in (zero, lambda n: replace(trapezium(n), quantities={"integral": 1e-15 * n})):
        assert failed_kinds(toy(), wrong) == {"bound", "order"}
        assert all("too good" in v.message for v in judge(toy(), outcomes(wrong)))
    # Without an order only the floor of rounding is known.
    case = toy(checks=(Check("bond/trapezium", "integral", {10: 1e-2}),))
    assert failed_kinds(case, zero) == {"bound"}
    assert failed_kinds(case, lambda n: trapezium(n, 1.0)) == set()


def test_an_honest_gain_passes():
    """Ten times better than today: the lower end follows from the method."""

    def better(n):
        measured = trapezium(n)
        return replace(measured, quantities={"integral": 0.1 * measured.quantities["integral"]})

    assert failed_kinds(toy(), better) == set()


def test_what_is_exact_says_so():
    case = toy(checks=(Check("bond/trapezium", "integral", {10: 1e-12}, exact=True),))
    assert failed_kinds(case, zero) == set()
    with pytest.raises(ValueError, match="no order"):
        Check("m", "q", {1: 1.0}, order=OrderBand(1, 2), exact=True)


@pytest.mark.parametrize(
    "run",
    [
        zero,
        trapezium,
        lambda n: replace(trapezium(n), quantities={"integral": math.nan}),
        lambda n: replace(trapezium(n), quantities={}),
        lambda n: Failed("ArithmeticError", "no luck"),
    ],
)
def test_no_outcome_makes_a_check_vanish(run):
    said = [v for v in judge(toy(), outcomes(run, (10, 20))) if v.kind not in ("ran", "silent")]
    assert len(said) == declared(toy(), Level.QUICK) == 3


def spoilt(measured, where, value):
    """A measurement with one value in one of its places replaced."""
    if where == "field":
        (key, item) = next(iter(measured.fields.items.items()))
        computed = item.computed.copy()
        computed[3] = value
        items = {key: replace(item, computed=computed)}
        return replace(measured, fields=replace(measured.fields, items=items))
    if where == "curve":
        (line,) = measured.lines
        (curve,) = line.curves
        reference = curve.reference.copy()
        reference[-1] = value
        lines = (replace(line, curves=(replace(curve, reference=reference),)),)
        return replace(measured, lines=lines)
    return replace(measured, **{where: {**getattr(measured, where), "another": value}})


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("where", ["quantities", "seconds", "statistics", "field", "curve"])
def test_what_is_not_finite_fails_wherever_it_is(where, value):
    failed = failed_kinds(toy(), lambda n: spoilt(trapezium(n), where, value))
    assert failed == {"ran"}


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


def test_the_worst_of_errors_is_not_a_number_if_one_is():
    assert worst([0.1, 0.3]) == 0.3
    for place in range(3):
        errors = [0.1, 0.2, 0.3]
        errors[place] = math.nan
        assert math.isnan(worst(errors))
    with pytest.raises(ValueError, match="zero-size"):
        worst([])


def test_a_bound_of_zero_is_judged():
    """What must not be at all: nothing of it holds, anything of it fails and divides nothing."""
    checks = (Check("bond/trapezium", "integral", {10: 0.0}, exact=True),)
    for error, held in ((0.0, True), (1e-300, False), (math.nan, False)):
        found = replace(trapezium(10), quantities={"integral": error})
        verdicts = judge(toy(checks=checks), {"bond/trapezium": {10: found}})
        assert [v.passed for v in verdicts if v.kind == "bound"] == [held]
