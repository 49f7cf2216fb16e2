"""The energy criterion step by step: the largest ratio is found, and the path is led by it."""

import numpy as np
import pytest

from references.fem.energy_path import energy_path, largest


def test_the_largest_value_is_found_beyond_the_angles_tried() -> None:
    def value(angle: float) -> float:
        return float(np.exp(-3.0 * (angle - 0.9) ** 2))

    assert largest(value, [0.0, 0.2], 0.1) == pytest.approx(0.9, abs=1e-12)
    with pytest.raises(ValueError, match="no largest"):
        largest(lambda angle: float(np.exp(angle)), [0.0], 0.1)


def test_a_path_follows_what_is_cheapest_where_all_directions_release_alike() -> None:
    found = energy_path(
        (1.0, 2.0), lambda points: 5.0, lambda way: 2.0 - np.cos(2 * (way - 0.7)), 0.5, 3, [0.4]
    )
    assert found.directions == pytest.approx(0.7, abs=1e-3)
    assert found.ratios == pytest.approx(5.0, rel=1e-5)
    ahead = 1.5 * np.array([np.cos(0.7), np.sin(0.7)])
    assert found.points[-1] - found.points[0] == pytest.approx(ahead, abs=2e-3)


def test_each_step_sees_the_whole_path() -> None:
    """A release that pulls towards a point: the path comes to it."""
    goal = np.array([3.0, 1.0])

    def release(points: np.ndarray) -> float:
        return float(np.exp(-np.hypot(*(points[-1] - goal))))

    found = energy_path((0.0, 0.0), release, lambda way: 1.0, 0.4, 7, [0.0])
    assert np.hypot(*(found.points[-1] - goal)) < 0.4
    assert np.hypot(*np.diff(found.points, axis=0).T) == pytest.approx(0.4)
