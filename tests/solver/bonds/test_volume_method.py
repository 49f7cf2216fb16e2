"""The volume method: factors 2 V₀ / (V_p + V_q), by hand and against plain counting."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import Crack, Family, rectangle
from solver.bonds import Bonds, check_surface
from solver.bonds.volume_method import full_volume, volume_factor
from solver.geometry import Lattice
from tests.solver.bodies import Cells, block, cut_by, few, masks
from tests.solver.bonds.test_bonds import leaving, pair_factors


def test_three_particles_in_a_row_by_hand():
    # Four neighbours and the cell itself: V₀ = 5, at the ends V = 2, in the middle V = 3.
    family = Family(1, 1.0, "full")
    assert full_volume(family) == 5.0
    bonds = Bonds(Lattice(block(3, 1), 1.0, 1), family, treatment="volume")
    factors = pair_factors(bonds)
    assert factors == {
        (0, 1): pytest.approx(2.0),
        (1, 0): pytest.approx(2.0),
        (1, 2): pytest.approx(2.0),
        (2, 1): pytest.approx(2.0),
    }


def volumes(bonds, held, judge):
    """Volume of each family: its cell and the shares of the neighbours it has."""
    lattice, family = bonds.lattice, bonds.family
    number, (rows, columns) = lattice.number(), lattice.rows_columns
    found = np.ones(lattice.count)

    def beyond_support(row, column):
        away = np.hypot(rows - row, columns - column)
        return held.any() and (held.all() or away[held].min() <= away[~held].min() * (1 + 1e-9))

    for p in range(lattice.count):
        for (dx, dy), share in zip(family.offsets, family.fraction, strict=True):
            q = number[rows[p] + dy, columns[p] + dx]
            if q < 0:
                # Beyond a wholly prescribed particle the edge is no surface.
                beyond = held[p] or beyond_support(rows[p] + dy, columns[p] + dx)
                found[p] += share * beyond
            else:
                found[p] += share * judge(p, q)
    return found


def test_a_thin_layer_is_no_surface_either():
    # One prescribed column at the right: the particles behind it lack neighbours, but beyond a
    # support; with the left edge free, only there are bonds stiffened.
    family = Family(3)
    lattice = Lattice(block(20, 20), 1.0, family.reach)
    held = lattice.points[:, 0] > 19
    bonds = Bonds(lattice, family, (), "volume", held)
    middle = np.abs(lattice.points[:, 1] - 10) < 1
    factors = {p: f for (p, _), f in pair_factors(bonds).items()}
    right = [p for p in factors if middle[p] and lattice.points[p, 0] > 12]
    assert not right or all(factors[p] == pytest.approx(1.0) for p in right)
    assert any(f > 1.1 for f in factors.values())


@few
@given(masks(), st.integers(0, 10**6), st.sampled_from(["full", "partial", "exact"]))
def test_factors_of_random_bodies(mask, seed, rule):
    mask[2:4, 1:6] = True
    held = np.random.default_rng(seed).random(mask.sum()) < 0.3
    family, crack = Family(2, 0.5, rule), Crack((1.1, 1.5), (2.3, 1.6))
    lattice = Lattice(Cells(mask, 0.5), 0.5, family.reach)
    bonds = Bonds(lattice, family, [crack], "volume", held)
    judge = cut_by(lattice, crack)
    volume = volumes(bonds, held, judge)
    # Bonds that leave the body do not exist, but their particles stiffen no others.
    lost = leaving(bonds)
    for (p, q), factor in pair_factors(bonds).items():
        inside = 0.0 if (p, q) in lost else 1.0
        wanted = inside * judge(p, q) * 2 * full_volume(family) / (volume[p] + volume[q])
        assert factor == pytest.approx(wanted, rel=1e-12)
        assert factor == 0 or factor >= 1 - 1e-12


def test_no_factors_in_bulk_or_behind_a_wide_layer():
    family = Family(2, 0.1)
    lattice = Lattice(rectangle(2.0, 2.0), 0.1, family.reach)
    free = Bonds(lattice, family, treatment="volume")
    depth = lattice.edge_distance
    # Families cut short reach one horizon deep, and their bonds a second.
    assert depth[free.special].max() < 2 * family.length.max()
    assert len(free.special) > 0
    held = Bonds(lattice, family, treatment="volume", prescribed=depth < family.length.max())
    assert len(held.special) == 0


def test_factor_is_one_between_whole_families():
    family = Family(3)
    whole = full_volume(family)
    assert volume_factor(family, np.array(whole), np.array(whole)) == 1.0
    assert volume_factor(family, np.array(whole / 2), np.array(whole / 2)) == 2.0


def test_unknown_treatment():
    with pytest.raises(ValueError, match=r"unknown surface treatment.*volume"):
        check_surface("fancy")
