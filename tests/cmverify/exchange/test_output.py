"""What is written is what was asked for, under the name that was given, over nothing."""

import meshio
import numpy as np
import pytest
from typer.testing import CliRunner

from cmverify.cli import app
from cmverify.exchange import model, scene_file
from cmverify.exchange.output import Selected, along, existing
from cmverify.exchange.refusal import SceneFileError
from solver import recovery

PLATE = """
[discretisation]
spacing = 0.1
m = 2
[[region]]
shape = "rectangle"
width = 2.0
height = 1.0
[[region]]
shape = "disc"
radius = 0.2
operation = "subtract"
[material]
kind = "isotropic"
E = 1.0
nu = 0.2
density = 1.0
[[support]]
where = "x < -0.75"
displacement = [0.0, 0.0]
rotation = 0.0
[[load]]
kind = "stress"
value = [1.0, 0.0, 0.0]
where = "x > 0.9"
"""
OUTPUT = """
[output]
fields = ["displacement", "stress11"]
stress_rule = "family"
[[output.line]]
name = "axis"
start = [-1.0, 0.0]
end = [1.0, 0.0]
"""


def written(folder, text, name="scene.toml"):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def said(path, *options):
    found = CliRunner().invoke(app, ["solve", str(path), *options])
    assert found.exception is None or isinstance(found.exception, SystemExit)
    return found.exit_code, found.output


def test_a_temperature_that_strains_the_body_is_written_beside_the_stress(tmp_path):
    warm = '[[load]]\nkind = "temperature"\nvalue = "1 + x"\nexpansion = [[1e-2, 0], [0, 2e-2]]\n'
    path = written(tmp_path, PLATE + warm)
    code, text = said(path, "--out", str(tmp_path / "warm"))
    assert code == 0, text
    kept = np.load(tmp_path / "warm.npz")
    np.testing.assert_allclose(kept["temperature"], 1 + kept["points"][:, 0], atol=1e-12)
    assert "stress11" in kept
    mesh = meshio.read(tmp_path / "warm.vtu")
    assert "temperature" in mesh.point_data
    asked = warm + '[output]\nfields = ["temperature"]\n'
    found = scene_file.request(written(tmp_path, PLATE + asked, "asks.toml")).run()
    assert list(found.fields()) == ["temperature"]


def test_fields_stresses_and_lines_are_those_that_were_asked_for(tmp_path):
    found = scene_file.request(written(tmp_path, PLATE + OUTPUT)).run()
    solution = found.whole
    assert set(found.fields()) == {"displacement", "stress11"}
    by_rule = [recovery.stress(solution, rule)[:, 0, 0] for rule in ("family", "plane")]
    np.testing.assert_array_equal(found.fields()["stress11"], by_rule[0])
    assert np.abs(by_rule[0] - by_rule[1]).max() > 1e-3
    table = found.tables()["line-axis"]
    assert table.columns == ("s", "x", "y", "displacement1", "displacement2", "stress11")
    s, x, y = table.values.T[:3]
    # Rows beside the axis, and none in the hole.
    assert (np.abs(y) <= 0.05 + 1e-12).all()
    assert (np.abs(x) > 0.18).all()
    assert (np.diff(s) > 0).all()
    np.testing.assert_allclose(s, x + 1, atol=1e-12)
    at = [
        np.flatnonzero((solution.points == place).all(axis=1))[0] for place in table.values[:, 1:3]
    ]
    np.testing.assert_array_equal(table.values[:, 3], solution.displacement[at, 0])
    paths = found.write(tmp_path / "out_0.1")
    assert [p.name for p in paths] == ["out_0.1.vtu", "out_0.1.npz", "out_0.1.line-axis.csv"]
    assert set(np.load(paths[1])) == {"points", "format", "displacement", "stress11"}


def test_fields_that_an_analysis_does_not_write_are_told_of(tmp_path):
    text = PLATE + '[output]\nfields = ["velocity", "displacement"]\n'
    found = scene_file.request(written(tmp_path, text)).run()
    assert set(found.fields()) == {"displacement"}
    assert any("writes no velocity" in warning for warning in found.summary()["warnings"])


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"stress11"', '"stres11"', r"\[output\] fields: .*did you mean 'stress11'"),
        ('"family"', '"mean"', r"stress_rule = 'mean' is not one of"),
        ("end = [1.0, 0.0]", "end = [-1.0, 0.0]", r"line.end: .*ends elsewhere"),
        ("start = [-1.0, 0.0]\nend = [1.0, 0.0]", "start = [0.1, 0.0]\nend = [-0.1, 0.0]",
         r"\[output\] .*runs outside the body"),
        ('"axis"', '"../axis"', r"name of letters"),
    ],
)  # fmt: skip
def test_outputs_that_there_cannot_be_are_refused_before_any_work(tmp_path, old, new, message):
    assert old in OUTPUT
    path = written(tmp_path, PLATE + OUTPUT.replace(old, new))
    with pytest.raises(SceneFileError, match=message):
        scene_file.request(path)


