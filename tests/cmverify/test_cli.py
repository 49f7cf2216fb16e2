"""The command line: exit codes, messages, and a quick --help."""

import json
import os
import shutil
import subprocess
import sys
from dataclasses import replace

import pytest
from typer.testing import CliRunner

from cmverify.case import Level
from cmverify.cases import registry
from cmverify.cli import app
from cmverify.doctor import examine
from cmverify.report import summary
from cmverify.run import environment, results, runner
from cmverify.run.threads import threads_per_worker
from references.fem import mesh
from references.fenicsx import bridge
from tests.cmverify import toy_registry

cli = CliRunner()


@pytest.fixture
def toys(monkeypatch):
    """Let the command line see toy cases only."""
    cases = toy_registry.CASES
    monkeypatch.setattr(registry, "all_cases", lambda: tuple(cases.values()))
    original = runner.run

    def run(*args, **kwargs):
        return original(*args, registry=toy_registry.__name__, **kwargs)

    monkeypatch.setattr(runner, "run", run)


def test_run_writes_everything_and_succeeds(toys, tmp_path):
    out, numbers = tmp_path / "out", tmp_path / "numbers.json"
    given = ["run", "toy", "--out", str(out), "--json", str(numbers), "--jobs", "1"]
    found = cli.invoke(app, given)
    assert found.exit_code == 0, found.output
    assert "All 3 checks of 1 case hold" in found.output
    assert (out / "index.html").is_file()
    assert json.loads(numbers.read_text())["passed"] is True
    assert list((out / "fields").glob("*.vtu"))
    again = cli.invoke(app, ["report", "--out", str(out)])
    assert again.exit_code == 0, again.output
    shown = cli.invoke(app, ["precision", "--out", str(out)])
    assert shown.exit_code == 0, shown.output
    assert "bond/trapezium" in shown.output
    next(out.glob("results/toy/*/0010.npz")).unlink()
    resumed = cli.invoke(app, [*given, "--resume", "--overwrite"])
    assert resumed.exit_code == 0, resumed.output
    assert resumed.output.count("reused") == 1


def test_a_run_of_some_cases_keeps_those_of_the_others(toys, tmp_path):
    """With their verdicts, and where they come from; the exit code is about what was run."""
    given = ["--jobs", "1", "--out", str(tmp_path)]
    assert cli.invoke(app, ["run", "toy", "raising", *given]).exit_code == 1
    first = json.loads((tmp_path / "run.json").read_text())
    again = cli.invoke(app, ["run", "toy", *given])
    assert again.exit_code == 0, again.output
    said = again.output.replace("\n", " ")
    assert "1 case is kept from earlier runs" in said
    assert "of which fail: raising" in said
    numbers = json.loads((tmp_path / "results.json").read_text())
    assert set(numbers["cases"]) == {"toy", "raising"}
    assert numbers["cases"]["raising"]["run"]["command"] == first["command"]
    assert not numbers["passed"]
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert "1 case was not measured again" in page
    assert "Beside the run before" in page
    info = summary.load_info(tmp_path)
    assert [task[0] for run in info.kept for task in run["measured"]] == ["raising", "raising"]
    whole = replace(info, measured=[*info.measured, ["raising", "bond/trapezium", 10]], kept=[])
    assert whole.keeping(info).kept == []


def test_one_failure_is_exit_code_one(toys, tmp_path):
    found = cli.invoke(app, ["run", "toys", "--out", str(tmp_path), "--jobs", "2"])
    assert found.exit_code == 1
    assert "no luck at 10" in found.output
    assert "exit code 7" in found.output
    assert (tmp_path / "index.html").is_file()


def test_wrong_names_and_empty_folders_are_refused(tmp_path):
    found = cli.invoke(app, ["run", "disk-cubic", "--out", str(tmp_path)])
    assert found.exit_code == 2
    assert "did you mean disc-cubic" in found.output
    found = cli.invoke(app, ["report", "--out", str(tmp_path)])
    assert found.exit_code == 2
    assert "holds no finished run" in found.output


