"""Tests mirror the source tree, and examples in docstrings are run."""

import doctest
import importlib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("solver", "cmverify")

#: Modules whose tests have another name, and which. A new module needs a test of its own name,
#: or one of its room's; nothing is to be added here without a reason.
ELSEWHERE = {
    "cmverify/studies/crosscheck_command.py": "tests/cmverify/studies/test_crosscheck.py",
    "cmverify/report/crosscheck_chapter.py": "tests/cmverify/studies/test_crosscheck.py",
    "cmverify/studies/history_command.py": "tests/cmverify/report/test_history.py",
    "cmverify/studies/precision_command.py": "tests/cmverify/studies/test_precision.py",
    # Aliases of types, and classes without a body.
    "solver/arrays.py": "tests/test_architecture.py",
    "solver/errors.py": "tests/solver/test_scene.py",
    # The state of a body that warms, which nothing but transients drive.
    "solver/analyses/heating.py": "tests/solver/analyses/test_transient.py",
    # How a motion steps: both methods are held against the same laws.
    "solver/analyses/newmark_motion.py": "tests/solver/analyses/test_motion.py",
    "solver/analyses/verlet_motion.py": "tests/solver/analyses/test_motion.py",
    # A case is run, and perturbed, as a whole.
    "cmverify/case.py": "tests/cmverify/judge/test_verdict.py",
    "cmverify/cases/beside_elements.py": "tests/cmverify/faults/test_table.py",
    "cmverify/cases/closed_forms/constants.py": "tests/cmverify/faults/test_table.py",
    "cmverify/cases/closed_forms/differences.py": "tests/cmverify/faults/test_table.py",
    "cmverify/cases/closed_forms/elements.py": "tests/cmverify/faults/test_table.py",
    "cmverify/cases/closed_forms/fields.py": "tests/cmverify/faults/test_table.py",
    "cmverify/cases/common/adapters.py": "tests/cmverify/cases/test_registry.py",
    "cmverify/cases/common/bond_energies.py": "tests/cmverify/cases/test_hard.py",
    "cmverify/cases/common/materials.py": "tests/cmverify/cases/test_hard.py",
    "cmverify/cases/common/scenes.py": "tests/cmverify/cases/test_registry.py",
    "cmverify/cases/counts.py": "tests/cmverify/cases/test_registry.py",
    "cmverify/cases/crack_tip/drawn.py": "tests/cmverify/cases/test_registry.py",
    "cmverify/cases/crack_tip/measure.py": "tests/cmverify/cases/test_registry.py",
    "cmverify/cases/crack_tip/problem.py": "tests/cmverify/cases/test_registry.py",
    "cmverify/cases/disc.py": "tests/cmverify/cases/test_registry.py",
    "cmverify/cases/first_break.py": "tests/cmverify/faults/test_table.py",
    "cmverify/cases/surfaces/isotropic.py": "tests/cmverify/exchange/test_other_codes.py",
    "cmverify/cases/patch.py": "tests/cmverify/cases/test_registry.py",
    "cmverify/cases/recovered.py": "tests/cmverify/faults/test_table.py",
    "cmverify/cases/solids.py": "tests/cmverify/faults/test_table.py",
    "cmverify/cases/yardsticks.py": "tests/cmverify/faults/test_table.py",
    # Tables and the command that prints them.
    "cmverify/faults/changes.py": "tests/cmverify/faults/test_fault.py",
    "cmverify/faults/command.py": "tests/cmverify/faults/test_table.py",
    "cmverify/faults/in_judges.py": "tests/cmverify/faults/test_table.py",
    "cmverify/faults/in_references.py": "tests/cmverify/faults/test_table.py",
    "cmverify/faults/in_dynamics.py": "tests/cmverify/faults/test_table.py",
    "cmverify/faults/in_bodies.py": "tests/cmverify/faults/test_table.py",
    "cmverify/faults/in_fracture.py": "tests/cmverify/faults/test_table.py",
    "cmverify/faults/in_materials.py": "tests/cmverify/faults/test_table.py",
    "cmverify/faults/in_solutions.py": "tests/cmverify/faults/test_table.py",
    "cmverify/faults/in_methods.py": "tests/cmverify/faults/test_table.py",
    "cmverify/faults/page.py": "tests/cmverify/faults/test_table.py",
    "cmverify/faults/registry.py": "tests/cmverify/faults/test_table.py",
    "cmverify/faults/trial.py": "tests/cmverify/faults/test_table.py",
    "cmverify/judge/norms.py": "tests/cmverify/judge/test_verdict.py",
    "cmverify/report/figures.py": "tests/cmverify/report/test_build.py",
    "cmverify/report/stages.py": "tests/cmverify/report/test_build.py",
    "cmverify/report/style.py": "tests/cmverify/report/test_build.py",
    "cmverify/report/precision_chapter.py": "tests/cmverify/studies/test_precision.py",
    "cmverify/report/summary.py": "tests/cmverify/report/test_build.py",
    "cmverify/report/terminal.py": "tests/cmverify/test_cli.py",
    # Commands and what they run.
    "cmverify/cases/command.py": "tests/cmverify/test_cli.py",
    "cmverify/report/command.py": "tests/cmverify/test_cli.py",
    "cmverify/run/command.py": "tests/cmverify/test_cli.py",
    "cmverify/doctor.py": "tests/cmverify/test_cli.py",
    "cmverify/exchange/command.py": "tests/cmverify/exchange/test_start_file.py",
    "cmverify/exchange/meanings.py": "tests/cmverify/exchange/test_schema.py",
    "cmverify/exchange/reference_page.py": "tests/cmverify/exchange/test_schema.py",
    "cmverify/exchange/export.py": "tests/cmverify/exchange/test_scene_file.py",
    "cmverify/exchange/compare_command.py": "tests/cmverify/exchange/test_compare.py",
    "cmverify/exchange/statement.py": "tests/cmverify/exchange/test_case_export.py",
    "cmverify/exchange/beforehand.py": "tests/cmverify/exchange/test_scene_file.py",
    "cmverify/exchange/body_tables.py": "tests/cmverify/exchange/test_model.py",
    "cmverify/exchange/finite_elements.py": "tests/cmverify/exchange/test_comparison.py",
    "cmverify/exchange/quantities.py": "tests/cmverify/exchange/test_comparison.py",
    "cmverify/exchange/mirrored_coupled.py": "tests/cmverify/exchange/test_mirrored.py",
    "cmverify/exchange/solve_command.py": "tests/cmverify/exchange/test_scene_file.py",
    "cmverify/exchange/shapes.py": "tests/cmverify/exchange/test_model.py",
    "cmverify/exchange/table.py": "tests/cmverify/exchange/test_model.py",
    "cmverify/exchange/request.py": "tests/cmverify/exchange/test_scene_file.py",
    "cmverify/exchange/refusal.py": "tests/cmverify/exchange/test_scene_file.py",
    "cmverify/sweep/command.py": "tests/cmverify/sweep/test_run.py",
    "cmverify/sweep/work.py": "tests/cmverify/sweep/test_run.py",
    "cmverify/run/threads.py": "tests/cmverify/run/test_runner.py",
}
#: Run by asv, which `asv check` and a quick run test in CI.
UNTESTED = ("cmverify/benchmarks/",)


