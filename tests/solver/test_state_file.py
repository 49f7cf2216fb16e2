"""States come back as they were, or are refused in one line."""

import numpy as np
import pytest

from solver import SceneError, state_file


def test_a_state_comes_back_as_it_was_or_is_refused(tmp_path):
    path = tmp_path / "state.npz"
    file = state_file.StateFile(path, "mine")
    assert file.load() is None
    state = {"x": np.arange(5.0), "count": 3, "nothing": np.zeros((0, 4))}
    file.save(state)
    found = file.load()
    assert set(found) == set(state)
    for name, value in state.items():
        np.testing.assert_array_equal(found[name], value)
    with pytest.raises(SceneError, match="belongs to another"):
        state_file.StateFile(path, "yours").load()
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(bytes(content))
    with pytest.raises(SceneError, match=r"damaged|no checkpoint|belongs"):
        file.load()
    path.write_bytes(b"no archive")
    with pytest.raises(SceneError, match=r"damaged|no checkpoint"):
        file.load()
    assert state_file.StateFile(None, "").load() is None
    with pytest.raises(SceneError, match="no folder"):
        state_file.StateFile(tmp_path / "no" / "state", "")
    with pytest.raises(SceneError, match="it is a folder"):
        state_file.StateFile(tmp_path, "")


def test_other_code_leaves_another_mark(monkeypatch):
    before = state_file.fingerprint(x=np.ones(2))
    assert before == state_file.fingerprint(x=np.ones(2))
    assert before != state_file.fingerprint(x=np.ones(2) + 1e-16 * 4)
    monkeypatch.setattr(state_file, "code", lambda: "another")
    assert before != state_file.fingerprint(x=np.ones(2))
