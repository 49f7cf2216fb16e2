"""Records survive a round trip; broken files are refused by name."""

import importlib.util
import json
import math
import random
from dataclasses import replace

import numpy as np
import pytest

from cmverify.case import Failed
from cmverify.exchange.export import write_fields
from cmverify.run import results
from tests.cmverify.toy_registry import trapezium


def record(outcome):
    return results.Record("toy", "bond/trapezium", 10, outcome, 1, 0.5, "abc")


def test_a_measurement_comes_back_as_it_was(tmp_path):
    before = trapezium(10)
    after = results.load(results.save(record(before), tmp_path)).outcome
    assert after.quantities == before.quantities
    assert after.seconds == before.seconds
    assert after.statistics == before.statistics
    told = replace(before, warnings=("a member is thin",))
    assert results.load(results.save(record(told), tmp_path)).outcome.warnings == told.warnings
    np.testing.assert_array_equal(after.fields.points, before.fields.points)
    item, original = after.fields.items["f"], before.fields.items["f"]
    np.testing.assert_array_equal(item.difference, original.difference)
    assert (item.label, item.unit) == (original.label, original.unit)
    np.testing.assert_array_equal(after.lines[0].curves[0].computed, np.exp(np.linspace(0, 1, 11)))


def test_not_a_number_survives(tmp_path):
    broken = trapezium(10)
    broken.quantities["integral"] = math.nan
    after = results.load(results.save(record(broken), tmp_path)).outcome
    assert math.isnan(after.quantities["integral"])


def test_a_failure_comes_back(tmp_path):
    failed = Failed("ArithmeticError", "no luck", "trace")
    after = results.load(results.save(record(failed), tmp_path))
    assert after.outcome == failed
    assert after.failed


def test_no_partial_files_are_left(tmp_path, monkeypatch):
    def interrupt(*args, **kwargs):
        raise KeyboardInterrupt

    monkeypatch.setattr(results.os, "replace", interrupt)
    with pytest.raises(KeyboardInterrupt):
        results.save(record(trapezium(10)), tmp_path)
    assert not [p for p in tmp_path.rglob("*") if p.is_file()]


@pytest.mark.parametrize("text", ["", "{}", '{"format": 99}', "[1]"])
def test_unusable_records_are_named(tmp_path, text):
    path = tmp_path / "broken.json"
    path.write_text(text)
    with pytest.raises(ValueError, match=r"broken\.json is not a usable"):
        results.load(path)


def test_fields_are_written_for_other_programs(tmp_path):
    import meshio

    fields = trapezium(10).fields
    vtu, npz = write_fields(fields, tmp_path / "deep" / "toy")
    mesh = meshio.read(vtu)
    np.testing.assert_allclose(mesh.points[:, :2], fields.points)
    np.testing.assert_allclose(mesh.point_data["f_difference"], fields.items["f"].difference)
    with np.load(npz) as arrays:
        assert {"points", "f", "f_reference", "f_difference"} <= set(arrays.files)


@pytest.mark.parametrize("suffix", [".json", ".npz"])
def test_damaged_records_are_refused_by_name(tmp_path, suffix):
    path = results.save(record(trapezium(10)), tmp_path)
    file = path.with_suffix(suffix)
    good, chance = file.read_bytes(), random.Random(1)
    for kind in range(150):
        bad = bytearray(good)
        at = chance.randrange(len(bad))
        if kind % 3 == 0:
            bad = bad[:at]
        elif kind % 3 == 1:
            bad[at] ^= 1 << chance.randrange(8)
        else:
            bad[at : at + 20] = chance.randbytes(20)
        file.write_bytes(bad)
        with pytest.raises(ValueError, match="is not a usable result record") as caught:
            results.load(path)
        assert "\n" not in str(caught.value)


def test_a_figure_that_was_edited_is_seen(tmp_path):
    path = results.save(record(trapezium(10)), tmp_path)
    data = json.loads(path.read_text())
    data["measurement"]["quantities"]["integral"] = 0.0
    path.write_text(json.dumps(data))
    with pytest.raises(ValueError, match="it was altered"):
        results.load(path)


def test_the_fingerprint_covers_stored_references(tmp_path, monkeypatch):
    package = tmp_path / "references"
    package.mkdir()
    (package / "__init__.py").touch()
    spec = importlib.util.spec_from_file_location(
        "references", package / "__init__.py", submodule_search_locations=[str(package)]
    )
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: spec)
    found = set()
    for content in (b"1", b"2", b"3"):
        (package / "numbers.npz").write_bytes(content)
        results.source_fingerprint.cache_clear()
        found.add(results.source_fingerprint())
    results.source_fingerprint.cache_clear()
    assert len(found) == 3