@pytest.mark.parametrize("table", ["[modes]\ncount = 2", "[waves]\nend = 1.0"])
def test_a_stress_rule_needs_a_stress(tmp_path, table):
    path = written(tmp_path, f"{PLATE}[output]\nstress_rule = 'plane'\n{table}\n")
    with pytest.raises(SceneFileError, match=r"\[output\] stress_rule: \w+ writes no stress"):
        scene_file.request(path)


def test_probes_of_a_motion_are_a_table(tmp_path):
    text = f"{PLATE}[waves]\nend = 0.05\nprobes = [[0.55, 0.05], [0.95, 0.05]]\n"
    found = scene_file.request(written(tmp_path, text)).run()
    assert found.tables()["probes"].columns == ("time", "u1_0", "u1_1", "u2_0", "u2_1")


def test_nothing_interpolates_across_a_gap():
    """Values on two sides of a gap come from either side."""
    points = np.stack([np.array([-0.3, -0.2, -0.1, 0.1, 0.2, 0.3]), np.zeros(6)], axis=1)
    line = model.Line(name="a", start=[-0.3, 0.0], end=[0.3, 0.0], count=601)
    table = along(points, {"side": np.sign(points[:, 0])}, line, 0.1)
    assert table.values[:, 3].tolist() == [-1, -1, -1, 1, 1, 1]


# ---- names and files --------------------------------------------------------------------


def test_names_are_taken_whole(tmp_path):
    """Names with dots, of scenes and of outputs: each has files of its own."""
    for name in ("run_h0.1.toml", "run_h0.05.toml"):
        code, output = said(written(tmp_path, PLATE, name))
        assert code == 0, output
    code, output = said(tmp_path / "run_h0.1.toml", "--out", str(tmp_path / "h_0.02"))
    assert code == 0, output
    names = {path.name for path in tmp_path.iterdir() if path.suffix != ".toml"}
    assert names == {
        f"{stem}.{end}" for stem in ("run_h0.1", "run_h0.05", "h_0.02") for end in ("vtu", "npz")
    }


def test_nothing_is_overwritten_unasked(tmp_path):
    path = written(tmp_path, PLATE)
    (tmp_path / "scene.npz").write_text("precious")
    (tmp_path / "scene.line-axis.csv").write_text("precious")
    code, output = said(path)
    assert code == 2
    assert "scene.npz, scene.line-axis.csv" in output
    assert "--overwrite" in output
    assert (tmp_path / "scene.npz").read_text() == "precious"
    code, output = said(path, "--overwrite")
    assert code == 0, output
    assert "displacement" in np.load(tmp_path / "scene.npz")
    assert existing(tmp_path / "other") == []


def test_what_fails_leaves_nothing_behind(tmp_path):
    path = written(tmp_path, PLATE.replace("[[support]]", "[[support]]\n#"))
    (tmp_path / "file").touch()
    for out in (tmp_path / "file" / "below", tmp_path):
        code, output = said(path, "--out", str(out))
        assert code == 2, output
        assert len(output.strip().splitlines()) == 1
    held = PLATE.replace("x < -0.75", "x < -0.75) * (x > 9")
    code, _ = said(written(tmp_path, held.replace('"x', '"(x').replace('9"', '9)"'), "b.toml"))
    assert code == 2
    assert {p.name for p in tmp_path.iterdir()} == {"scene.toml", "b.toml", "file"}


def test_every_analysis_that_says_it_has_a_stress_has_one():
    """And none but those: their results are asked for it when files are written."""
    from solver.analyses import analyses
    from solver.result import Result

    with_stress = {name for name, one in analyses().items() if one.stressed}
    assert with_stress >= {"solve", "fracture", "sensing", "joule", "piezoresistive"}

    def last(one: type) -> list[type]:
        """Classes that results are of: nothing is derived from them."""
        return [c for d in one.__subclasses__() for c in last(d)] or [one]

    classes = {
        one.__name__: one.stressed is not Result.stressed
        for one in last(Result)
        if one is not Selected
    }
    assert sum(classes.values()) == len(with_stress), classes
