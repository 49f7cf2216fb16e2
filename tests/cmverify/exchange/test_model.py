"""The declaration of scene files: a JSON schema, and what its tables stand for."""

import json
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import solver
from cmverify.exchange import scene_file
from cmverify.exchange.analysis_table import scene_model
from cmverify.exchange.model import SceneFile
from cmverify.exchange.refusal import SceneFileError

EXAMPLES = Path(__file__).parents[3] / "examples"


def test_the_schema_knows_every_table_and_key():
    schema = SceneFile.model_json_schema()
    json.dumps(schema)
    assert set(schema["properties"]) >= {"discretisation", "region", "material", "support"}
    tables = schema["$defs"]
    assert tables["Disc"]["properties"]["radius"]["exclusiveMinimum"] == 0
    assert tables["Support"]["additionalProperties"] is False
    assert tables["Discretisation"]["required"] == ["spacing"]
    assert {"type": "string", "format": "condition"} in tables["Source"]["properties"]["where"][
        "anyOf"
    ]


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda p: p.name)
def test_examples_are_of_the_model(path):
    assert scene_model().model_validate(tomllib.loads(path.read_text(encoding="utf-8")))


# ---- tables give what the same words give in Python -------------------------------------

SQUARE = """
[discretisation]
spacing = 0.125
m = 2
surface = "extrapolated"
[region]
shape = "rectangle"
width = 1.0
height = 1.0
"""
SOLID = """
[material]
kind = "elastic"
voigt = [[2.0, 0.4, 0.1], [0.4, 1.5, 0.0], [0.1, 0.0, 0.6]]
"""
METAL = """
[material]
kind = "electric"
resistivities = [1.0, 2.0]
"""
HELD = '[[support]]\nwhere = "x < -0.3"\ndisplacement = [0, 0]\nrotation = 0\n'


def left(x, y):
    return x < -0.3


def right(x, y):
    return x > 0.3


