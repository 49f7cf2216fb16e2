"""Files to start from are solved as they are, and what they comment out may be said."""

import re
import tomllib

import numpy as np
import pytest
from typer.testing import CliRunner

from cmverify.cli import app
from cmverify.exchange import scene_file, schema, start_file
from solver.analyses import analyses

cli = CliRunner()


def test_every_analysis_has_one():
    assert set(start_file.KINDS) >= set(analyses()) - {"solve"}


def request(folder, kind):
    path = folder / "start.toml"
    path.write_text(start_file.text(kind), encoding="utf-8")
    return scene_file.request(path)


@pytest.mark.parametrize("kind", start_file.KINDS)
def test_it_asks_for_what_it_is_called(tmp_path, kind):
    assert request(tmp_path, kind).analysis == (kind if kind in analyses() else "solve")


#: Those that no other test here runs the like of.
QUICK = ("conduction", "electric", "modes", "thermoelastic")


@pytest.mark.parametrize(
    "kind",
    [kind if kind in QUICK else pytest.param(kind, marks=pytest.mark.slow)
     for kind in start_file.KINDS],
)  # fmt: skip
def test_it_is_solved_as_it_is(tmp_path, kind):
    found = request(tmp_path, kind).run()
    fields = found.fields()
    assert all(np.isfinite(values).all() for values in fields.values())
    # Something happens in each.
    assert max(np.abs(v).max() for k, v in fields.items() if k != "prescribed") > 0
    said = found.summary().get("warnings") or ()
    # Deformational heating knows whole bonds only: its file is told what its edges lack.
    assert not [w for w in said if kind != "thermoelastic" or "in the mean alone" not in w]


@pytest.mark.parametrize("kind", start_file.KINDS)
def test_what_is_commented_out_is_toml_of_keys_that_exist(kind):
    text = start_file.text(kind)
    assert all(len(line) <= 160 for line in text.splitlines())
    rows = text.splitlines()[4:]
    keys = [row[2:] for row in rows if re.match(r"# \w+ = |# \[", row)]
    assert keys
    for row in keys:
        tomllib.loads(row)
    declared = {key.name for table in schema.json_schema()["$defs"].values()
                for key in schema.keys(table)}  # fmt: skip
    assert {row.split(" = ")[0] for row in keys if row[0] != "["} <= declared


def test_new_writes_one_and_never_over_another(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = cli.invoke(app, ["new", "modes"])
    assert found.exit_code == 0, found.output
    assert (tmp_path / "modes.toml").read_text(encoding="utf-8") == start_file.text("modes")
    (tmp_path / "modes.toml").write_text("precious")
    found = cli.invoke(app, ["new", "modes"])
    assert found.exit_code == 2
    assert "exists already" in found.output
    assert (tmp_path / "modes.toml").read_text() == "precious"
    assert cli.invoke(app, ["new", "modes", "--overwrite"]).exit_code == 0
    assert "precious" not in (tmp_path / "modes.toml").read_text(encoding="utf-8")
    found = cli.invoke(app, ["new", "mode"])
    assert (found.exit_code, "did you mean modes" in found.output) == (2, True)
    (tmp_path / "file").touch()
    found = cli.invoke(app, ["new", "modes", "--out", "file/below.toml"])
    assert (found.exit_code, len(found.output.strip().splitlines())) == (2, 1)
    listed = cli.invoke(app, ["new"])
    assert all(kind in listed.output for kind in start_file.KINDS)
    assert {p.name for p in tmp_path.iterdir()} == {"modes.toml", "file"}
