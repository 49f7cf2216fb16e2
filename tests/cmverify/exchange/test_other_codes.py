"""Cases told to programs that we did not write: they answer what theory says they should.

LAMMPS's peridynamics (Debian's package lammps) leaves cut families as they are, as our treatment
``none`` does: its error, of families that are balls and not discs, is of the same size. FEniCSx
comes near the closed form.
"""

import os
import subprocess
import sys
from pathlib import Path
from shutil import which

import pytest

from cmverify.cases import registry
from cmverify.cases.surfaces.isotropic import bond
from cmverify.exchange.answers import read
from cmverify.exchange.case_export import write_case
from cmverify.exchange.compare import score
from references.fenicsx import bridge

EXAMPLES = Path(__file__).parents[3] / "examples"
CASE = registry.get("isotropic-hole")
POSE = CASE.poses[0]


def answered(folder: Path, n: int, command: list[str]) -> float:
    """The error of a program's answer to the case at 1/n."""
    write_case(CASE, POSE, n, folder / "problem")
    # Another interpreter is not to see what this one imports from.
    environment = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "VIRTUAL_ENV")}
    subprocess.run(command, cwd=folder, check=True, timeout=900, env=environment)
    statement = POSE.state(n)
    answer = read(folder / "fields.npz", statement.targets)
    return score(statement, answer).quantities["displacement"]


def test_the_case_sees_a_solid_that_is_another():
    right, wrong = (
        bond("extrapolated", 3, 20, distortion).quantities["displacement"]
        for distortion in (1.0, 1.05)
    )
    assert right == pytest.approx(0.0157, rel=0.01)
    assert abs(wrong - right) > 1e-3


@pytest.mark.slow
def test_lammps_agrees_with_surfaces_that_are_left_as_they_are(tmp_path):
    if which("lmp") is None:
        pytest.skip("no program lmp here: apt-get install lammps")
    script = str(EXAMPLES / "lammps_peri.py")
    error = answered(tmp_path, 20, [sys.executable, script, "problem", "fields.npz"])
    ours = bond("none", 3, 20).quantities["displacement"]
    assert 0.5 < error / ours < 1.5


@pytest.mark.slow
def test_fenicsx_comes_near_the_closed_form_at_third_order(tmp_path):
    found = bridge.find()
    if found is None:
        pytest.skip(bridge.INSTALL)
    errors = []
    for size in ("0.1", "0.05"):
        script = str(EXAMPLES / "fenicsx_hole.py")
        command = [found.python, script, "problem", size, "fields.npz"]
        errors.append(answered(tmp_path, 40, command))
    assert errors[0] < 6e-4
    assert 1.5 < errors[0] / errors[1] < 16.0
