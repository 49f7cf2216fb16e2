"""Registers in kernels do what slices do in Python, wherever they begin."""

import numba as nb
import numpy as np
import pytest

from solver.operators import kernels, lanes
from solver.operators.lanes import load, store, width


def scaled(array, row, at, used, factor, out):
    here, there = load(array, row, at, used), load(array, row, at + 1, used)
    store(out, row, at, used, factor * here - here * there + there)


@pytest.mark.parametrize("precision", [np.float32, np.float64])
def test_compiled_lanes_are_slices(precision):
    rng = np.random.default_rng(5)
    compiled = nb.njit(scaled)
    wide = nb.njit(lambda array: width(array))(np.zeros((1, 1), precision))
    array = np.round(rng.normal(size=(2, 3 * wide)) * 64).astype(precision)
    assert wide == width(array)
    for used in (None, 1, wide - 1, wide):
        for row, at in ((0, 0), (1, 3), (1, 2 * wide - 1)):
            # The last lanes lie at the very end of the array.
            ours, plain = np.zeros((2, 2, 3 * wide), precision)
            compiled(array, row, at, used, precision(0.5), ours)
            scaled(array, row, at, used, precision(0.5), plain)
            np.testing.assert_array_equal(ours, plain)
            assert ours.any()


def test_lanes_need_rows_in_one_piece():
    with pytest.raises(nb.TypingError):
        nb.njit(scaled)(np.zeros((4, 40)).T, 0, 0, None, 1.0, np.zeros((4, 40)))


def test_registers_are_those_of_the_processor(monkeypatch):
    for features, bytes_ in (("+sse2", 16), ("+avx,+avx2", 32), ("+avx2,+avx,+avx512f", 64)):
        monkeypatch.setattr(nb.config, "CPU_FEATURES", features)
        assert lanes._count(8) == 2 * bytes_ // 8


@pytest.mark.parametrize("precision", [np.float32, np.float64])
def test_a_particle_has_the_same_bits_in_runs_of_any_length(precision):
    """Whole values and what is left of a run; special particles up to rounding."""
    rng = np.random.default_rng(6)
    count, row = 43, 60
    grid = rng.normal(size=(3, 3 * row)).astype(precision)
    steps = np.array([1, row - 1, row, row + 1], dtype=np.uint64)
    blocks, bulk = rng.normal(size=(1, 4, 6)), rng.normal(size=(1, 6))
    diagonal, factors = rng.normal(size=(6, count)), rng.random((8, count))
    given = [part.astype(precision) for part in (blocks, bulk, diagonal, factors)]
    for kind in (0, 1, 2):
        found = []
        for size in (1, 2, 7, 16, 20, 43):
            first = np.arange(0, count, size)
            length = np.minimum(size, count - first)
            table = [row + 5 + first, length, first, 0 * first + kind, first, first, 0 * first]
            segments = np.ascontiguousarray(np.column_stack(table), dtype=np.uint64)
            out = np.zeros((3, count), precision)
            kernels.elastic_product.alone(grid, segments, steps, *given, out)
            found.append(out)
        for other in found[1:]:
            # Long runs of special particles are summed bond by bond, in another order.
            rounding = 40 * np.finfo(precision).eps if kind == 2 else 0.0
            np.testing.assert_allclose(found[0], other, rtol=0.0, atol=rounding)
