"""A grid's points are scene files with changes, and a wrong one is refused before any work."""

from pathlib import Path

import pytest

from cmverify.exchange.refusal import SceneFileError
from cmverify.sweep import grid

SCENE = """
[discretisation]
spacing = 0.25
m = 2
[region]
shape = "rectangle"
width = 1.0
height = 1.0
[material]
kind = "isotropic"
E = 1.0
nu = 0.2
[[support]]
layer_cells = 1
displacement = ["x", "0*y"]
[[load]]
kind = "body_force"
value = [0.0, 1.0]
"""


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "plate.toml"
    path.write_text(SCENE)
    return path


def test_the_points_of_a_file_run_with_the_last_setting_fastest(scene):
    path = scene.with_name("sweep.toml")
    path.write_text(
        'scene = "plate.toml"\n[grid]\nm = [2, 3]\n"load.0.value" = [[1.0, 0.0], [0.0, 2.0]]\n'
        "[grid.material]\n"
        'soft = { kind = "isotropic", E = 0.5, nu = 0.1 }\n'
        'wood = { kind = "orthotropic", E1 = 2.0, E2 = 1.0, G12 = 0.5, nu12 = 0.3 }\n'
    )
    points = grid.read(path)
    assert len(points) == 8
    assert [p.labels["m"] for p in points] == [2] * 4 + [3] * 4
    assert [p.labels["material"] for p in points] == ["soft", "wood"] * 4
    data = points[3].source().data
    assert data["load"][0]["value"] == [0.0, 2.0]
    assert data["material"]["E1"] == 2.0
    assert len({p.key for p in points}) == 8
    assert [p.key for p in grid.read(path)] == [p.key for p in points]


def test_a_drawing_that_has_changed_is_another_point(scene):
    drawing = scene.with_name("plate.dxf")
    grids = {"region": {"drawn": {"shape": "file", "path": drawing.name}}}
    keys = set()
    for text in (None, "one", "another"):
        if text is not None:
            drawing.write_text(text)
        keys.add(grid.points(scene, grids)[0].key)
    assert len(keys) == 3


def test_points_share_no_checkpoint(scene):
    run = {"increment": 0.1, "stop": 1.0, "G1": 1.0, "checkpoint": "state.npz"}
    with pytest.raises(SceneFileError, match="would share a checkpoint"):
        grid.points(scene, {"fracture": {"run": run}})
    wave = {"end": 1.0, "series": "frames"}
    with pytest.raises(SceneFileError, match="would share a series"):
        grid.points(scene, {"waves": {"run": wave}})


def test_what_is_changed_in_a_material_comes_after_the_material(scene):
    wood = {"kind": "orthotropic", "E1": 2.0, "E2": 1.0, "G12": 0.5, "nu12": 0.3}
    points = grid.points(scene, {"angle": [0, 30], "material": {"wood": wood}})
    assert [p.source().data["material"]["angle_degrees"] for p in points] == [0, 30]
    assert wood.get("angle_degrees") is None


def test_another_scene_or_setting_is_another_point(scene):
    first = grid.points(scene, {"m": [2]})[0].key
    assert grid.points(scene, {"m": [3]})[0].key != first
    scene.write_text(SCENE.replace("nu = 0.2", "nu = 0.25"))
    assert grid.points(scene, {"m": [2]})[0].key != first


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('scene = "plate.toml"\n[grid]\nm = 3\n', r"sweep.toml:3: \[grid\] m: a list of values"),
        ('scene = "plate.toml"\n[grid]\nm = []\n', "the list is empty"),
        ('scene = "plate.toml"\n[grid]\nm = [2, 2]\n', "twice"),
        ('scene = "plate.toml"\n', r"needs a \[grid\]"),
        ("[grid]\nm = [2]\n", "name the scene"),
        ('scene = "gone.toml"\n[grid]\nm = [2]\n', "gone.toml cannot be read"),
        ('scene = "plate.toml"\nsteps = 3\n[grid]\nm = [2]\n', "no 'steps'"),
        ('scene = "plate.toml"\n[grid]\n"load.3.value" = [1]\n', "no '3' there"),
        ('scene = "plate.toml"\n[grid]\nsurface = ["rough"]\n', "surface"),
        ('scene = "plate.toml"\n[grid]\n"discretisation.space" = [1]\n', "space"),
    ],
)
def test_bad_sweeps_are_refused_in_a_line(scene, text, said):
    path = scene.with_name("sweep.toml")
    path.write_text(text)
    with pytest.raises(SceneFileError, match=said) as refusal:
        grid.read(path)
    assert "\n" not in str(refusal.value)


def test_the_example_is_a_sweep():
    points = grid.read(Path(__file__).parents[3] / "examples" / "sweep" / "disc.toml")
    assert {p.labels["calibration"] for p in points} == {"continuum", "positive"}
