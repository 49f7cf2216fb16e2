"""What studies leave is read as it was written, and anything else is named."""

import pytest

from cmverify.report import study_file


def test_it_is_read_as_it_was_written(tmp_path):
    path = tmp_path / "study.json"
    assert study_file.read(path, 3, "study", dict) is None
    study_file.write(path, 3, {"rows": [1, 2], "name": "Δ"})
    assert study_file.read(path, 3, "study", dict) == {"rows": [1, 2], "name": "Δ"}


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"format": 2}', '{"format": 3}', "1", "\xff"])
def test_what_is_none_is_named_with_its_file(tmp_path, text):
    path = tmp_path / "study.json"
    path.write_bytes(text.encode("latin-1"))
    with pytest.raises(ValueError, match=r"study\.json is no study: "):
        study_file.read(path, 3, "study", lambda data: data["rows"])
