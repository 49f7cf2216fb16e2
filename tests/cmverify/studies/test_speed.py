"""The speed study: what it measures is right, and its verdicts can fail. No test asserts time."""

from dataclasses import replace

import numpy as np
import PIL.Image
import pytest

from cmverify.studies.speed import accuracy, measure, modes, page, peers, verdicts
from cmverify.studies.speed.measure import Timing
from cmverify.studies.speed.scenes import crack_tip
from solver import Discretisation
from tests.cmverify.report import browser


def test_all_formats_hold_the_same_operator() -> None:
    rows = measure.kernel(12)
    kinds = {row.name.split(":")[0] for row in rows}
    assert kinds == {"elastic, 3 unknowns", "central, 2 unknowns", "conductive, 1 unknown"}
    for row in rows:
        assert row.values["error"] <= 1e-13
        assert row.values["ms"] > 0
        assert np.isfinite(row.values["slower"])


def test_alternative_solvers_reach_the_same_residual() -> None:
    rows = measure.solvers(12, repeats=1)
    assert rows[0].name == "bond solver, two-level CG, 1 thread"
    assert "SciPy CG, block Jacobi, CSR" in [row.name for row in rows]
    assert all(row.values["residual"] <= 1.01e-8 for row in rows)


def test_both_get_to_the_error_with_the_coarsest_that_does() -> None:
    ours, theirs = accuracy.to_an_error(2e-5, rounds=2)
    assert (ours.name, theirs.name) == ("bond/positive, a/20", "fem/P2, a/20")
    for row in (ours, theirs):
        assert 1e-7 < row.values["error"] <= 2e-5
        assert row.values["from"] <= row.values["slower"] <= row.values["to"]
    assert ours.values["slower"] == 1.0
    assert [v.passed for v in verdicts.of_accuracy([ours, ours])] == [True]
    slow = replace(theirs, values={**theirs.values, "from": 0.9})
    assert [v.passed for v in verdicts.of_accuracy([ours, slow])] == [False]


def test_calibrated_tips_and_graded_meshes_get_to_one_error(monkeypatch) -> None:
    monkeypatch.setattr(accuracy, "TIP_RESOLUTIONS", (20,))
    monkeypatch.setattr(accuracy, "TIP_ELEMENTS", (8,))
    rows = accuracy.at_a_tip((2e-3,), rounds=1)
    assert [row.name.split(",")[:2] for row in rows] == [
        ["mode I", " bond/calibrated tip"], ["mode I", " fem/P2 graded"],
        ["mode II", " bond/calibrated tip"], ["mode II", " fem/P2 graded"],
    ]  # fmt: skip
    assert all(row.values["error"] <= 2e-3 for row in rows)


def test_peers_know_the_rigid_motions_and_solve_the_same_system() -> None:
    problem = crack_tip(20).discretise()
    free = Discretisation.of(replace(crack_tip(12), supports=[]), free=True).operator
    modes = peers.rigid_modes(free)
    order = np.arange(free.shape[0]).reshape(3, -1).T.ravel()
    for mode in modes.T:
        x = np.empty_like(mode)
        x[order] = mode
        strained = free.matvec(np.cos(x / np.abs(x).max()) * np.abs(x).max())
        assert np.abs(free.matvec(x)).max() < 1e-12 * np.abs(strained).max()
    rhs = problem.right_hand_side()
    for run in peers.runs(problem, 1e-8):
        assert np.linalg.norm(problem.operator.matvec(run.x) - rhs) <= 2e-8 * np.linalg.norm(rhs)
        assert 0 < run.iterations < 60


def test_iterations_on_all_static_scenes() -> None:
    found = verdicts.of_scenes(measure.scenes(20))
    assert len(found) == 18
    assert all(v.passed for v in found), [v for v in found if not v.passed]


def test_surfaces_cost_few_iterations_and_nothing_where_there_are_none() -> None:
    rows = measure.surfaces(20)
    found = verdicts.of_surfaces(rows)
    assert len(found) == 8
    assert all(v.passed for v in found), [v for v in found if not v.passed]
    # Where there are free surfaces the treatment is there.
    by_name = {row.name: row.values for row in rows}
    assert by_name["plate with a hole: extrapolated"]["bytes ÷ none"] > 2


def test_single_precision_costs_no_iterations() -> None:
    rows = measure.preconditioner(30, 1)
    assert verdicts.of_preconditioner(rows)[0].passed
    single, double = (Timing(row.name, dict(row.values)) for row in rows)
    single.values["iterations to 1e-12"] += 1
    double.values["slower"] = 1.1
    assert not any(v.passed for v in verdicts.of_preconditioner([single, double]))


