"""Whatever a scene file says: an exit code of 0, 1 or 2, one line that names file and key."""

import re
import warnings

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

from cmverify.cli import app
from tests.cmverify.exchange.mutated import WHOLE, mutated

# File, line, and the table with its number or what is wrong with the text itself.
REFUSAL = re.compile(
    r"error: \S+scene\.toml(:\d+: (\[\w+( #\d+)?\] \S|unknown key|title|is not TOML)"
    r"|: the section \[\w+\] is missing)"
)


def solved(folder, text):
    """Exit code and output of `cmverify solve`; warnings are errors, and a traceback fails."""
    path = folder / "scene.toml"
    path.write_text(text, encoding="utf-8")
    given = [
        "solve",
        str(path),
        "--out",
        str(folder / "out"),
        "--max-minutes",
        "0.05",
        "--overwrite",
    ]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = CliRunner().invoke(app, given)
    if found.exception is not None and not isinstance(found.exception, SystemExit):
        raise found.exception
    return found.exit_code, found.output


@pytest.mark.parametrize("name", WHOLE)
def test_the_files_are_whole_before_anything_is_changed(tmp_path, name):
    code, said = solved(tmp_path, WHOLE[name])
    assert code == 0, said


@settings(
    max_examples=80, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(name=st.sampled_from(sorted(WHOLE)), seed=st.integers(0, 10**6), times=st.integers(1, 3))
def test_mutated_files_are_solved_or_refused_in_one_line(tmp_path, name, seed, times):
    code, said = solved(tmp_path, mutated(name, seed, times))
    assert code in (0, 2), said
    if code == 2:
        assert REFUSAL.match(said.strip()), said  # older rich begins with a blank line
        assert len(said.strip().splitlines()) == 1, said


@pytest.mark.parametrize(
    ("name", "old", "new", "at", "message"),
    [
        ("conduction", "m = 2", "m = 500", None, r"m: .* [GT]iB .* may be used"),
        ("conduction", "m = 2", "m = 3000", None, r"m: .* [GT]iB"),
        ("conduction", "spacing = 0.2", "spacing = 1e-5", None, r"spacing: .* TiB"),
        ("conduction", "m = 2", "m = 1e308", None, r"m: must not exceed"),
        ("conduction", "[0.0, 0.0]", "[1.0]", None, r"centre: must be a list of 2"),
        ("conduction", 'where = "y > 0"', "where = 3", None, r"where: must be a condition"),
        ("conduction", '"y > 0"', '"y > 5"', None, r"where: .* no particle"),
        ("conduction", "1e-8", '"x"', None, r"tolerance: must be a number"),
        ("conduction", '"1 + x"', '"9**9**9"', None, r"value: .* no finite real value"),
        ("conduction", '"1 + x"', '"1/0"', None, r"value: .* no finite real value"),
        ("conduction", '"1 + x"', '"log(x)"', None, r"value: .* at x = "),
        ("conduction", "[[3.0, 0.5]", "[[0.1, 0.5]", "[material]", r"the conductivity .* not p"),
        ("elasticity", '"0.1*y"', '"abs(x, x)"', None, r"displacement: .* takes 1"),
        ("elasticity", '"x < -0.9"', '"x < -9"', None, r"where: .* no particle"),
        (
            "elasticity",
            "[0.1, 1.2]\nend = [0.1,",
            "[9.1, 1.2]\nend = [9.1,",
            "[[crack]]",
            r"the crack .* cuts no bond",
        ),
        ("elasticity", "[1.5, 1.0]", "[1.5, -1.0]", "end = [1.5", r"end: .* elsewhere"),
        ("elasticity", 'plane = "stress"', 'plane = "strain"', None, r".*'E3' is missing"),
        ("fracture", "n = 2", "n = 3", "[fracture]", r"the exponent .* even"),
        ("fracture", "max_solves = 4", "", "[fracture]", r"has no end"),
    ],
)
def test_each_known_trap_is_named_with_its_line(tmp_path, name, old, new, at, message):
    assert old in WHOLE[name]
    text = WHOLE[name].replace(old, new, 1)
    code, said = solved(tmp_path, text)
    assert code == 2
    line = text[: text.index(at or new)].count("\n") + 1
    assert re.search(rf"scene\.toml:{line}: \[[^\]]+\] {message}", said), said


def test_plane_strain_of_an_orthotropic_solid_takes_its_third_axis(tmp_path):
    text = WHOLE["elasticity"].replace(
        'plane = "stress"', 'plane = "strain"\nE3 = 9e9\nnu13 = 0.1\nnu23 = 0.1'
    )
    code, said = solved(tmp_path, text)
    assert code == 0, said
