"""A run that goes on from a checkpoint is the run that was never interrupted."""

import numpy as np
import pytest

from solver.fracture import grow
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
