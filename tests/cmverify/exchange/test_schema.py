"""The schema and the reference page are those of the declaration."""

import json
import re
from pathlib import Path

import pydantic
import pytest
from typer.testing import CliRunner

from cmverify.cli import app
from cmverify.exchange import reference_page, scene_file, schema
from cmverify.exchange.analysis_table import scene_model
from cmverify.exchange.meanings import meanings
from solver.analyses import analyses

DOCS = Path(__file__).parents[3] / "docs"


@pytest.mark.skipif(
    tuple(map(int, pydantic.VERSION.split(".")[:2])) < (2, 10),
    reason="older pydantic says the same schema in other words",
)
def test_docs_are_current():
    """Else: cmverify schema --folder docs --overwrite."""
    assert (DOCS / "scene.schema.json").read_text(encoding="utf-8") == schema.as_text()
    assert (DOCS / "scene-files.md").read_text(encoding="utf-8") == reference_page.page()


def test_the_scene_of_the_how_to_can_be_read(tmp_path):
    text = (DOCS / "howto" / "scene_files.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```toml\n(.*?)```", text, re.DOTALL)
    (tmp_path / "scene.toml").write_text(block, encoding="utf-8")
    assert scene_file.request(tmp_path / "scene.toml").analysis == "solve"


def test_the_schema_is_json_that_editors_can_read():
    def refuse(word):
        raise AssertionError(f"{word} is not JSON")

    found = json.loads(schema.as_text(), parse_constant=refuse)
    assert found["$schema"].startswith("https://json-schema.org")
    assert set(found["properties"]) == set(scene_model().model_fields)


def test_the_page_names_every_table_and_key():
    page = reference_page.page()
    for table in schema.json_schema()["$defs"].values():
        for key in schema.keys(table):
            assert f"| `{key.name}` | " in page
    for name in analyses():
        assert f"## `[{name}]`" in page


@pytest.mark.parametrize("name", [name for name in analyses() if name not in ("solve", "fracture")])
def test_keys_of_analyses_mean_what_their_docstrings_say(name):
    said = meanings(analyses()[name].run)
    assert said, name
    assert set(analyses()[name].options) <= set(said)


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ({"type": "number", "exclusiveMinimum": 0}, "number > 0"),
        ({"enum": ["a", "b"]}, '"a" or "b"'),
        ({"anyOf": [{"type": "integer"}, {"type": "null"}]}, "whole number"),
        ({"type": "array", "items": {"type": "number"}, "maxItems": 2}, "list of 2: number"),
        ({"type": "string", "format": "condition"}, "condition"),
        ({"type": "string", "description": "formula of x and y"}, "formula of x and y"),
        ({"type": "boolean"}, "true or false"),
    ],
)
def test_kinds_in_words(entry, words):
    assert schema.in_words(entry) == words


def test_the_command_writes_what_it_says(tmp_path):
    cli = CliRunner()
    assert cli.invoke(app, ["schema"]).output == schema.as_text()
    found = cli.invoke(app, ["schema", "--out", str(tmp_path / "a.json")])
    assert (found.exit_code, (tmp_path / "a.json").is_file()) == (0, True)
    (tmp_path / "file").touch()
    found = cli.invoke(app, ["schema", "--folder", str(tmp_path / "file")])
    assert (found.exit_code, len(found.output.strip().splitlines())) == (2, 1)
