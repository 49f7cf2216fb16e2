"""The same scene by finite elements: near, and far as soon as one of the two is wrong."""

import json
import tomllib

import numpy as np
import pytest
from typer.testing import CliRunner

from cmverify.cli import app
from cmverify.exchange import comparison, scene_file
from cmverify.exchange.refusal import SceneFileError

BODY = """
compare = "fem"
[discretisation]
spacing = 0.08
m = 3
surface = "extrapolated"
[[region]]
shape = "rectangle"
width = 2.0
height = 1.0
[[region]]
shape = "disc"
radius = 0.2
centre = [0.4, 0.0]
operation = "subtract"
"""
SOLID = """
[material]
kind = "orthotropic"
E1 = 2.0
E2 = 1.0
G12 = 0.5
nu12 = 0.2
angle_degrees = 20
[[inclusion]]
region = { shape = "rectangle", width = 0.4, height = 2.0, centre = [-0.4, 0.0] }
material = { kind = "isotropic", E = 4.0, nu = 0.2 }
thickness = 1.5
"""
HELD = '[[support]]\nkind = "edge"\nwhere = "x < -0.999"\ndisplacement = [0.0, 0.0]\n'
HEAT = """
[material]
kind = "conductivity"
tensor = [[2.0, 0.5], [0.5, 1.0]]
[[inclusion]]
region = { shape = "rectangle", width = 0.4, height = 2.0, centre = [-0.4, 0.0] }
material = { kind = "conductivity", tensor = [[0.3, 0.0], [0.0, 0.3]] }
[[support]]
kind = "edge"
where = "x < -0.999"
temperature = "y"
[[load]]
kind = "source"
value = 3.0
where = "x > 0.72"
[[load]]
kind = "flux"
value = [-2.0, 0.0]
where = "x > 0.999"
"""
LOADS = {
    "stress": 'kind = "stress"\nvalue = [1.0, 0.0, 0.3]\nwhere = "x > 0.999"\n',
    "traction": 'kind = "traction"\nvalue = [0.0, -1.0]\nstart = [1.0, -0.5]\nend = [1.0, 0.5]\n',
    "weight": 'kind = "body_force"\nvalue = [0.0, "-1 - x"]\n',
    "line": 'kind = "line"\nvalue = [1.0, 0.0]\nstart = [0.8, -0.3]\nend = [0.8, 0.3]\n',
    "warm": 'kind = "temperature"\nvalue = "1 + x"\nexpansion = [[1e-2, 0.0], [0.0, 2e-2]]\n',
}


def compared(folder, text):
    path = folder / "scene.toml"
    path.write_text(text, encoding="utf-8")
    request = scene_file.request(path)
    result = request.run()
    return comparison.compare(request, result)


#: Displacement and stress, relative L2, beside a hole of five cells across; both halve at half the
#: spacing, but for the stresses beside lines of forces and at the corners of inclusions.
MEASURED = {
    "stress": (0.0147, 0.0926),
    "traction": (0.0145, 0.0967),
    "weight": (0.0131, 0.1113),
    "line": (0.0206, 0.1356),
    "warm": (0.0066, 0.2450),
}


@pytest.mark.parametrize("load", LOADS)
def test_lattice_and_finite_elements_agree(tmp_path, load):
    solid = SOLID if load != "warm" else SOLID + "expansion = [[2e-2, 0.0], [0.0, 1e-2]]\n"
    found = compared(tmp_path, f"{BODY}{solid}{HELD}[[load]]\n{LOADS[load]}")
    displacement, stress = found.differences
    assert (displacement.l2, stress.l2) == pytest.approx(MEASURED[load], rel=0.3)
    assert displacement.own < 0.5 * displacement.l2


def test_what_both_have_exactly_is_the_same(tmp_path):
    """A flux through a rectangle: linear in x."""
    text = f"""{BODY.split("[[region]]")[0].replace("0.08", "0.1")}
[region]
shape = "rectangle"
width = 2.0
height = 1.0
[material]
kind = "conductivity"
tensor = [[2.0, 0.0], [0.0, 1.0]]
[[support]]
kind = "edge"
where = "x < -0.999"
temperature = 1.0
[[load]]
kind = "flux"
value = [-2.0, 0.0]
where = "x > 0.999"
"""
    for one in compared(tmp_path, text).differences:
        assert max(one.l2, one.largest, one.own) < 1e-9, one


def test_what_vanishes_is_noted(tmp_path):
    """No flux, but a temperature: there is no share of nothing."""
    text = f"""{BODY.split("[[region]]")[0].replace("0.08", "0.25")}
[region]
shape = "rectangle"
width = 2.0
height = 1.0
[material]
kind = "conductivity"
tensor = [[2.0, 0.0], [0.0, 1.0]]
[[support]]
kind = "edge"
where = "x < -0.999"
temperature = 0.0
"""
    found = compared(tmp_path, text)
    assert found.differences == []
    assert [note.split()[1] for note in found.notes] == ["temperature", "flux"]


def test_a_result_is_kept_where_finite_elements_refuse(tmp_path, monkeypatch):
    def refuse(*_):
        raise ValueError("no mesh")

    monkeypatch.setattr(comparison, "compare", refuse)
    path = tmp_path / "scene.toml"
    path.write_text(BODY.replace("0.08", "0.25") + HEAT, encoding="utf-8")
    found = CliRunner().invoke(app, ["solve", str(path)])
    assert found.exit_code == 2
    assert "no mesh; the scene's own result is in" in found.output
    assert (tmp_path / "scene.vtu").is_file()


