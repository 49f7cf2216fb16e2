"""Scene files: solved as written, refused with the line that is wrong."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from cmverify.cli import app
from cmverify.exchange import output, scene_file
from cmverify.exchange.expressions import Formula
from cmverify.exchange.scene_file import SceneFileError

EXAMPLES = Path(__file__).parents[3] / "examples"

SMALL = """\
[discretisation]
spacing = 0.1
m = 3

[region]
shape = "disc"
radius = 1.0

[material]
kind = "conductivity"
tensor = [[5, 2], [2, 1]]

[[support]]
layer_cells = 3.5
temperature = "x**2 - 5*y**2"
"""


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "scene.toml"
    path.write_text(text)
    return path


def test_a_scene_is_solved_as_written(tmp_path):
    # x^2 - 5 y^2 is harmonic in diag(5, 1), exactly reproduced by the lattice calibration
    text = SMALL.replace("[[5, 2], [2, 1]]", "[[5, 0], [0, 1]]")
    scene, options = scene_file.read(written(tmp_path, text))
    assert options == {}
    solution = scene.solve(tolerance=1e-13)
    x, y = solution.points.T
    np.testing.assert_allclose(solution.temperature, x**2 - 5 * y**2, atol=1e-11)
    fields = solution.fields()
    assert set(fields) == {"prescribed", "temperature", "flux"}


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda p: p.name)
def test_examples_can_be_read(path):
    scene, _ = scene_file.read(path)
    assert scene.supports or scene.density  # what vibrates may be free


@pytest.mark.parametrize(
    "name",
    ["bracket", "cantilever",
     "cooling", "fuse", "heated_strip", "polar", "pulse", "quenched_plate", "shaken",
     "strain_gauge", "watched_crack",
     *(pytest.param(name, marks=pytest.mark.slow) for name in ("composite", "disc", "modes"))],
)  # fmt: skip
def test_examples_run(tmp_path, name):
    """What no other test here solves."""
    found = scene_file.request(EXAMPLES / f"{name}.toml").run()
    assert all(np.isfinite(values).any() for values in found.fields().values())
    output.check_fields(list(found.fields()))
    assert all(path.is_file() for path in found.write(tmp_path / name))


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
    [
        ("spacing = 0.1", "spacin = 0.1", 2, "did you mean 'spacing'"),
        ("radius = 1.0", "raduis = 1.0", 7, "did you mean 'radius'"),
        ('shape = "disc"', 'shape = "disk"', 6, "is not one of disc"),
        ('"x**2 - 5*y**2"', '"x**2 - 5*z**2"', 15, "unknown name 'z'"),
        ('"x**2 - 5*y**2"', '"x**2 -"', 15, "not a formula"),
        ("layer_cells = 3.5", "layer_cels = 3.5", 14, "did you mean 'layer_cells'"),
        ("layer_cells = 3.5\n", "", 13, "either layer_cells, where or region"),
        ("tensor = [[5, 2], [2, 1]]", "", 9, "needs either tensor or principal"),
        ("m = 3", 'law = "cosin"', 3, "is not one of cosine"),
        ("m = 3", "exponent = 4", 3, 'law = "cosine"'),
        ("[[support]]", "[[suport]]", 13, "did you mean 'support'"),
    ],
)
def test_a_wrong_key_is_named_with_its_line(tmp_path, old, new, line, message):
    assert old in SMALL
    with pytest.raises(SceneFileError) as caught:
        scene_file.read(written(tmp_path, SMALL.replace(old, new)))
    assert message in str(caught.value)
    assert f"scene.toml:{line}:" in str(caught.value)


def test_the_second_of_two_tables_is_named_by_its_own_line(tmp_path):
    text = SMALL + '\n[[support]]\nlayer_cells = 1\ntemperatur = "x"\n'
    with pytest.raises(SceneFileError, match=r"scene\.toml:19: \[support #2\].*'temperature'"):
        scene_file.read(written(tmp_path, text))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[discretisation\n", r"scene\.toml:\d+: is not TOML"),
        ("[discretisation]\nspacing = 0.1\n", r"\[region\] is missing"),
        (SMALL.replace("[[5, 2], [2, 1]]", "[[1, 2], [2, 1]]"), "positive"),
    ],
)
def test_what_cannot_be_a_scene_is_refused(tmp_path, text, message):
    with pytest.raises(SceneFileError, match=message):
        scene_file.read(written(tmp_path, text))


def test_wherever_a_text_breaks_off_its_line_is_named(tmp_path):
    refused = 0
    for end in range(len(SMALL)):
        text = SMALL[:end]
        path = written(tmp_path, text)
        try:
            tomllib.loads(text)
        except tomllib.TOMLDecodeError:
            line = max(1, len(text.splitlines()))
            with pytest.raises(SceneFileError, match=rf"scene\.toml:{line}: is not TOML"):
                scene_file.source_of(path)
            refused += 1
    assert refused > len(SMALL) // 2


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(SceneFileError, match="cannot be read"):
        scene_file.read(tmp_path / "none.toml")


def test_formulas_compute_what_they_say():
    x, y = np.array([0.5, 2.0]), np.array([1.0, -1.0])
    np.testing.assert_allclose(Formula("exp(x - 2*y)*cos(y)")(x, y), np.exp(x - 2 * y) * np.cos(y))
    np.testing.assert_allclose(Formula("-x**2 + pi")(x, y), np.pi - x**2)
    np.testing.assert_allclose(Formula("3")(x, y), [3.0, 3.0])
    assert Formula("x < 1")(x, y).dtype == bool
    assert Formula("where(x < 1, x, y)")(x, y).tolist() == [0.5, -1.0]


@pytest.mark.parametrize(
    "text",
    ["__import__('os')", "x.real", "(lambda: 1)()", "[x]", "'x'", "x if y else 1", "open(x)"],
)
def test_formulas_run_no_code(text):
    with pytest.raises(ValueError, match=r"unknown name|not allowed"):
        Formula(text)


def test_a_fracture_table_is_run_and_written(tmp_path):
    text = (EXAMPLES / "double_cantilever.toml").read_text()
    text = text.replace("spacing = 0.05", "spacing = 0.1").replace("advance = 0.5", "advance = 0.3")
    path = written(tmp_path, text)
    result = CliRunner().invoke(app, ["solve", str(path)])
    assert result.exit_code == 0, result.output
    assert "bonds broken" in result.output
    history = np.genfromtxt(tmp_path / "scene.history.csv", delimiter=",", names=True)
    assert history["advance"][-1] >= 0.3
    balance = history["work"] - history["stored"] - history["dissipated"] - history["excess"]
    assert np.abs(balance).max() < 1e-6 * history["work"].max()
    track = np.loadtxt(tmp_path / "scene.path.csv", delimiter=",", skiprows=1)
    # The body is symmetric: the crack runs straight on from its tip.
    np.testing.assert_allclose(track[0], [-1.0, 0.0])
    np.testing.assert_allclose(track[:, 1], 0.0, atol=1e-9)
    assert np.load(tmp_path / "scene.npz")["damage"].max() > 0.2


def test_scenes_without_the_table_of_an_analysis_are_solved(tmp_path):
    found = scene_file.request(written(tmp_path, SMALL))
    assert found.analysis == "solve"


@pytest.mark.parametrize(
    ("table", "line", "message"),
    [
        ("G = 1.0", 2, "did you mean 'G"),
        ("control = 'fixed'", 1, "'G1' is missing"),
        ("G1 = -1.0", 2, "G1: must be positive"),
        ("G1 = 1.0\nstart = 3.0\nstop = 2.0", 4, "stops at"),
        ("G1 = 1.0\nno_fail = 'q > 1'", 3, "q"),
    ],
)
def test_fracture_tables_that_make_no_sense(tmp_path, table, line, message):
    path = written(tmp_path, f"{SMALL}\n[fracture]\n{table}\n")
    at = SMALL.count("\n") + 1 + line
    with pytest.raises(SceneFileError, match=rf"scene\.toml:{at}: \[fracture\] .*{message}"):
        scene_file.request(path)


PLATE = """
[discretisation]
spacing = 0.1
m = 3
[region]
shape = "rectangle"
width = 1.0
height = 1.0
"""


def test_polar_solids(tmp_path):
    polar = (
        PLATE
        + """
    [material]
    kind = "isotropic"
    E = 1.0
    nu = 0.2
    bending = [[0.1, 0.0], [0.0, 0.1]]
    [[support]]
    layer_cells = 2.5
    displacement = [0, 0]
    rotation = "x"
    """
    )
    (tmp_path / "polar.toml").write_text(polar)
    found = scene_file.request(tmp_path / "polar.toml").run()
    written = found.write(tmp_path / "polar")
    assert found.fields()["couple_stress"].shape == (found.statistics.particles, 2)
    assert written[0].exists()
    (tmp_path / "polar.toml").write_text(polar.replace("nu = 0.2", "nu = 0.4"))
    with pytest.raises(SceneFileError, match="needs C66 > C12"):
        scene_file.request(tmp_path / "polar.toml")


def test_chiral_solids(tmp_path):
    chiral = (
        PLATE
        + """
    [material]
    kind = "isotropic"
    E = 1.0
    nu = 0.2
    turn = [0.3, 0.3, 0.0]
    [[support]]
    layer_cells = 3.5
    displacement = ["0.1*x", "0.1*y"]
    rotation = 0.06
    """
    )
    (tmp_path / "chiral.toml").write_text(chiral)
    found = scene_file.request(tmp_path / "chiral.toml").run()
    np.testing.assert_allclose(found.rotation, 0.06, atol=1e-10)
    grow = chiral + "[fracture]\nG1 = 1.0\nstop = 1.0\n"
    bent = chiral.replace("turn", "bending = [[0.1, 0.0], [0.0, 0.1]]\n    turn")
    two = chiral + (
        '[[inclusion]]\n[[inclusion.region]]\nshape = "disc"\nradius = 0.2\n'
        '[inclusion.material]\nkind = "isotropic"\nE = 2.0\nnu = 0.2\n'
    )
    shaken = chiral.replace("turn", "density = 1.0\n    turn") + (
        '[waves]\ninitial = [0, 0]\nend = 1.0\nrotations = "inertia"\n'
    )
    for text, says in (
        (grow, "do not break yet"),
        (bent, "cannot be chiral yet"),
        (two, "no inclusions yet"),
        (shaken, "leave them massless"),
    ):
        (tmp_path / "chiral.toml").write_text(text)
        with pytest.raises(SceneFileError, match=says):
            scene_file.request(tmp_path / "chiral.toml").run()


def test_conductors_of_current_and_temperatures(tmp_path):
    live = (
        PLATE
        + """
    [material]
    kind = "electric"
    resistivities = [170, 540]
    angle_degrees = 20
    [[support]]
    where = "x < -0.3"
    potential = 0
    [[load]]
    kind = "lead"
    where = "x > 0.3"
    value = 2.0
    """
    )
    hot = (
        PLATE
        + """
    [material]
    kind = "isotropic"
    E = 1.0
    nu = 0.2
    [[support]]
    layer_cells = 2.5
    displacement = [0, 0]
    [[load]]
    kind = "temperature"
    value = "3*x"
    expansion = [[1e-3, 0], [0, 2e-3]]
    """
    )
    (tmp_path / "live.toml").write_text(live)
    (tmp_path / "hot.toml").write_text(hot)
    assert scene_file.request(tmp_path / "live.toml").run().fields()["potential"].max() > 0
    assert scene_file.request(tmp_path / "hot.toml").run().fields()["stress22"].std() > 1e-4
    bimetal = (
        hot
        + """
    [[inclusion]]
    region = {shape = "rectangle", width = 1.0, height = 0.5, centre = [0.0, 0.25]}
    material = {kind = "isotropic", E = 3.0, nu = 0.2}
    expansion = [[2e-3, 0], [0, 1e-3]]
    """
    )
    (tmp_path / "bimetal.toml").write_text(bimetal)
    assert scene_file.request(tmp_path / "bimetal.toml").run().fields()["stress22"].std() > 1e-4
    (tmp_path / "bimetal.toml").write_text(bimetal.replace("expansion = [[2e-3", "#"))
    with pytest.raises(SceneFileError, match="an inclusion needs its expansion"):
        scene_file.request(tmp_path / "bimetal.toml")
    (tmp_path / "both.toml").write_text(live.replace("potential", "temperature"))
    with pytest.raises(SceneFileError, match="no temperature to prescribe"):
        scene_file.request(tmp_path / "both.toml")


IN_TIME = (
    PLATE.replace("0.1", "0.125")
    + """
