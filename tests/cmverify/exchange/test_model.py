"""The declaration of scene files as a JSON schema, for editors."""

import json
import tomllib
from pathlib import Path

import pytest

from cmverify.exchange.analysis_table import scene_model
from cmverify.exchange.model import SceneFile

EXAMPLES = Path(__file__).parents[3] / "examples"


def test_the_schema_knows_every_table_and_key():
    schema = SceneFile.model_json_schema()
    json.dumps(schema)
    assert set(schema["properties"]) >= {"discretisation", "region", "material", "support"}
    tables = schema["$defs"]
    assert tables["Disc"]["properties"]["radius"]["exclusiveMinimum"] == 0
    assert tables["Support"]["additionalProperties"] is False
    assert tables["Discretisation"]["required"] == ["spacing"]
    assert {"type": "string"} in tables["Source"]["properties"]["where"]["anyOf"]


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda p: p.name)
def test_examples_are_of_the_model(path):
    assert scene_model().model_validate(tomllib.loads(path.read_text(encoding="utf-8")))
