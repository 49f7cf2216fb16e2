"""A run says what it was made with."""

import sys
from types import ModuleType

import pytest

from cmverify.run import environment


@pytest.mark.parametrize(
    ("written", "said"), [("g1234abc", "1234abc"), ("1234abc", "1234abc"), (None, "")]
)
def test_an_installed_copy_knows_the_commit_it_was_built_from(monkeypatch, tmp_path, written, said):
    built = ModuleType("cmverify._version")
    built.commit_id = written
    monkeypatch.setitem(sys.modules, "cmverify._version", built)
    monkeypatch.setattr(environment, "__file__", str(tmp_path / "cmverify/run/environment.py"))
    assert environment.describe().commit == said


def test_a_build_from_an_archive_knows_none(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "cmverify._version", None)
    monkeypatch.setattr(environment, "__file__", str(tmp_path / "cmverify/run/environment.py"))
    assert environment.describe().commit == ""
