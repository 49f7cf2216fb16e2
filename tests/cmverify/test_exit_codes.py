"""Exit codes: 0 all holds, 1 a check fails, 2 the request is wrong, 3 interrupted; no traceback.

`test_cli` has the runs that hold and those that fail; here every command is asked for what it
cannot do.
"""

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

from cmverify import errata
from cmverify.cases import command as listing
from cmverify.cli import app
from cmverify.exchange import scene_file
from cmverify.exchange.output import existing_series
from tests.cmverify.exchange.test_scene_file import SMALL

#: Of each command: arguments that are wrong before any work. `file` is a file, `folder` a folder.
WRONG = {
    "compare": [["nosuch", "a.npz"], [], ["patch", "missing.npz"]],
    "doctor": [["nosuch"]],
    "errata": [["999"], ["--page", "file/x.html"], ["--page", "folder"]],
    "export": [["nosuch"], ["free-plates", "--out", "file/x"]],
    "faults": [["nosuch"], ["--nosuch"], ["--out", "file/x"]],
    "history": [["--results", "missing"], ["--results", "folder"], ["--out", "file/x"]],
    "list": [["nosuch"]],
    "material": [[], ["nosuch"], ["silicon", "--m", "0"], ["--voigt", "1,0,0,1,0,nan"],
                 ["broken.toml"], ["folder.toml"], ["--page", "file/x"],
                 ["silicon", "--page", "file"]],
    "new": [["nosuch"], ["static", "--out", "file/x"], ["static", "--out", "folder"]],
    "precision": [["--out", "missing"], ["nosuch"], ["--measure", "--quantity", "flux"],
                  ["--level", "quick"], ["--method", "fem/P2"], ["--overwrite"]],
    "report": [["--out", "missing"], ["--out", "file"]],
    "run": [["nosuch"], ["--jobs", "-1"], ["--timeout", "nan"], ["--level", "nosuch"],
            ["--dask", "x:1", "--jobs", "2"], ["patch", "--out", "file/x"],
            ["patch", "--json", "folder"]],
    "schema": [["--out", "file/x"], ["--folder", "file"]],
    "solve": [["missing.toml"], ["broken.toml"], ["folder"], ["."], ["x\0y"],
              ["scene.toml", "--out", "folder"], ["scene.toml", "--out", "file/x"],
              ["scene.toml", "--max-memory", "-1"], ["scene.toml", "--max-minutes", "0"],
              ["scene.toml", "--max-memory", "1e-9"], ["scene.toml", "--compare", "nosuch"]],
    "speed": [["--level", "nosuch"], ["--out", "file/x"]],
    "stability": [["--material", "nosuch"], ["--m", "nan", "--material", "silicon"],
                  ["--material", "silicon", "--out", "file/x"]],
    "sweep": [["missing.toml"], ["broken.toml"], ["folder"], ["scene.toml"],
              ["sweep.toml", "--jobs", "-1"], ["sweep.toml", "--out", "file"],
              ["sweep.toml", "--out", "file/x"]],
    "validity": [["nosuch"], ["--out", "missing"], ["--out", "file"]],
}  # fmt: skip


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder with some files that are no good."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").touch()
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder.toml").mkdir()
    (tmp_path / "broken.toml").write_bytes(b"\xff\xfe[")
    (tmp_path / "scene.toml").write_text(SMALL, encoding="utf-8")
    (tmp_path / "sweep.toml").write_text('scene = "scene.toml"\n[grid]\nm = [3]\n')
    return tmp_path


def invoked(*given):
    found = CliRunner().invoke(app, given)
    assert found.exception is None or isinstance(found.exception, SystemExit), found.exception
    assert "Traceback" not in found.output
    return found.exit_code, found.output.strip()


def test_every_command_is_asked_for_something_wrong():
    group = typer.main.get_command(app)
    assert set(group.commands) == set(WRONG)


@pytest.mark.parametrize(
    ("command", "given"), [(c, g) for c, several in WRONG.items() for g in several], ids=str
)
def test_wrong_requests_are_two_in_few_words_and_leave_nothing(here, command, given):
    before = sorted(here.rglob("*"))
    code, said = invoked(command, *given)
    assert code == 2, said
    # A line of ours, or the usage as the parser tells it.
    assert len(said.splitlines()) == 1 or said.startswith("Usage: "), said
    assert sorted(here.rglob("*")) == before


def test_an_unknown_command_is_a_wrong_request():
    assert invoked("nosuch")[0] == 2
    assert invoked("--nosuch")[0] == 2


def test_a_check_that_fails_is_one(monkeypatch):
    monkeypatch.setattr(errata, "print_errata", lambda *_: False)
    assert invoked("errata")[0] == 1


@pytest.mark.parametrize("error", [KeyboardInterrupt(), MemoryError(), RuntimeError("odd [/x]")])
def test_what_breaks_off_is_three_in_one_line(here, monkeypatch, error):
    def broken(*_, **__):
        raise error

    monkeypatch.setattr(listing, "chosen", broken)
    code, said = invoked("list")
    assert code == 3
    assert said.startswith("interrupted: ")
    assert len(said.splitlines()) == 1


def test_a_fault_of_ours_is_shown_to_those_who_ask(monkeypatch):
    monkeypatch.setattr(listing, "chosen", lambda *_: 1 / 0)
    assert "ZeroDivisionError" in invoked("list")[1]
    found = CliRunner().invoke(app, ["--verbose", "list"])
    assert isinstance(found.exception, ZeroDivisionError)


