"""State files, probes, times and logs."""

import numpy as np
import pytest

from solver import SceneError, rectangle
from solver.analyses import recording
from solver.geometry import Lattice


def test_probes_are_the_nearest_particles():
    lattice = Lattice(rectangle(1.0, 1.0, centre=(5.0, 2.0)), 0.1, 2)
    found = recording.nearest(lattice, [(4.61, 1.56), (5.45, 2.45)])
    np.testing.assert_allclose(lattice.points[found], [(4.65, 1.55), (5.45, 2.45)])
    assert len(recording.nearest(lattice, np.zeros((0, 2)))) == 0
    with pytest.raises(SceneError, match="not in the body"):
        recording.nearest(lattice, [(0.0, 0.0)])
    with pytest.raises(SceneError, match="points"):
        recording.nearest(lattice, [np.nan, 1.0])


def test_times_ascend_within_the_run():
    np.testing.assert_array_equal(recording.checked_times(2.0, 0.0), [2.0])
    for bad in ([], [1.0, 1.0], [np.nan], [-1.0], [5.0], [[1.0]]):
        with pytest.raises(SceneError, match="times must"):
            recording.checked_times(bad, 0.0, 4.0)


def test_a_log_grows():
    log = recording.Log(2)
    for k in range(1000):
        log.append(np.array([k, -k]))
    np.testing.assert_array_equal(log.rows[:, 0], np.arange(1000))
    again = recording.Log(2, log.rows)
    again.append(np.array([7.0, 7.0]))
    assert again.rows.shape == (1001, 2)
