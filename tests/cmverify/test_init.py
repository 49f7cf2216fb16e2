"""`cmverify` finds its own solver, whatever else has that name, and costs nothing to import."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import cmverify
import solver
from cmverify.doctor import examine

ROOT = Path(__file__).parents[2]


def run(code, folder):
    """Run code in a folder that holds another `solver`, as a script there does."""
    return subprocess.run(
        [sys.executable, "-c", f"import sys; sys.path[:0] = ['', {str(ROOT)!r}]\n{code}"],
        cwd=folder, capture_output=True, text=True, check=False,
    )  # fmt: skip


@pytest.fixture
def other(tmp_path):
    """A folder of a user with a `solver` in it."""
    (tmp_path / "solver").mkdir()
    (tmp_path / "solver" / "__init__.py").write_text("OTHER = True\n")
    return tmp_path


def test_it_hands_on_what_the_solver_has():
    assert cmverify.__all__ == solver.__all__
    assert cmverify.Scene is solver.Scene
    assert set(solver.__all__) <= set(dir(cmverify))
    with pytest.raises(AttributeError, match="no attribute 'Scenes'"):
        _ = cmverify.Scenes


def test_importing_it_is_light(tmp_path):
    code = "before = set(sys.modules); import cmverify; print(sorted(set(sys.modules) - before))"
    loaded = run(code, tmp_path).stdout
    assert "'cmverify'" in loaded
    assert not any(name in loaded for name in ("solver", "numpy", "typer", "importlib.metadata"))


def test_another_solver_does_not_come_in_between(other):
    found = run("from cmverify import Scene; import solver; print(solver.__file__)", other)
    assert found.stdout.strip() == str(ROOT / "solver" / "__init__.py"), found.stderr


def test_another_solver_that_was_imported_before_is_named(other):
    found = run("import solver\nfrom cmverify import Scene", other)
    assert found.returncode == 1
    assert "another package called solver was imported before" in found.stderr
    found = run("import solver\nfrom cmverify.cli import app\napp(['list'])", other)
    assert found.returncode == 2, found.stderr
    assert "another package called solver was imported first" in found.stderr
    assert "Traceback" not in found.stderr


def test_files_called_as_modules_of_python_do_not_stop_the_program(tmp_path):
    # Not "types", "functools" and the like: Python itself needs them before it reaches our code.
    for name in ("random", "json", "signal", "numbers", "select", "solver"):
        (tmp_path / f"{name}.py").write_text("raise RuntimeError('not this one')\n")
    found = subprocess.run(
        [sys.executable, "-m", "cmverify", "run", "yardsticks", "--jobs", "1"],
        cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert found.returncode == 0, found.stdout + found.stderr


def test_the_doctor_sees_another_solver(other, monkeypatch):
    states = {f.subject: f for f in examine()}
    assert states["solver"].state == "ok"
    monkeypatch.chdir(other)
    found = {f.subject: f for f in examine()}["solver"]
    assert found.state == "note"
    assert "from cmverify import Scene" in found.detail
    assert str(other) in found.detail


def test_the_doctor_sees_another_distribution(tmp_path, monkeypatch):
    about = tmp_path / "othersolver-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: othersolver\nVersion: 1.0\n")
    (about / "top_level.txt").write_text("solver\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    found = {f.subject: f for f in examine()}["solver"]
    assert found.state == "problem"
    assert "othersolver" in found.detail
