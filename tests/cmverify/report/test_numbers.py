"""results.json keeps to its format, and the schema says what that is."""

import json

import pytest
from typer.testing import CliRunner

from cmverify.case import Failed
from cmverify.cli import app
from cmverify.report import numbers, summary
from tests.cmverify.report.test_build import INFO, records
from tests.cmverify.toy_registry import toy, trapezium


def written(outcomes) -> str:
    return summary.as_json(summary.summarise([toy()], records(outcomes)), INFO)


def test_what_is_written_is_what_the_schema_says(tmp_path):
    path = tmp_path / "results.json"
    path.write_text(written({10: trapezium(10), 20: Failed("E", "m")}))
    found = numbers.read(path)
    assert found.format == numbers.FORMAT == json.loads(path.read_text())["format"]
    assert found.counts.crashed == 1
    assert found.cases["toy"].measurements[1].failure.message == "m"

    # Nothing is written that the schema does not describe.
    def strict(model, data):
        assert set(data) == set(model.model_fields), model.__name__

    data = json.loads(path.read_text())
    strict(numbers.Results, data)
    strict(numbers.Counts, data["counts"])
    strict(numbers.Run, data["run"])
    case = data["cases"]["toy"]
    strict(numbers.Case, case)
    strict(numbers.Verdict, case["verdicts"][0])
    strict(numbers.Measurement, case["measurements"][0])
    strict(numbers.Point, case["work_precision"][0])


@pytest.mark.parametrize(
    ("wrong", "said"),
    [({"format": 2}, "format"), ({"counts": {}}, "counts"), ({"cases": {"toy": {}}}, "cases.toy")],
)
def test_another_format_is_refused_with_its_place(tmp_path, wrong, said):
    path = tmp_path / "results.json"
    path.write_text(json.dumps({**json.loads(written({10: trapezium(10)})), **wrong}))
    with pytest.raises(ValueError, match=f"is not of format 1: {said}"):
        numbers.read(path)


def test_the_schema_is_printed_and_describes_the_figures():
    found = CliRunner().invoke(app, ["report", "--schema"])
    schema = json.loads(found.output)
    assert schema["$schema"].startswith("https://json-schema.org/")
    assert schema["properties"]["format"]["const"] == numbers.FORMAT
    described = schema["$defs"]["Measurement"]["properties"]
    assert "wall s" in described["seconds"]["description"]