def test_solve_writes_fields_and_names_a_wrong_key(tmp_path):
    from tests.cmverify.exchange.test_scene_file import SMALL

    scene = tmp_path / "scene.toml"
    scene.write_text(SMALL)
    found = cli.invoke(app, ["solve", str(scene)])
    assert found.exit_code == 0, found.output
    assert scene.with_suffix(".vtu").is_file()
    assert scene.with_suffix(".npz").is_file()
    scene.write_text(SMALL.replace("radius", "raduis"))
    found = cli.invoke(app, ["solve", str(scene), "--overwrite"])
    assert found.exit_code == 2
    assert "scene.toml:7" in found.output


def test_list_names_every_case():
    found = cli.invoke(app, ["list"])
    assert found.exit_code == 0
    listed = [line.split()[0] for line in found.output.splitlines()[1:]]
    assert listed == [case.name for case in registry.all_cases()]
    found = cli.invoke(app, ["list", "--json", "disc"])
    data = json.loads(found.output)
    assert [case["name"] for case in data] == [c.name for c in registry.select(["disc"])]
    assert data[0]["methods"]["fem/P1"]["quick"] == [25, 50]


def test_version_and_manners(toys, tmp_path):
    found = cli.invoke(app, ["--version"])
    assert found.exit_code == 0
    assert found.output.startswith("cmverify ")
    assert cli.invoke(app, ["-q", "-v", "list"]).exit_code == 2
    out = tmp_path / "a[/b]"  # a path that a markup would choke on
    given = ["run", "toy", "--jobs", "1", "--out", str(out)]
    loud = cli.invoke(app, ["-v", *given])
    assert loud.exit_code == 0, loud.output
    assert str(out / "index.html") in loud.output
    assert sum("integral" in line for line in loud.output.splitlines()) == 3
    quiet = cli.invoke(app, ["-q", *given, "--resume"])
    assert quiet.output.strip() == "All 3 checks of 1 case hold."  # older rich: a blank line


def test_shells_complete_cases_and_tags():
    from cmverify.cases.command import complete

    assert complete("crack-t") == ["crack-tip", "crack-tip-I", "crack-tip-II"]