def test_heat_in_two_solids(tmp_path):
    temperature, flux = compared(tmp_path, BODY + HEAT).differences
    # Less its mean; a third of it at half the spacing.
    assert temperature.l2 < 0.09, temperature
    assert flux.l2 < 0.15, flux


def test_a_layer_and_a_crack(tmp_path):
    text = f"""{BODY.replace('"extrapolated"', '"volume"')}{SOLID.split("[[inc")[0]}
[[support]]
where = "x < -0.75"
displacement = [0.0, 0.0]
rotation = 0.0
[[load]]
kind = "stress"
value = [1.0, 0.0, 0.0]
where = "x > 0.999"
[[crack]]
points = [[-0.3, 0.6], [-0.3, 0.3], [-0.2, 0.1]]
"""
    found = compared(tmp_path, text)
    # Twelve cells across, surfaces by the volume method; 3 % at half the spacing.
    assert found.differences[0].l2 < 0.12, found.differences[0]
    assert "rotations are left out" in found.notes[0]


@pytest.mark.parametrize(
    ("old", "new"),
    [("E1 = 2.0", "E1 = 3.0"), ("[1.0, 0.0, 0.3]", "[1.3, 0.0, 0.3]"),
     ("thickness = 1.5", "thickness = 0.8"), ("angle_degrees = 20", "angle_degrees = -20")],
)  # fmt: skip
def test_a_body_that_is_another_one_is_seen(tmp_path, old, new):
    """Finite elements of the file as it is, a lattice of one that says something else."""
    text = f"{BODY}{SOLID}{HELD}[[load]]\n{LOADS['stress']}"
    assert old in text
    path = tmp_path / "scene.toml"
    path.write_text(text.replace(old, new), encoding="utf-8")
    wrong = scene_file.request(path).run()
    path.write_text(text, encoding="utf-8")
    found = comparison.compare(scene_file.request(path), wrong)
    assert found.differences[0].l2 > 3 * MEASURED["stress"][0]


HEAVY = '[[load]]\nkind = "body_force"\nvalue = [1.0, 0.0]\n'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[[support]]\nu1 = 0.0\n", r"support #2 holds no node"),
        (HEAVY, r"load #1 acts where the mesh has no point"),
    ],
)
def test_what_the_mesh_is_too_coarse_for_is_refused(tmp_path, text, message):
    """One particle is held, or pushed, and no node: finite elements would do without."""
    single = 'where = "hypot(x - 0.75, y + 0.25) < 1e-3"\n'
    with pytest.raises(SceneFileError, match=message):
        compared(tmp_path, BODY.replace("0.08", "0.1") + SOLID + HELD + text + single)


def test_particles_of_a_layer_are_held_whatever_their_rotation(tmp_path):
    """What is compared are free particles: nothing of a layer whose rotations are left free."""
    layer = "[[support]]\nlayer_cells = 3.1\n"
    bent = 'displacement = ["0.1 * x * y", "0"]\n'
    found = compared(tmp_path, BODY.split('[[region]]\nshape = "disc')[0] + SOLID + layer + bent)
    for one in found.differences:
        depth = min(1.0 - abs(one.at[0]), 0.5 - abs(one.at[1]))
        assert depth > 3.1 * 0.08, one


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (SOLID + HELD + "[fracture]\nG1 = 1.0\nstop = 1.0\n", r"\[fracture\] .*no \[fracture\]"),
        (SOLID + HELD + '[[load]]\nkind = "couple"\nvalue = 1.0\n', r"\[load #1\] .*body couples"),
        (SOLID + HELD + '[[support]]\nkind = "pin"\nwhere = "x > 0"\n', r"\[support #2\] .*'pin'"),
        (SOLID + HELD + '[[support]]\nwhere = "x > 0.9"\nrotation = 0\n', r"no rotations to hold"),
        (SOLID.split("[[inc")[0].replace("angle_degrees = 20", "bending = [[1, 0], [0, 1]]") + HELD,
         r"\[material\] .*no polar solids"),
        (SOLID.split("[[inc")[0].replace("angle_degrees = 20", "turn = [0.1, 0.1, 0.0]") + HELD,
         r"\[material\] .*no chiral solids"),
    ],
)  # fmt: skip
def test_what_finite_elements_cannot_mirror_is_refused_by_name(tmp_path, text, message):
    path = tmp_path / "scene.toml"
    path.write_text(
        BODY + text.replace("nu12 = 0.2", "nu12 = 0.2\ndensity = 1.0"), encoding="utf-8"
    )
    with pytest.raises(SceneFileError, match=rf"scene\.toml:\d+: .*{message}"):
        scene_file.request(path)


def test_the_command_prints_and_writes_it(tmp_path):
    text = (BODY + HEAT).replace('compare = "fem"', "").replace("0.08", "0.1")
    assert "compare" not in tomllib.loads(text)
    path = tmp_path / "scene.toml"
    path.write_text(text, encoding="utf-8")
    found = CliRunner().invoke(app, ["solve", str(path), "--compare", "fem"], terminal_width=120)
    assert found.exit_code == 0, found.output
    assert "finite elements' own" in found.output
    told = json.loads((tmp_path / "scene.fem.json").read_text(encoding="utf-8"))
    assert [one["quantity"] for one in told["differences"]] == ["temperature", "flux"]
    arrays = np.load(tmp_path / "scene.fem.npz")
    off = arrays["temperature"] - arrays["temperature_reference"]
    np.testing.assert_array_equal(arrays["temperature_difference"], off)
    again = CliRunner().invoke(app, ["solve", str(path), "--compare", "fem"])
    assert (again.exit_code, "scene.fem.json" in again.output) == (2, True)
