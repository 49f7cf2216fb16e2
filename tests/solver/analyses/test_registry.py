"""Analyses are found by themselves and say what a scene file may ask of them."""

from inspect import Parameter

import pytest

from solver import Scene, Support, rectangle
from solver.analyses import Analysis, analyses, registry
from solver.material import ConductivityTensor


def test_static_comes_first_and_fracture_is_there():
    known = analyses()
    assert next(iter(known)) == "solve"
    assert "fracture" in known
    for name, one in known.items():
        assert one.name == name
        assert one.says.endswith(".")


def test_options_are_the_keywords_of_the_function():
    options = analyses()["solve"].options
    assert options["tolerance"].annotation is float
    assert options["tolerance"].default == 1e-10
    assert analyses()["fracture"].options["G1"].default is Parameter.empty
    assert all(not {"scene", "progress"} & set(one.options) for one in analyses().values())


def test_who_knows_time_and_who_tells_how_far_it_is():
    known = analyses()
    assert {name for name, one in known.items() if one.timed} == {"transient", "waves"}
    told = {name for name, one in known.items() if one.reports}
    # Others are a few solves, over before a bar would help.
    assert told >= {"fracture", "modes", "transient", "waves"}
    assert "solve" not in told


def test_an_analysis_runs_on_a_scene():
    ends = Support.where(lambda x, y: abs(x) > 0.8, temperature=lambda x, y: x)
    scene = Scene(rectangle(2.0, 1.0), 0.25, ConductivityTensor.isotropic(1.0), [ends], m=2)
    found = analyses()["solve"].run(scene, tolerance=1e-6)
    assert found.summary()["residual"] <= 1e-6
    assert abs(found.temperature - scene.solve().temperature).max() < 1e-5


def test_two_of_one_name_are_refused(monkeypatch):
    from solver.fracture import analysis

    monkeypatch.setattr(analysis, "ANALYSIS", Analysis("solve", "Another.", lambda scene: scene))
    registry.analyses.cache_clear()
    with pytest.raises(ValueError, match="two analyses are called 'solve'"):
        analyses()
    monkeypatch.undo()
    registry.analyses.cache_clear()
