"""Modes are paired by their shapes, whatever their order, sign, size and mixture in a group."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from cmverify.exchange.modes_paired import paired


def some(rng, count, points):
    """Shapes that are orthonormal with the weights, and the weights."""
    weight = rng.uniform(0.5, 2.0, points)
    root = np.repeat(np.sqrt(weight), 2)
    basis = np.linalg.qr(rng.standard_normal((2 * points, count)))[0].T / root
    return basis.reshape(count, points, 2), weight


@given(st.integers(0, 2**32 - 1), st.integers(2, 6), st.floats(0.0, 0.005))
def test_swapped_scaled_and_mixed_modes_find_each_other(seed, count, split):
    rng = np.random.default_rng(seed)
    others, weight = some(rng, count + 3, 40)
    # The first two are one group, whose members nobody can tell apart.
    frequencies = 1.0 + 0.5 * np.arange(count + 3.0)
    frequencies[1] = frequencies[0] * (1 + split)
    order = np.concatenate([[0, 1], 2 + rng.permutation(count - 2)]).astype(int)
    angle = rng.uniform(0, 2 * np.pi)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    shapes = others[order].copy()
    shapes[:2] = np.tensordot(turn, others[:2], axes=1)
    size = rng.uniform(-3, 3, count)
    size[np.abs(size) < 0.1] = 1.0
    own = 1.003 * frequencies[order]
    found = paired(own, size[:, None, None] * shapes, frequencies, others, weight)
    assert found.alike.all()
    np.testing.assert_allclose(found.share, 1.0, atol=1e-9)
    np.testing.assert_allclose(found.frequencies[2:], frequencies[order][2:])
    assert sorted(found.frequencies[:2]) == sorted(frequencies[:2])
    np.testing.assert_allclose(found.shapes, size[:, None, None] * shapes, atol=1e-9)


def test_what_is_not_there_is_not_paired():
    rng = np.random.default_rng(0)
    shapes, weight = some(rng, 6, 40)
    found = paired(np.arange(1.0, 4.0), shapes[[0, 5, 2]], np.arange(1.0, 6.0), shapes[:5], weight)
    np.testing.assert_array_equal(found.alike, [True, False, True])
    assert np.isnan(found.frequencies[1])
    np.testing.assert_array_equal(found.frequencies[[0, 2]], [1.0, 3.0])


def test_a_dense_spectrum_is_no_single_group():
    """Neighbours within a per cent, thirty of them over a third: a mixture of all is not alike."""
    rng = np.random.default_rng(1)
    shapes, weight = some(rng, 30, 40)
    frequencies = 548.0 * 1.012 ** np.arange(30.0)
    turn = np.linalg.qr(rng.standard_normal((30, 30)))[0]
    mixed = np.tensordot(turn, shapes, axes=1)
    assert not paired(frequencies, shapes, frequencies, mixed, weight).alike.any()
    closer = 548.0 * 1.008 ** np.arange(30.0)
    assert paired(closer, shapes, closer, mixed, weight).alike.sum() <= 1
    assert paired(closer, shapes, closer, shapes, weight).alike.all()