def test_help_and_list_import_nothing_heavy():
    code = (
        "import sys, cmverify.cli, cmverify.cases.registry as r; r.all_cases();"
        "heavy = {'numba', 'scipy', 'matplotlib', 'skfem', 'gmsh', 'sympy'} & set(sys.modules);"
        "assert not heavy, heavy"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.fixture
def crippled(monkeypatch):
    """A machine on which gmsh does not load and Numba has no place for its cache."""

    def unavailable():
        raise mesh.MeshingUnavailableError("on Debian: apt-get install libx-deb")

    monkeypatch.setattr(mesh, "load_gmsh", unavailable)
    monkeypatch.setattr(environment, "_writable", lambda folder: False)
    monkeypatch.setattr(bridge, "find", lambda: None)


def test_doctor_names_what_is_missing(crippled):
    findings = {f.subject: f for f in examine()}
    assert "apt-get install libx-deb" in findings["gmsh"].detail
    assert findings["gmsh"].state == "problem"
    assert findings["Numba cache"].state == "note"
    assert findings["numpy"].state == "ok"
    assert findings["FEniCSx"].state == "note"


def test_doctor_exits_with_one_if_something_is_missing(crippled):
    found = cli.invoke(app, ["doctor"])
    assert found.exit_code == 1
    assert "libx-deb" in found.output


def test_the_fingerprint_is_of_the_sources():
    assert len(results.source_fingerprint()) == 16


@pytest.mark.parametrize("timeout", ["0", "-1", "nan"])
def test_a_measurement_needs_some_time(tmp_path, timeout):
    found = cli.invoke(
        app, ["run", "toughness", "--timeout", timeout, "--out", str(tmp_path / "a")]
    )
    assert found.exit_code == 2
    assert "--timeout" in found.output
    assert not (tmp_path / "a").exists()


@pytest.mark.parametrize("option", ["--out", "--json"])
def test_what_cannot_be_written_is_refused_before_anything_is_measured(toys, tmp_path, option):
    (tmp_path / "file").touch()
    given = {"--out": str(tmp_path / "out"), "--json": str(tmp_path / "all.json")}
    given[option] = str(tmp_path / "file" / "below")
    found = cli.invoke(app, ["run", "toy", *(part for pair in given.items() for part in pair)])
    assert found.exit_code == 2
    assert len(found.output.strip().splitlines()) == 1
    assert not list(tmp_path.glob("out/results/*"))


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """Records of a finished run, not yet reported."""
    folder = tmp_path_factory.mktemp("finished")
    cases, started = [toy_registry.CASES["toy"]], "2026-01-01T00:00:00"
    runner.run(cases, Level.QUICK, folder, registry=toy_registry.__name__)
    plan = [list(task) for task in runner.plan(cases, Level.QUICK)]
    about = environment.describe().as_dict()
    command = f"cmverify run toy --level quick --jobs 1 --out {folder}"
    info = summary.RunInfo("quick", 1, 1, command, started, 1.0, about, measured=plan)
    summary.save_info(info, folder)
    return folder


@pytest.mark.parametrize("damage", ["delete", "truncate", "edit", "arrays"])
def test_a_record_that_is_gone_or_damaged_is_no_success(toys, finished, tmp_path, damage):
    shutil.copytree(finished, tmp_path, dirs_exist_ok=True)
    path = next(tmp_path.glob("results/toy/*/0010.json"))
    if damage == "delete":
        path.unlink()
    elif damage == "truncate":
        path.write_bytes(path.read_bytes()[:100])
    elif damage == "edit":
        path.write_text(path.read_text().replace('"resolution": 10', '"resolution": 11'))
    else:
        path.with_suffix(".npz").unlink()
    found = cli.invoke(app, ["report", "--out", str(tmp_path)])
    assert found.exit_code == 1, found.output
    assert "1 measurement is missing: toy bond/trapezium" in found.output
    numbers = json.loads((tmp_path / "results.json").read_text())
    assert numbers["passed"] is False
    assert "--resume" in json.dumps(numbers)
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert "1 measurement is missing" in page
    assert "What fails" not in page  # nothing does: what is missing is told of by name
    # Measured again, and the other one not.
    current, threads = results.source_fingerprint(), threads_per_worker(1)
    kept = [
        runner._reusable(tmp_path, ("toy", "bond/trapezium", n), threads, current) for n in (10, 20)
    ]
    assert kept == [False, True]


def test_a_disk_that_fills_up_stops_the_run_and_keeps_what_there_is(toys, tmp_path, monkeypatch):
    def full(*_, **__):
        raise runner.UnwritableError("the result of toy cannot be written: No space left")

    monkeypatch.setattr(runner, "run", full)
    found = cli.invoke(app, ["run", "toy", "--out", str(tmp_path), "--jobs", "1"])
    assert found.exit_code == 3
    assert "No space left" in found.output
    assert "--resume" in found.output


def test_the_page_is_written_under_any_locale(tmp_path):
    environment = {**os.environ, "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    for name in ("PYTHONIOENCODING", "LANG"):
        environment.pop(name, None)
    given = ["run", "yardsticks", "--jobs", "1", "--out", str(tmp_path)]
    found = subprocess.run(
        [sys.executable, "-m", "cmverify", *given],
        env=environment, capture_output=True, check=False,
    )  # fmt: skip
    assert found.returncode == 0, found.stderr
    assert "✓" in (tmp_path / "index.html").read_text(encoding="utf-8")