def test_growth_reports_flat_iterations_and_a_falling_error() -> None:
    rows = measure.growth((30, 60))
    assert all(row.values["iterations"] <= 12 for row in rows)
    assert rows[1].values["error"] < rows[0].values["error"]
    assert rows[1].values["particles"] > 3 * rows[0].values["particles"]


@pytest.mark.parametrize(
    ("judge", "good", "bad"),
    [
        (
            verdicts.of_kernel,
            Timing("x: SciPy CSR", {"slower": 5.05, "memory": 20.2, "error": 1e-15, "threads": 1}),
            Timing("x: SciPy CSR", {"slower": 4.95, "memory": 19.8, "error": 1e-12, "threads": 1}),
        ),
        (
            verdicts.of_kernel,
            Timing("x: matrix-free, 2 threads", {"slower": 1 / 1.62, "threads": 2}),
            Timing("x: matrix-free, 2 threads", {"slower": 1 / 1.58, "threads": 2}),
        ),
        (
            verdicts.of_surfaces,
            Timing("heat: extrapolated", {"iterations ÷ none": 1.5, "bytes ÷ none": 1.0}),
            Timing("heat: extrapolated", {"iterations ÷ none": 1.51, "bytes ÷ none": 1.01}),
        ),
        (
            verdicts.of_solvers,
            Timing("MKL PARDISO", {"slower": 30.3}),
            Timing("MKL PARDISO", {"slower": 29.7}),
        ),
        (
            verdicts.of_heat,
            Timing("PETSc CG, GAMG", {"slower": 8.1}),
            Timing("PETSc CG, GAMG", {"slower": 7.9}),
        ),
        (
            verdicts.of_modes,
            Timing("eigsh, SuperLU", {"slower": 30.3, "residual": 0.9e-8}),
            Timing("eigsh, SuperLU", {"slower": 29.7, "residual": 1.1e-8}),
        ),
        (
            verdicts.of_growth,
            Timing("a/60", {"iterations": 12, "us_per_particle": 1.0, "peak_gb": 1.0}),
            Timing("a/60", {"iterations": 13, "us_per_particle": 1.0, "peak_gb": 1.0}),
        ),
    ],
)
def test_verdicts_turn_at_their_bounds(judge, good: Timing, bad: Timing) -> None:  # type: ignore[no-untyped-def]
    assert all(v.passed for v in judge([good]))
    assert not any(v.passed for v in judge([bad]))


def test_a_million_particles_are_held_to_cost_and_memory() -> None:
    base = Timing("a/120", {"iterations": 12, "us_per_particle": 10.0, "peak_gb": 0.3})
    large = Timing("a/560", {"iterations": 12, "us_per_particle": 15.2, "peak_gb": 4.1})
    failed = [
        f"{v.method}: {v.quantity}" for v in verdicts.of_growth([base, large]) if not v.passed
    ]
    assert failed == ["a/560: time per particle ÷ a/120's", "a/560: peak memory, GB"]


def test_not_a_number_fails() -> None:
    row = Timing("MKL PARDISO", {"slower": float("nan")})
    assert not verdicts.of_solvers([row])[0].passed


def test_modes_of_others_are_ours() -> None:
    """The same pencil on both sides; copies that a Lanczos method loses are counted."""
    ours, *others = modes.compare(14)
    assert ours.values["residual"] < 1e-8
    assert "SciPy eigsh, SuperLU" in [row.name for row in others]
    for row in others:
        assert row.values["slower"] > 0
        assert 0 <= row.values["amiss"] <= modes.COUNT
    assert others[0].values["residual"] < 1e-6


def test_the_page_has_every_table_and_what_must_hold(tmp_path) -> None:
    image = tmp_path / "speed.png"
    PIL.Image.new("RGB", (4, 3), "white").save(image)
    (tmp_path / "speed.json").write_text("{}")
    machine = {"processor": "p", "cores": 2, "python": "3", "commit": ""}
    many = {f"a long name {k}": 1.2345 for k in range(10)}
    tables = {"Growth <x>": [{"name": "a/30", "values": {"us_per_particle": 1.2345, "n": 7}}],
              "Many": [{"name": "hole", "values": many}]}  # fmt: skip
    document = {"level": "standard", "machine": machine, "tables": tables, "command": "again"}
    bounds = [verdicts._at_least("k: gain", 1.0, 2.0), verdicts._at_most("k: error", 0.5, 1.0)]
    written = page.write(document, bounds, image)
    text = written.read_text(encoding="utf-8")
    assert browser.dead_links(written) == []
    for part in ("1 of 2 bounds hold", "Growth &lt;x&gt;", "us per particle", "1.23", "≥ 2"):
        assert part in text
    assert text.index("≥ 2") < text.index("≤ 1"), "what fails comes first"
    # Ten columns are two tables of five.
    assert text.count('aria-label="Many"') == 2
    assert text.count("a long name") == 10
