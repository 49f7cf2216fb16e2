"""The declared cases: complete, and each kind of check in them sees a change of 1 %."""

import ast
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cmverify.case import Case, Level, Measurement
from cmverify.cases import counts, crack_tip, disc, patch, registry
from cmverify.cases.common import adapters
from cmverify.cases.crack_tip import measure
from cmverify.judge.verdict import declared, judge


def verdict_of(case: Case, method: str, run, ladder, quantity: str, kind: str) -> list[bool]:
    """Whether each check of a kind holds when `run` stands for a method of the case."""
    verdicts = judge(case, {method: {n: run(n) for n in ladder}})
    found = [v.passed for v in verdicts if v.quantity == quantity and v.kind == kind]
    assert found, f"{case.name} has no {kind} check of {quantity}"
    return found


def test_every_case_says_what_a_reader_needs():
    for case in registry.all_cases():
        assert case.title
        assert case.section.startswith("Sect")
        assert case.shows.endswith(".")
        for level in Level:
            assert list(case.plan(level)), f"{case.name} measures nothing at {level}"


def test_every_case_judges_something_at_every_level():
    for case in registry.all_cases():
        for level in Level:
            assert declared(case, level), f"{case.name} judges nothing at {level}"


#: How many checks there are at least. A check that goes has to be taken off here, with a reason.
CHECKS = {Level.QUICK: 437, Level.STANDARD: 1113, Level.PAPER: 1434}


@pytest.mark.parametrize("level", Level)
def test_no_check_is_lost_without_a_word(level):
    assert sum(declared(case, level) for case in registry.all_cases()) >= CHECKS[level]


def test_bounds_say_where_they_come_from():
    """In the words of the field: this project's history says nothing to a reader."""
    for case in registry.all_cases():
        for check in case.checks:
            assert check.source, f"{case.name}: {check.method} {check.quantity}"
            assert not re.search(r"\bissue\b|what must hold", check.source)


#: What lets NaN pass: `cmverify.judge.norms.worst` does not.
SWALLOWS = ("fmax", "fmin", "nanmax", "nanmin", "nanmean", "nanmedian", "nansum", "nanstd")


