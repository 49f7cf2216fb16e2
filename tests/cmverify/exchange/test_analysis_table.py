"""Every analysis has its table in scene files, and a file asks for one of them."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import pytest
from pydantic import ValidationError

from cmverify.exchange import scene_file
from cmverify.exchange.analysis_table import kind_of, scene_model, table_of
from cmverify.exchange.refusal import SceneFileError
from solver.analyses import Analysis, analyses
from solver.geometry import Region, Where
from solver.problem.values import Value

EXAMPLES = Path(__file__).parents[3] / "examples"

PLATE = """
[discretisation]
spacing = 0.1
m = 2

[region]
shape = "rectangle"
width = 1.0
height = 0.8

[material]
kind = "isotropic"
E = 1.0
nu = 0.2
density = 2.0
"""


def written(folder, text):
    path = folder / "scene.toml"
    path.write_text(text)
    return path


def test_every_analysis_has_a_table():
    assert set(analyses()) <= set(scene_model().model_fields)
    assert "modes" in scene_model().model_json_schema()["properties"]


def example(
    scene: object, count: int, size: float = 2.0, where: Where | None = None,
    value: Value | None = None, kind: Literal["a", "b"] = "a", times: Sequence[float] | None = None,
    quick: bool = False, file: str | None = None,
) -> None:  # fmt: skip
    """Keywords of every kind."""


def test_keywords_become_keys():
    table = table_of("example", "One.", Analysis("example", "One.", example).options)
    found = table.model_validate(
        {"count": 3, "where": "x < 1", "value": "2*y", "times": [0.0, 1.0], "file": "a"}
    )
    assert (found.count, found.size, found.kind, found.quick) == (3, 2.0, "a", False)
    x, y = np.array([0.5, 2.0]), np.array([1.0, 3.0])
    np.testing.assert_array_equal(found.where(x, y), [True, False])
    np.testing.assert_array_equal(found.value(x, y), 2 * y)
    for wrong in ({}, {"count": 0}, {"count": 1, "kind": "c"}, {"count": 1, "quick": 1}):
        with pytest.raises(ValidationError):
            table.model_validate(wrong)


def test_a_place_is_a_condition_or_shapes(tmp_path):
    text = PLATE + (
        '[joule]\nsink = "x > 0.3"\nvoltage = 1.0\nresistivities = [1, 1]\n'
        "conductivities = [1, 1]\nexpansions = [1, 1]\n"
        'plus = { shape = "rectangle", width = 0.2, height = 0.8, centre = [0.4, 0.0] }\n'
        'minus = [{ shape = "disc", radius = 0.15 }]\n'
    )
    found = scene_file.request(written(tmp_path, text)).options
    assert isinstance(found["plus"], Region)
    assert found["minus"].contains(np.zeros(1), np.zeros(1)).all()
    for old, new, message in (
        ('"disc"', '"disk"', r"minus.*disk.*disc"),
        ("radius = 0.15", "radius = -1", r"minus.*positive"),
        ('[{ shape = "disc", radius = 0.15 }]', "[]", r"minus.*shape"),
        ('[{ shape = "disc", radius = 0.15 }]', "3", r'minus.*condition such as "x < 1"'),
    ):
        with pytest.raises(SceneFileError, match=rf"scene\.toml:\d+: \[joule\] {message}"):
            scene_file.request(written(tmp_path, text.replace(old, new)))


def test_pairs_are_vectors_of_formulas_or_points():
    found = table_of("pair", "One.", Analysis("pair", "One.", pair).options).model_validate(
        {"field": ["x", 1.0], "both": [1, 2]}
    )
    assert found.field(np.array([2.0]), np.array([0.0])).tolist() == [[2.0, 1.0]]
    assert found.both == [1.0, 2.0]


def pair(scene: object, field: Annotated[Value, 2], both: tuple[float, float]) -> None:
    """Keywords with two components."""


@pytest.mark.parametrize(
    ("name", "analysis", "keys"),
    [("cooling", "transient", {"initial", "times"}), ("pulse", "waves", {"end", "velocity"})],
)
def test_examples_in_time(name, analysis, keys):
    request = scene_file.request(EXAMPLES / f"{name}.toml")
    assert request.analysis == analysis
    assert set(request.options) == keys


def test_what_a_file_cannot_say_is_named():
    for annotation in (Callable[..., Any], dict[str, int], int | str):
        with pytest.raises(TypeError, match="cannot say 'thing'"):
            kind_of("thing", annotation)


def test_a_file_asks_for_modes(tmp_path):
    request = scene_file.request(written(tmp_path, PLATE + "[modes]\ncount = 2\n"))
    assert (request.analysis, request.options) == ("modes", {"count": 2})
    assert request.scene.density == 2.0
    found = request.run()
    assert found.summary()["rigid"] == 3
    assert len(found.frequencies) == 2


@pytest.mark.parametrize(
    ("table", "says"),
    [
        ("[modes]\n", r"scene.toml:\d+: \[modes\].*count"),
        ("[modes]\ncount = 2.5\n", r"scene.toml:17: \[modes\].*whole number"),
        ("[modes]\ncuont = 2\n", r"scene.toml:\d+: \[modes\].*did you mean 'count'"),
        ("[modes]\ncount = 2\n[fracture]\nG1 = 1.0\nstop = 2.0\n", "one analysis at a time"),
    ],
)
def test_tables_that_make_no_sense(tmp_path, table, says):
    with pytest.raises(SceneFileError, match=says):
        scene_file.request(written(tmp_path, PLATE + table))


def test_what_the_physics_refuses_points_to_the_table(tmp_path):
    text = PLATE.replace("density = 2.0\n", "") + "[modes]\ncount = 2\n"
    with pytest.raises(SceneFileError, match="density"):
        scene_file.request(written(tmp_path, text)).run()
