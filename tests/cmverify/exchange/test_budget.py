"""Estimates grow as the work does, and say why they refuse."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cmverify.exchange.budget import estimate, free_memory
from solver import Family, rectangle
from solver.bonds import Bonds
from solver.geometry import Lattice
from tests.solver.bodies import few

SURFACES = st.sampled_from(["none", "volume", "extrapolated"])


@given(st.floats(1e-3, 0.2), st.floats(1, 50), st.sampled_from([1, 3]), SURFACES, st.booleans())
def test_finer_lattices_and_longer_horizons_cost_more(h, m, components, surface, growing):
    one = estimate(1.0, 1.0, h, m, components, surface, growing=growing)
    finer = estimate(1.0, 1.0, h / 2, m, components, surface, growing=growing)
    longer = estimate(1.0, 1.0, h, 2 * m, components, surface, growing=growing)
    for other in (finer, longer):
        assert other.memory > one.memory
        assert other.seconds > one.seconds


def test_a_refusal_names_both_numbers():
    cost = estimate(1.0, 1.0, 0.02, 500.0, 1, "volume")
    assert not cost.refusal(1e15, 1e15)
    assert "TiB of memory, and 1 GiB may be used" in estimate(
        1.0, 1.0, 1e-5, 5.0, 3, "volume"
    ).refusal(2.0**30, 1e15)
    assert "and 60 s may be spent" in cost.refusal(1e15, 60.0)


@pytest.mark.parametrize(
    ("h", "m", "low", "high"), [(0.005, 5, 15e6, 80e6), (0.0025, 5, 60e6, 320e6)]
)
def test_the_constants_are_those_measured(h, m, low, high):
    """Peak memory of these two scenes: 36 and 144 MB beyond the libraries."""
    assert low < estimate(1.0, 1.0, h, m, 3, "volume").memory < high


def test_some_memory_is_free():
    assert free_memory() > 0


@few
@given(st.integers(2, 14), st.integers(2, 14), st.floats(1, 9), st.booleans())
def test_bonds_are_counted_over_what_a_body_can_hold(columns, rows, m, turned):
    """Bodies of some cells, with horizons up to several times their size."""
    h = 0.5
    region = rectangle(columns * h, rows * h, angle=0.4 if turned else 0.0)
    family = Family(m, h)
    bonds = Bonds(Lattice(region, h, family.reach).centred, family, [], "extrapolated").ended
    cost = estimate(columns * h, rows * h, h, m, 3, "extrapolated")
    assert bonds is not None
    assert len(bonds) / 3 < cost.ended < 4 * len(bonds) + 50 * family.size
    found = 0 if bonds.chords is None else len(bonds.chords.offset)
    assert found < 3 * cost.chords + 100
    assert cost.chords < 10 * found + 2000