def test_no_case_uses_what_lets_nan_pass():
    folder = Path(registry.__file__).parent
    for path in folder.rglob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        names = {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
        assert not names & set(SWALLOWS), path


def test_levels_grow():
    for case in registry.all_cases():
        for method in case.methods:
            ladders = [method.resolutions.get(level, ()) for level in Level]
            if not ladders[0]:  # a method for the longer levels only
                assert ladders[2]
                continue
            assert ladders[0][0] == ladders[2][0]
            assert ladders[0][-1] <= ladders[1][-1] <= ladders[2][-1]


def test_selection_by_name_and_tag():
    assert [c.name for c in registry.select(["disc-cubic"])] == ["disc-cubic"]
    assert {c.name for c in registry.select(["crack-tip"])} == {"crack-tip-I", "crack-tip-II"}
    assert registry.select([]) == registry.all_cases()
    with pytest.raises(ValueError, match="did you mean disc-cubic"):
        registry.select(["disc-cubi"])


@pytest.mark.parametrize(
    ("case", "calibration"),
    [
        (disc.CASES[0], "lattice"),
        (disc.CASES[0], "positive"),
        (disc.CASES[1], "lattice"),
        (disc.CASES[1], "positive"),
        (disc.CASES[2], "positive"),
    ],
)
def test_disc_sees_one_percent_of_conductivity(case, calibration):
    problem = {"disc-cubic": disc.CUBIC, "disc-source": disc.PRINTED}.get(
        case.name, disc.EXPONENTIAL
    )
    (d11, d12), row = disc.CONDUCTIVITY
    wrong = replace(problem, conductivity=((1.01 * d11, d12), row))
    name = f"bond/{calibration}"

    def run(n):
        return disc.bond(wrong, calibration, n)

    assert not any(verdict_of(case, name, run, (25,), "temperature", "bound"))


def test_disc_orders_see_one_percent_of_the_reference():
    """An error that refinement does not remove has no order, for lattice and elements alike."""
    case = disc.CASES[2]
    (d11, d12), row = disc.CONDUCTIVITY
    wrong = replace(disc.EXPONENTIAL, conductivity=((1.01 * d11, d12), row))
    for name, run in (
        ("bond/positive", lambda n: disc.bond(wrong, "positive", n)),
        ("fem/P1", lambda n: disc.fem(wrong, 1, n)),
        ("fem/P2", lambda n: disc.fem(wrong, 2, n)),
    ):
        assert verdict_of(case, name, run, (25, 50), "temperature", "order") == [False]


class WrongFlux:
    """A closed form whose flux is 1 % too large."""

    def __init__(self, exact):
        self.value, self.source, self.right = exact.value, exact.source, exact.flux

    def flux(self, x, y):
        return 1.01 * self.right(x, y)


@pytest.mark.parametrize("calibration", ["lattice", "positive"])
def test_flux_sees_one_percent_of_the_reference(calibration):
    case = disc.CASES[0]
    wrong = disc.Problem(lambda: WrongFlux(disc.CUBIC.exact()))

    def run(n):
        return disc.bond(wrong, calibration, n)

    args = (case, f"bond/{calibration}", run)
    assert verdict_of(*args, (100,), "flux", "bound") == [False]
    assert verdict_of(*args, (25, 50), "flux", "order") == [False]


@pytest.mark.parametrize(
    ("case", "mode"), [(crack_tip.CASES[0], (1, 0)), (crack_tip.CASES[1], (0, 1))]
)
def test_crack_tip_sees_one_percent_of_the_reference(case, mode):
    """An error of 1 % beside the discretisation error: bound and order both see it at a/60."""
    wrong = crack_tip.Problem(*map(float, mode), scale=1.01)

    def run(n):
        return crack_tip.bond(wrong, "lattice", n)

    args = (case, "bond/lattice", run, (30, 60), "displacement")
    assert not verdict_of(*args, "bound")[-1]
    assert verdict_of(*args, "order") == [False]


@pytest.mark.parametrize("kind", ["K", "K by series"])
def test_intensities_see_one_percent_of_the_reference(kind):
    def run(scale):
        problem = crack_tip.Problem(1.0, 0.0, scale=scale)
        return lambda n: crack_tip.bond(problem, "lattice", n)

    case = crack_tip.CASES[0]
    assert verdict_of(case, "bond/lattice", run(1.0), (30,), kind, "bound") == [True]
    assert verdict_of(case, "bond/lattice", run(1.01), (30,), kind, "bound") == [False]


def test_stress_ahead_sees_five_percent():
    """The bound is 5 %: the deviation is measured rightly if a factor of 1.06 breaks it."""
    case = crack_tip.CASES[0]
    runs = {
        scale: crack_tip.bond(crack_tip.Problem(1.0, 0.0, scale=scale), "lattice", 30)
        for scale in (1.0, 1.01, 1.06)
    }
    deviations = {scale: run.quantities["stress ahead"] for scale, run in runs.items()}
    assert deviations[1.01] == pytest.approx(0.01, abs=2e-3)

    def holds(scale):
        return verdict_of(
            case, "bond/lattice", lambda n: runs[scale], (120,), "stress ahead", "bound"
        )

    assert holds(1.0) == [True]
    assert holds(1.06) == [False]


@pytest.mark.parametrize("sign", patch.SIGNS)
def test_patch_sees_one_percent_of_stiffness(sign):
    (case,) = patch.CASES
    name = f"bond/lattice {patch.NAMES[sign]}"
    wrong = patch.Patch(sign, distortion=1.01)

    def run(n):
        return patch.patch(wrong, n)

    assert verdict_of(case, name, run, (20,), "displacement", "bound") == [False]


def test_random_tensors_have_the_sign_they_are_drawn_for():
    for sign, wanted in zip(patch.SIGNS, (1, 0, -1), strict=True):
        for _, voigt in zip(range(20), patch.random_tensors(sign), strict=False):
            np.testing.assert_array_equal(voigt, voigt.T)
            assert np.linalg.eigvalsh(voigt)[0] > 0
            assert np.sign(voigt[2, 2] - voigt[0, 1]) == wanted


def test_one_particle_more_is_seen():
    (case,) = counts.CASES

    def run(n):
        measured = counts.count(n)
        return replace(measured, quantities={"particles": measured.quantities["particles"] + 1})

    assert not any(verdict_of(case, "bond/lattice", run, (30, 60), "particles", "equal"))


def test_harness_and_solver_agree_on_the_lattice():
    for n, wanted in counts.COUNTS.items():
        assert len(adapters.disc_lattice(n)) == wanted
        assert len(adapters.free_points(n)) < wanted


def test_rows_are_the_nearest_and_the_upper_of_two():
    points = adapters.disc_lattice(10)
    assert set(points[adapters.row(points, 0.0, 0.1), 1]) == {0.05}
    assert np.allclose(points[adapters.row(points, 0.47, 0.1), 1], 0.45)
    assert np.all(np.diff(points[adapters.row(points, 0.0, 0.1), 0]) > 0)


def test_stress_ahead_of_nothing_is_not_a_pass():
    found = measure.stress_ahead(
        crack_tip.Problem(1.0, 0.0), np.array([[0.0, 0.9]]), lambda index: index * 1.0, 30
    )
    assert np.isnan(found["stress ahead"])


def test_pure_mode_two_has_no_stress_ahead():
    assert measure.stress_ahead(crack_tip.Problem(0.0, 1.0), np.zeros((1, 2)), len, 30) == {}


def test_measurements_are_complete_for_the_report():
    measured = disc.bond(disc.CUBIC, "positive", 25)
    assert isinstance(measured, Measurement)
    assert set(measured.quantities) == set(disc.QUANTITIES)
    assert measured.fields is not None
    assert {"temperature", "flux"} == set(measured.fields.items)
    assert measured.total_seconds > 0
    assert len(measured.lines) == 2


@pytest.mark.parametrize("case", [disc.CASES[0], crack_tip.CASES[0]], ids=lambda c: c.name)
def test_warm_up_compiles_everything_that_is_timed(case):
    """After the warm-up no kernel gains a signature: nothing is compiled while seconds count."""
    from solver.operators.bond_operator import kernels

    compiled = [k for k in vars(kernels).values() if hasattr(k, "signatures")]
    assert compiled
    for method in case.methods:
        if method.kind == "bond":
            method.warm_up()
            before = [list(kernel.signatures) for kernel in compiled]
            for n in method.resolutions.get(Level.QUICK, ()):
                method.run(n)
            assert [list(kernel.signatures) for kernel in compiled] == before
