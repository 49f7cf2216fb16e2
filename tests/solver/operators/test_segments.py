"""Runs of particles: every particle once, no run across a break; clipping to boxes."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from solver.geometry import Lattice
from solver.operators import segments
from tests.solver.bodies import Cells, few, masks


@few
@given(masks(), st.integers(0, 10**6))
def test_runs_hold_every_particle_once(mask, seed):
    lattice = Lattice(Cells(mask), 1.0, 2)
    kind = np.random.default_rng(seed).integers(0, 2, lattice.count)
    cell, size, first = segments.runs(lattice, np.arange(lattice.count), kind)
    assert size.sum() == lattice.count
    rows, columns = lattice.rows_columns
    width = lattice.shape[1]
    for start, length, place in zip(cell, size, first, strict=True):
        run = slice(place, place + length)
        np.testing.assert_array_equal(
            rows[run] * width + columns[run], np.arange(start, start + length)
        )
        assert len(set(kind[run])) == 1


@few
@given(masks(), st.tuples(st.integers(0, 8), st.integers(0, 8)))
def test_clipping_keeps_what_lies_in_the_box(mask, corner):
    lattice = Lattice(Cells(mask), 1.0, 2)
    everybody = np.arange(lattice.count)
    whole = segments.of(lattice, everybody, np.zeros(lattice.count, int), everybody, everybody)
    low = np.array(corner)
    box = np.array([[*low, *(low + 3)]])
    rows, columns = lattice.rows_columns
    wanted = (rows >= low[0]) & (rows <= low[0] + 3) & (columns >= low[1]) & (columns <= low[1] + 3)
    found = segments.clipped(whole, lattice.shape[1], box).astype(int)
    members = np.concatenate([np.arange(s[2], s[2] + s[1]) for s in found] or [np.zeros(0, int)])
    np.testing.assert_array_equal(members, np.nonzero(wanted)[0])
    for s in found:
        assert s[0] == rows[s[2]] * lattice.shape[1] + columns[s[2]]
        assert s[4] == s[5] == s[2]