PAIRS = {
    "edge": (
        SOLID + '[[support]]\nkind = "edge"\nwhere = "x < -0.49"\ndisplacement = [0.0, "0.1*y"]\n',
        [solver.Support.edge(lambda x, y: x < -0.49,
                             displacement=lambda x, y: np.stack([0 * x, 0.1 * y], axis=-1))],
        [],
    ),
    "pin": (
        SOLID
        + HELD
        + '[[support]]\nkind = "pin"\nwhere = "x > 0.3"\nu1 = 0.2\ncentre = [0.4, 0]\n',
        [solver.Support.where(left, displacement=0.0, rotation=0.0),
         solver.Support.pin(right, (0.4, 0.0), u1=0.2)],
        [],
    ),
    "equal": (
        SOLID + HELD + '[[support]]\nkind = "equal"\nwhere = "x > 0.3"\nunknowns = ["u1"]\n'
        '[[load]]\nkind = "line"\nvalue = ["y", 1.0]\nstart = [0.5, -0.5]\nend = [0.5, 0.5]\n',
        [solver.Support.where(left, displacement=0.0, rotation=0.0),
         solver.Support.equal(right, "u1")],
        [solver.Load.line(lambda x, y: np.stack([y, 1 + 0 * y], axis=-1), (0.5, -0.5), (0.5, 0.5))],
    ),
    "point": (
        SOLID + HELD + '[[load]]\nkind = "point"\nvalue = [0.1, -0.2]\nat = [0.5, 0.0]\n',
        [solver.Support.where(left, displacement=0.0, rotation=0.0)],
        [solver.Load.point((0.1, -0.2), (0.5, 0.0))],
    ),
    "lead": (
        METAL + '[[support]]\nwhere = "x < -0.3"\npotential = 0\n'
        '[[support]]\nkind = "lead"\nwhere = "x > 0.3"\n'
        '[[load]]\nkind = "lead"\nwhere = "x > 0.3"\nvalue = 2.0\n'
        '[[load]]\nkind = "point"\nvalue = 0.5\nat = [0.0, 0.5]\n',
        [solver.Support.where(left, potential=0.0), solver.Support.lead(right)],
        [solver.Load.lead(2.0, right), solver.Load.point(0.5, (0.0, 0.5))],
    ),
    "lead of a shape": (
        METAL + '[[support]]\nregion = { shape = "rectangle", width = 0.4, height = 2.0, '
        "centre = [-0.5, 0.0] }\npotential = 0\n"
        '[[support]]\nkind = "lead"\nregion = { shape = "disc", radius = 0.2 }\n'
        '[[load]]\nkind = "lead"\nregion = { shape = "disc", radius = 0.2 }\nvalue = 2.0\n',
        [solver.Support.where(left, potential=0.0), solver.Support.lead(solver.disc(0.2))],
        [solver.Load.lead(2.0, solver.disc(0.2))],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", PAIRS)
def test_supports_and_loads_are_those_of_the_solver(tmp_path, name):
    text, supports, loads = PAIRS[name]
    path = tmp_path / "scene.toml"
    path.write_text(SQUARE + text)
    scene, _ = scene_file.read(path)
    other = replace(scene, supports=supports, loads=loads)
    np.testing.assert_array_equal(scene.solve().unknowns, other.solve().unknowns)


MATERIALS = {
    "kind = 'elastic'\ncompliance = [[0.5, -0.1, 0], [-0.1, 0.4, 0], [0, 0, 2.0]]\n"
    "angle_degrees = 30": lambda: solver.ElasticTensor(
        np.linalg.inv([[0.5, -0.1, 0], [-0.1, 0.4, 0], [0, 0, 2.0]])
    ).rotated(np.pi / 6),
    "kind = 'orthotropic'\nE1 = 2.0\nE2 = 2.5\nG12 = 0.5\nnu12 = 0.2": lambda: (
        solver.ElasticTensor.of_compliance([[0.5, -0.1, 0], [-0.1, 0.4, 0], [0, 0, 2.0]])
    ),
    "kind = 'isotropic'\nE = 2.0\nnu = 0.25\nplane = 'strain'": lambda: (
        # E/(1 − ν²) and ν/(1 − ν) of plane stress.
        solver.ElasticTensor.isotropic(2.0 / 0.9375, 1 / 3)
    ),
    "kind = 'conductivity'\nprincipal = [3.0, 1.0]\nangle_degrees = 90": lambda: (
        solver.ConductivityTensor([[1.0, 0.0], [0.0, 3.0]])
    ),
}


@pytest.mark.parametrize("text", MATERIALS, ids=lambda text: text.splitlines()[1])
def test_materials_in_every_form(tmp_path, text):
    path = tmp_path / "scene.toml"
    held = "temperature = 0" if "conductivity" in text else "displacement = [0, 0]"
    path.write_text(f"{SQUARE}[material]\n{text}\n[[support]]\nlayer_cells = 1.5\n{held}\n")
    found, wanted = scene_file.read(path)[0].material, MATERIALS[text]()
    matrix = "matrix" if "conductivity" in text else "voigt"
    np.testing.assert_allclose(getattr(found, matrix), getattr(wanted, matrix), atol=1e-14)


def test_a_rectangle_is_turned_about_its_centre(tmp_path):
    path = tmp_path / "scene.toml"
    turned = "height = 1.0\ncentre = [3.0, 1.0]\nangle_degrees = 45\n"
    path.write_text(SQUARE.replace("height = 1.0\n", turned) + SOLID + HELD.replace("-0.3", "3.0"))
    half = np.sqrt(0.5)
    wanted = (3 - half, 1 - half, 3 + half, 1 + half)
    assert scene_file.read(path)[0].region.bounds == pytest.approx(wanted)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('kind = "pin"\nlayer_cells = 2\n', "layer_cells says nothing of"),
        ('kind = "pin"\n', "'where' is missing"),
        ('where = "x > 0"\nregion = { shape = "disc", radius = 1 }\nu1 = 0\n', "not both"),
        ('region = { shape = "disk", radius = 1 }\nu1 = 0\n', "disc"),
        ('kind = "edge"\n', "prescribes nothing"),
        ('kind = "equal"\nwhere = "x > 0"\n', "say which unknowns"),
        ('kind = "equal"\nwhere = "x > 0"\nunknowns = ["u3"]\n', "u3.* is not one of u1"),
        ('kind = "equal"\nwhere = "x > 0"\nunknowns = ["u1"]\nu1 = 0\n', "no value of its own"),
        ('kind = "lead"\nwhere = "x > 0"\nu1 = 0\n', "has a potential and nothing else"),
        ('where = "x > 0"\nu1 = 0\ncentre = [0, 0]\n', "centre belongs to kind = 'pin'"),
        ('kind = "pin"\nwhere = "x > 0"\npotential = 0\n', "potential"),
    ],
)
def test_supports_that_make_no_sense(tmp_path, text, message):
    path = tmp_path / "scene.toml"
    path.write_text(f"{SQUARE}{SOLID}[[support]]\n{text}")
    with pytest.raises(SceneFileError, match=rf"scene\.toml:\d+: \[support #1\] .*{message}"):
        scene_file.request(path)
