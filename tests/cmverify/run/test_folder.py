"""Folders of runs: refused before any work, and held by one run at a time."""

import subprocess
import sys

import pytest

from cmverify.run.folder import FolderError, check_file, claimed

HOLD = """
import sys
from pathlib import Path
from cmverify.run.folder import claimed

with claimed(Path(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.read()
"""


def test_a_folder_that_cannot_be_is_refused(tmp_path):
    file = tmp_path / "file"
    file.touch()
    for path in (file, file / "below", tmp_path / ("x" * 300)):
        with (
            pytest.raises(FolderError, match="nothing can be written to the folder"),
            claimed(path),
        ):
            pass
    with pytest.raises(FolderError, match="is a folder"):
        check_file(tmp_path)


def test_one_run_holds_a_folder(tmp_path):
    other = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(tmp_path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    with other:
        assert other.stdout.readline() == "held\n"
        with pytest.raises(FolderError, match=rf"process {other.pid}\) is wr"), claimed(tmp_path):
            pass
        # However the other one ends, the system lets go.
        other.kill()
        other.wait(30)
    with claimed(tmp_path):
        pass


def test_nothing_is_left_but_the_lock(tmp_path):
    with claimed(tmp_path):
        pass
    assert sorted(p.name for p in tmp_path.iterdir()) == [".lock", "results"]