# ---- scene files: encodings and hints ---------------------------------------------------


@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
def test_utf8_with_and_without_a_mark_under_any_locale(here, monkeypatch, mark):
    monkeypatch.setenv("LC_ALL", "C")
    text = f'title = "Scheibe, ø 2 m: ∇²T = 0"\n{SMALL}'
    (here / "scene.toml").write_bytes(mark + text.encode())
    assert scene_file.request(here / "scene.toml").file.title.startswith("Scheibe, ø")
    (here / "scene.toml").write_bytes(text.encode("utf-16"))
    assert invoked("solve", "scene.toml")[0] == 2
    # A line of a file with a mark has the number that an editor shows.
    (here / "scene.toml").write_bytes(mark + text.replace("radius", "raduis").encode())
    assert "scene.toml:8" in invoked("solve", "scene.toml")[1]


@pytest.mark.parametrize(
    ("formula", "hint"),
    [("x^2", "x**2"), ("x < 1 and y < 2", "(x < 1) * (y < 2)"), ("x < 1 or y < 2", "+ (y < 2)"),
     ("x if y < 0 else 1", "where("), ("0 < x < 1", "(x < 1) * (y < 2)")],
)  # fmt: skip
def test_what_other_languages_write_gets_a_hint(here, formula, hint):
    text = SMALL.replace("x**2 - 5*y**2", formula)
    (here / "scene.toml").write_text(text, encoding="utf-8")
    code, said = invoked("solve", "scene.toml")
    assert (code, hint in said, "scene.toml:15" in said) == (2, True, True), said


def test_a_solve_writes_whole_files_or_none(here, monkeypatch):
    """A disk that fills up while the second file is written leaves no half of it."""

    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez_compressed", full)
    code, said = invoked("solve", "scene.toml")
    assert code == 2
    assert "No space left" in said
    assert not [p for p in here.iterdir() if p.suffix in (".npz", ".partial")]


# ---- nothing is overwritten unasked ------------------------------------------------------

#: Of each command that writes: arguments, and a file that it would take the place of.
WRITES = {
    "compare": (["free-plates", "x.json"], "comparison/results.json"),
    "errata": (["1", "--page", "page.html"], "page.html"),
    "export": (["free-plates"], "free-plates/bonds.npz"),
    "faults": (["--out", "report"], "report/faults.html"),
    "history": ([], "report/history.html"),
    "material": (["silicon", "--json", "numbers.json"], "numbers.json"),
    "new": (["static"], "static.toml"),
    "precision": (["--measure"], "report/precision.csv"),
    "run": (["patch", "--json", "numbers.json"], "numbers.json"),
    "schema": (["--folder", "docs"], "docs/scene-files.md"),
    "solve": (["scene.toml"], "scene.npz"),
    "speed": ([], "speed/speed.png"),
    "stability": (["--material", "silicon"], "report/stability-polar-1.png"),
}
#: A run takes the place of a run, a sweep goes on, and a report is asked to be rendered again.
OWN = {"run": "report/index.html", "sweep": "sweep/sweep.csv"}
READS = {"doctor", "list", "report", "validity"}


def precious(path):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("precious")
    return path


def test_every_command_that_writes_asks_first():
    group = typer.main.get_command(app)
    assert set(WRITES) | set(OWN) | READS == set(group.commands)
    asking = {n for n, c in group.commands.items() if "overwrite" in {p.name for p in c.params}}
    assert asking == set(WRITES) | {"report"}


@pytest.mark.parametrize("command", WRITES)
def test_nothing_is_overwritten_unasked(here, command):
    given, name = WRITES[command]
    path = precious(here / name)
    before = sorted(here.rglob("*"))
    code, said = invoked(command, *given)
    assert (code, path.name in said, "--overwrite" in said) == (2, True, True), said
    assert path.read_text() == "precious"
    assert sorted(here.rglob("*")) == before


@pytest.mark.parametrize("command", OWN)
def test_folders_of_others_are_left_alone(here, command):
    path = precious(here / OWN[command])
    code, said = invoked(command, {"run": "patch"}.get(command, "sweep.toml"))
    assert (code, path.name in said) == (2, True), said
    assert path.read_text() == "precious"


@pytest.mark.parametrize(
    ("command", "given", "name"),
    [("errata", ["1", "--page", "page.html"], "page.html"),
     ("export", ["free-plates"], "free-plates/case.json"),
     ("schema", ["--out", "schema.json"], "schema.json")],
)  # fmt: skip
def test_what_is_asked_for_is_overwritten(here, command, given, name):
    path = precious(here / name)
    code, said = invoked(command, *given, "--overwrite")
    assert code == 0, said
    assert path.read_text(encoding="utf-8") != "precious"


def test_a_series_is_kept_unless_a_checkpoint_goes_on(tmp_path):
    stem = tmp_path / "frames"
    assert existing_series({"series": str(stem)}) == []
    precious(tmp_path / "frames_extra.vtu")
    first, listed = precious(tmp_path / "frames_00000.vtu"), precious(tmp_path / "frames.pvd")
    assert existing_series({"series": str(stem)}) == [listed, first]
    state = tmp_path / "state.npz"
    going = {"series": str(stem), "checkpoint": str(state)}
    assert existing_series(going) == [listed, first]
    state.touch()
    assert existing_series(going) == existing_series({}) == []