def sources(*packages: str) -> list[Path]:
    found = [p for package in packages for p in sorted((ROOT / package).rglob("*.py"))]
    # `_version.py` is written by the build.
    return [
        p.relative_to(ROOT)
        for p in found
        if not p.stem.startswith("__") and p.name != "_version.py"
    ]


def named_tests(source: Path) -> list[Path]:
    """The test of a module's name, and those of the rooms that it lies in."""
    names = [Path("tests") / source.parent / f"test_{source.stem}.py"]
    for room in list(source.parents)[:-2]:
        names.append(Path("tests") / room.parent / f"test_{room.name}.py")
    return names


@pytest.mark.parametrize("source", sources(*PACKAGES), ids=str)
def test_every_module_has_a_test_of_its_name(source):
    if source.as_posix().startswith(UNTESTED):
        return
    if source.as_posix() in ELSEWHERE:
        assert (ROOT / ELSEWHERE[source.as_posix()]).is_file()
        return
    wanted = named_tests(source)
    # In the solver a room's test is not enough.
    wanted = wanted[:1] if source.parts[0] == "solver" else wanted
    assert any((ROOT / test).is_file() for test in wanted), f"no {wanted[0]}"


def test_nothing_is_excused_that_has_a_test_or_is_no_more():
    for source in map(Path, ELSEWHERE):
        assert (ROOT / source).is_file(), source
        assert not (ROOT / named_tests(source)[0]).is_file(), source


EXAMPLES = [
    source
    for source in sources("solver", "references", "cmverify")
    if ">>> " in (ROOT / source).read_text(encoding="utf-8")
]


@pytest.mark.parametrize("source", EXAMPLES, ids=str)
def test_examples_in_docstrings_give_what_they_say(source):
    module = importlib.import_module(".".join(source.with_suffix("").parts))
    outcome = doctest.testmod(module, optionflags=doctest.NORMALIZE_WHITESPACE)
    assert outcome.attempted
    assert not outcome.failed


def test_there_are_examples():
    assert len(EXAMPLES) >= 10
