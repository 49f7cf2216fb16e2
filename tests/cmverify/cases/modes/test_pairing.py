"""Modes are paired by shape, whatever their rank and however a double mode is turned."""

import numpy as np
import pytest

from cmverify.cases.modes.pairing import clusters, pair


@pytest.fixture
def modes():
    """Five orthonormal shapes on twenty points, the second and third of one frequency."""
    random = np.random.default_rng(3)
    mass = random.uniform(0.5, 2.0, 20)
    raw, _ = np.linalg.qr(random.standard_normal((40, 5)))
    shapes = raw.T.reshape(5, 20, 2) / np.sqrt(mass)[:, None]
    return np.array([1.0, 2.0, 2.0, 3.0, 3.01]), shapes, mass


def test_clusters():
    found = clusters(np.array([1.0, 2.0, 2.0001, 2.1]))
    assert [group.tolist() for group in found] == [[0], [1, 2], [3]]


def test_crossed_and_turned_modes_find_their_own(modes):
    frequencies, shapes, mass = modes
    c, s = np.cos(0.7), np.sin(0.7)
    own = shapes.copy()
    own[1], own[2] = c * shapes[1] + s * shapes[2], c * shapes[2] - s * shapes[1]
    # The last two cross.
    own = -3.0 * own[[0, 1, 2, 4, 3]]
    computed = np.array([1.01, 2.02, 2.02, 3.005, 3.02])
    pairs = pair(computed, own, mass, frequencies, shapes)
    assert pairs.order.tolist() == [0, 1, 2, 4, 3]
    assert pairs.mac == pytest.approx(1.0)
    assert pairs.errors == pytest.approx([0.01, 0.01, 0.01, 3.02 / 3 - 1, 3.005 / 3.01 - 1])


def test_a_lost_copy_shows_in_the_shapes(modes):
    frequencies, shapes, mass = modes
    kept = [0, 1, 3, 4]
    pairs = pair(frequencies[kept], shapes[kept], mass, frequencies[:3], shapes[:3])
    assert pairs.mac[1] < 0.1


def test_aligned_shapes_meet_the_reference(modes):
    frequencies, shapes, mass = modes
    own = shapes.copy()
    own[[1, 2]] = own[[2, 1]]
    own[0] *= -1
    pairs = pair(frequencies, own, mass, frequencies, shapes)
    assert pairs.aligned == pytest.approx(shapes, abs=1e-9)
