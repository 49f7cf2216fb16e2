"""Slabs: the mean over their layers whatever their order, refused where layers disagree."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cmverify.exchange.layers import LayerError, layers_of


def slab(layers, seed=0, count=12):
    """Points above each other in a random order, and which place each is at."""
    random = np.random.default_rng(seed)
    base = random.random((count, 2))
    points = np.hstack([np.tile(base, (layers, 1)), np.repeat(np.arange(layers), count)[:, None]])
    order = random.permutation(len(points))
    return base, points[order].astype(float), np.tile(np.arange(count), layers)[order]


@given(st.integers(2, 7), st.integers(0, 99))
def test_the_mean_does_not_know_the_order(layers, seed):
    base, points, place = slab(layers, seed)
    found = layers_of(points)
    # In the order of the lowest layer.
    order = np.argsort(place[found.members[0]])
    assert np.array_equal(found.points[order], base)
    assert np.array_equal(found.points[found.place], points[:, :2])
    values = base[place] + points[:, 2:] - (layers - 1) / 2
    mean, apart = found.mean(values)
    assert mean[order] == pytest.approx(base)
    assert apart == pytest.approx((layers - 1) / 2 / np.abs(values).max())


def test_a_plane_at_any_height_has_no_layers():
    _, points, _ = slab(1)
    points[:, 2] = 7.0
    points[3] = points[2]  # doubled nodes of a slit
    assert layers_of(points) is None
    assert layers_of(np.array([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]])) is None


def test_what_does_not_stand_above_each_other_is_refused():
    _, points, place = slab(3)
    with pytest.raises(LayerError, match="3 heights"):
        layers_of(points[1:])
    moved = points.copy()
    moved[np.flatnonzero((place == 0) & (points[:, 2] == 1))[0], 0] += 0.01
    with pytest.raises(LayerError, match="one at a place"):
        layers_of(moved)
