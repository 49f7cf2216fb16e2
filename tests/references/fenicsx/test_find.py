"""How FEniCSx is looked for; needs none."""

import subprocess
import sys

import pytest

from references.fenicsx import bridge


def test_a_wrong_setting_is_an_error_not_a_fallback(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(bridge.VARIABLE, "/no/such/python")
    with pytest.raises(bridge.FenicsxError, match="/no/such/python"):
        bridge.find()


def test_nothing_found_is_none_and_says_how_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(bridge.VARIABLE, raising=False)
    monkeypatch.setattr(bridge, "_describe", lambda python: "No module named 'dolfinx'")
    assert bridge.find() is None
    with pytest.raises(bridge.FenicsxError, match="pip install 'cmverify"):
        bridge.run({})


def test_the_system_comes_after_this_interpreter(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(bridge.VARIABLE, raising=False)
    monkeypatch.setattr(bridge, "_describe", lambda python: {"dolfinx": python})
    found = bridge.find()
    assert found is not None
    assert found.python == sys.executable
    assert "this interpreter" in str(found)


def test_the_command_line_fails_loudly() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "references.fenicsx"],
        env={"PATH": "", bridge.VARIABLE: "/no/such/python"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode != 0
    assert "/no/such/python" in done.stderr


def test_foreign_settings_do_not_reach_the_worker(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV", "LD_LIBRARY_PATH"):
        monkeypatch.setenv(name, "/elsewhere")
    assert "/elsewhere" not in bridge._environment().values()
