"""Records survive a round trip; broken files are refused by name."""

import math

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