[material]
kind = "isotropic"
E = 1.0
nu = 0.2
density = 1.0
[[support]]
where = "y < -0.3"
displacement = ["0.01*sin(3*t)*(1 + x)", 0.0]
rotation = 0.0
[[load]]
kind = "traction"
value = [0.0, "1e-3*t*x"]
start = [-0.5, 0.5]
end = [0.5, 0.5]
"""
)


def test_formulas_in_time_do_what_functions_do(tmp_path):
    from solver import ElasticTensor, Load, Scene, Support, rectangle, waves

    path = written(tmp_path, IN_TIME + "[waves]\nend = 1.0\n")
    told: list[float] = []
    found = scene_file.request(path).run(told.append)
    assert told == sorted(told)
    assert told[-1] == 1.0

    def shake(x, y, t):
        return np.stack([0.01 * np.sin(3 * t) * (1 + x), 0.0 * y], axis=-1)

    def pull(x, y, t):
        return np.stack([0.0 * x, 1e-3 * t * x], axis=-1)

    scene = Scene(
        rectangle(1.0, 1.0),
        0.125,
        ElasticTensor.isotropic(1.0, 0.2),
        [Support.where(lambda x, y: y < -0.3, displacement=shake, rotation=0.0)],
        [Load.traction(pull, (-0.5, 0.5), (0.5, 0.5))],
        m=3,
        density=1.0,
    )
    same = waves.run(scene, (0.0, 0.0), 1.0)
    np.testing.assert_allclose(found.displacement, same.displacement, rtol=1e-12, atol=1e-16)
    assert np.abs(found.displacement).max() > 1e-3


@pytest.mark.parametrize(
    ("old", "new", "end", "says"),
    [
        ("", "", "", r"toml:17: \[support #1\].*statics knows no time.*\[transient\] or \[waves\]"),
        ("", "", "[modes]\ncount = 2", r"toml:17: \[support #1\].*\[modes\] knows no time"),
        ("", "", "[waves]\nend = 1\nvelocity = ['t', 0]", r"toml:26: \[waves\].*time t: only"),
        ("y < -0.3", "y < t", "[waves]\nend = 1", r"toml:16: \[support #1\].*time t: only"),
        ("3*t)", "3/t)", "[waves]\nend = 1", r"toml:17: \[support #1\].*no finite real.*t = 0 s"),
        ("1e-3*t", "sqrt(0.4-t)", "[waves]\nend = 1", r"toml:21: \[load #1\].*t = 0\.5 s"),
    ],
)
def test_times_that_make_no_sense(tmp_path, old, new, end, says):
    with pytest.raises(SceneFileError, match=says):
        scene_file.request(written(tmp_path, IN_TIME.replace(old, new) + end + "\n")).run()


COMPOSITE = (EXAMPLES / "composite.toml").read_text()
LINE = "[[0.005, -0.02], [0.005, -0.014], [0.007, -0.011]]"
METAL = 'material = { kind = "conductivity", tensor = [[1, 0], [0, 1]] }'


def test_regions_inclusions_thickness_and_polylines(tmp_path):
    found = scene_file.request(EXAMPLES / "composite.toml")
    scene = found.scene
    assert scene.region.bounds == pytest.approx((-0.05, -0.02, 0.07, 0.02))
    inside = scene.region.contains(np.array([0.05, 0.065, 0.0]), np.array([0.0, 0.0, 0.0]))
    assert inside.tolist() == [False, True, True]
    assert [i.thickness for i in scene.inclusions] == [None, 2e-3]
    assert scene.inclusions[1].material is scene.material
    assert scene.thickness == 5e-3
    assert len(scene.cracks[0].segments) == 2
    solution = found.run()
    # Forces are those of a plate of that thickness; chords of the round end are a little shorter.
    from solver.reactions import reaction

    force = reaction(solution, lambda x, y: x < -0.047).force
    assert force[0] == pytest.approx(-1e6 * 5e-3 * 2 * np.sqrt(0.02**2 - 0.01**2), rel=4e-3)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('operation = "subtract"', 'operation = "sub"', "operation = 'sub' is not one of"),
        ("radius = 0.008", "radius = -1.0", "radius: must be positive"),
        ("E = 70.0e9", "E = -70.0e9", "inclusion #1] material.E: must be positive"),
        ("thickness = 2.0e-3", "", "give material or thickness"),
        ("thickness = 2.0e-3", "thickness = -1.0", "inclusion #2] thickness: must be positive"),
        ("thickness = 2.0e-3", METAL, "no inclusion of ConductivityTensor"),
        ("centre = [-0.02, 0.0]", "centre = [9.0, 0.0]", "inclusion 1 holds no particle"),
        ("thickness = 5.0e-3", "thickness = 0.0", "thickness must be positive"),
        ("thickness = 5.0e-3", 'thickness = "x"', "numbers of it and its inclusions"),
        (f"points = {LINE}", "points = [[0.0, 0.0]]", "two points or more"),
        (f"points = {LINE}", "start = [0.0, 0.0]", "needs start and end, or points"),
        (
            "[0.007, -0.011]]",
            "[0.007, -0.011]]\nstart = [0.0, 0.0]",
            "either start and end or points",
        ),
        (LINE, "[[0.0, 0.0], [0.0, 0.0]]", "ends elsewhere"),
    ],
)
def test_composites_that_make_no_sense(tmp_path, old, new, message):
    assert old in COMPOSITE
    with pytest.raises(SceneFileError, match=r"scene.toml:\d+: ") as caught:
        scene_file.request(written(tmp_path, COMPOSITE.replace(old, new, 1)))
    assert message in str(caught.value)


def test_the_first_shape_begins_the_region(tmp_path):
    text = SMALL.replace('shape = "disc"', 'shape = "disc"\noperation = "subtract"')
    with pytest.raises(SceneFileError, match="nothing to subtract from"):
        scene_file.read(written(tmp_path, text))


@pytest.mark.parametrize(
    ("table", "place"),
    [
        ("[modes]\ncount = 100000\n", r":20: \[modes\]"),
        ('[joule]\nplus = "x > 9"\nminus = "x < -0.8"\nsink = "x > 0.8"\nvoltage = 1\n'
         "resistivities = [1, 1]\nconductivities = [1, 1]\nexpansions = [0, 0]\n",
         r":20: \[joule\]"),
    ],
)  # fmt: skip
def test_what_an_analysis_says_is_about_its_table(tmp_path, table, place):
    text = """[discretisation]
spacing = 0.25
m = 2
surface = "volume"
[region]
shape = "rectangle"
width = 2.0
height = 1.0

[material]
kind = "isotropic"
E = 1.0
nu = 0.2
density = 1.0
[[support]]
where = "x < -0.5"
displacement = [0, 0]
rotation = 0

"""
    with pytest.raises(SceneFileError, match=place):
        scene_file.request(written(tmp_path, text + table)).run()
