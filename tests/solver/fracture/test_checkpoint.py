"""A run that goes on from a checkpoint is the run that was never interrupted."""

import random

import numpy as np
import pytest
from threadpoolctl import threadpool_info

from solver import (
    Crack,
    ElasticTensor,
    Programme,
    Scene,
    SceneError,
    Support,
    Toughness,
    state_file,
)
from solver import rectangle as rectangle_of
from solver.fracture import checkpoint, grow
from solver.linear import TwoLevel
from solver.state_file import StateFile
from tests.solver.fracture.strip import scene


def run(path=None, solves=8, w=2.0):
    toughness = np.full(scene().family().size, w)
    return grow(
        scene(), toughness, batch=4, max_solves=solves, checkpoint=path, every=2, tolerance=1e-10
    )


def test_resumed_runs_are_bit_identical(tmp_path):
    path = tmp_path / "run.npz"
    whole = run()
    run(path, solves=4)
    assert path.is_file()
    resumed = run(path)
    np.testing.assert_array_equal(resumed.broken_bonds, whole.broken_bonds)
    np.testing.assert_array_equal(resumed.history.array, whole.history.array)
    np.testing.assert_array_equal(resumed.unknowns, whole.unknowns)


def test_a_checkpoint_of_another_run_is_not_taken(tmp_path):
    path = tmp_path / "run.npz"
    run(path, solves=4)
    with pytest.raises(ValueError, match="checkpoint"):
        run(path, w=3.0)


def opened(solves, path=None):
    """A double cantilever whose ended bonds and unknowns are enough for two levels and for BLAS
    to share out its products."""
    supports = [
        Support.where(lambda x, y: x < -2.8, u2=lambda x, y: np.sign(y)),
        Support.where(lambda x, y: x > 2.85, displacement=(0.0, 0.0), rotation=0.0),
    ]
    body = Scene(
        rectangle_of(6.0, 2.0), 0.1, ElasticTensor.orthotropic(20.0, 10.0, 5.0, 0.2), m=3,
        surface="extrapolated", supports=supports, cracks=[Crack((-4.0, 0.0), (-1.0, 0.0))],
    )  # fmt: skip
    programme = Programme(control="following")
    return grow(body, Toughness(1.0, 0.8), programme, max_solves=solves, checkpoint=path)


@pytest.mark.parametrize("interrupted", [2, 9])
def test_resumed_runs_are_bit_identical_beside_extrapolated_surfaces(tmp_path, interrupted):
    """BLAS must be pinned where the preconditioner is made again, as it is in a solve."""
    path = tmp_path / "run.npz"
    whole = opened(12)
    assert isinstance(whole.body.preconditioner, TwoLevel)
    assert any(library["user_api"] == "blas" for library in threadpool_info())
    opened(interrupted, path)
    resumed = opened(12, path)
    np.testing.assert_array_equal(resumed.broken_bonds, whole.broken_bonds)
    np.testing.assert_array_equal(resumed.unknowns, whole.unknowns)
    np.testing.assert_array_equal(resumed.history.array, whole.history.array)


def test_damaged_files_are_refused_or_say_the_same(tmp_path):
    """A run must never go on from something else than what was saved."""
    path = tmp_path / "run.npz"
    mark = checkpoint.fingerprint(run(path, solves=4))
    good, saved = path.read_bytes(), StateFile(path, mark).load()
    chance, refused = random.Random(1), []
    for kind in range(400):
        bad = bytearray(good)
        at = chance.randrange(len(bad))
        if kind % 3 == 0:
            bad = bad[:at]
        elif kind % 3 == 1:
            bad[at] ^= 1 << chance.randrange(8)
        else:
            bad[at : at + chance.randrange(40)] = chance.randbytes(chance.randrange(40))
        path.write_bytes(bad)
        try:
            found = StateFile(path, mark).load()
        except SceneError as error:
            refused.append(str(error))
            continue
        assert all(np.array_equal(found[name], saved[name]) for name in saved)
    assert len(refused) > 250
    assert all("checkpoint" in said and "\n" not in said for said in refused)


def test_a_checkpoint_of_other_code_is_not_taken(tmp_path, monkeypatch):
    path = tmp_path / "run.npz"
    run(path, solves=4)
    monkeypatch.setattr(state_file, "code", lambda: "other")
    with pytest.raises(SceneError, match="other code"):
        run(path)


def test_a_path_that_cannot_be_written_is_refused_before_any_work(tmp_path):
    for path in (tmp_path, tmp_path / "no" / "run.npz", tmp_path / ("x" * 300)):
        with pytest.raises(SceneError, match="checkpoint"):
            run(path)
    assert not list(tmp_path.iterdir())


def test_a_full_disk_is_named_and_keeps_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "run.npz"
    run(path, solves=4)
    old = path.read_bytes()

    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", full)
    with pytest.raises(SceneError, match="No space left"):
        run(path, solves=8)
    assert path.read_bytes() == old
