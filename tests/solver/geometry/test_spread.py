"""Concentrated loads: who sees a point is who has a bond through it."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from solver import Crack, Family, SceneError, polygon, rectangle
from solver.bonds import Bonds
from solver.geometry import Lattice, on_particles
from solver.geometry.spread import _Sight
from tests.solver.bodies import few

share = st.floats(-1.0, 1.0)


@few
@given(
    st.lists(st.tuples(share, share), min_size=3, max_size=3),
    st.lists(st.tuples(share, share), min_size=2, max_size=3, unique=True),
)
def test_particles_see_each_other_where_a_bond_exists(notch, crack):
    """Notches, slots, cracks, mouths and tips alike; in cells of a tenth."""
    try:
        region = rectangle(1.2, 1.0) - polygon(notch)
        lattice = Lattice(region, 0.1, 4).centred
        bonds = Bonds(lattice, Family(2, 0.1), [Crack(*crack)])
    except ValueError:
        assume(False)
    sight = _Sight(lattice, [Crack(*crack)])
    units = sight.frame.units(lattice.points)
    number, (rows, columns) = lattice.number(), lattice.rows_columns
    for p in range(0, lattice.count, 7):
        if sight.cracks.between(units[p], units[p : p + 1])[0]:
            continue  # a particle on the crack is asked for its side
        there = [number[rows[p] + dy, columns[p] + dx] for dx, dy in bonds.family.offsets]
        known = np.array(there) >= 0
        seen = sight(lattice.points[p], lattice.points[np.array(there)[known]])
        strength = bonds.strengths_of(np.array([p]))[known, 0]
        np.testing.assert_array_equal(seen, strength != 0)


@few
@given(st.floats(0.02, 0.6), st.floats(0.05, 0.45), st.floats(0.05, 0.9))
def test_loads_do_not_reach_across_a_slot_however_thin(width, depth, place):
    """Widths and distances in cells."""
    h = 0.1
    slot = polygon(
        [(-0.1, -width * h / 2), (0.6, -width * h / 2), (0.6, width * h / 2), (-0.1, width * h / 2)]
    )
    lattice = Lattice(rectangle(1.0, 1.0) - slot, h, 3).centred
    point = np.array([[0.45 * place, (0.5 * width + depth) * h]])
    _, particle, part = on_particles(lattice, [], point)
    assert part.sum() == pytest.approx(1.0)
    assert lattice.points[particle, 1].min() > 0


def test_loads_do_not_reach_across_a_mouth():
    """A crack that begins a third of a cell within the edge is open there."""
    lattice = Lattice(rectangle(1.0, 1.0), 0.1, 3).centred
    crack = Crack((-0.467, 0.0), (0.2, 0.0))
    _, particle, _ = on_particles(lattice, [crack], np.array([[-0.49, 0.01]]))
    assert lattice.points[particle, 1].min() > 0


def test_points_that_nobody_sees():
    lattice = Lattice(rectangle(1.0, 1.0), 0.1, 3).centred
    crack = Crack((-0.2, 0.013), (0.2, 0.013))
    for point in ((0.0, 0.013), (0.52, 0.0)):
        with pytest.raises(SceneError, match="no particle sees it"):
            on_particles(lattice, [crack], np.array([point]))
    # Chords of curved edges miss a point by less than a tenth of a cell.
    assert on_particles(lattice, [crack], np.array([(0.508, 0.0)]))[2].sum() == pytest.approx(1.0)
