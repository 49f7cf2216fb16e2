"""Bonds that end at cracks: what is parted stays parted."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from solver import Crack, Family, SceneError, disc, rectangle
from solver.bonds import Bonds
from solver.geometry import Lattice
from solver.material import calibrate
from solver.operators import BondOperator
from solver.operators.assembled import to_csr
from tests.solver.bodies import exact, few
from tests.solver.bonds.ending import SOLID, body

# ---- cracks that run into edges -----------------------------------------------------------------


@pytest.mark.parametrize("mouth", [-0.5, -0.51, -0.6])
@pytest.mark.parametrize("height", [0.0, 0.015, 0.025])
@pytest.mark.parametrize("hole", [False, True])
def test_a_plate_cut_in_two_has_two_free_halves(mouth, height, hole):
    region = rectangle(1.0, 1.0) - disc(0.2) if hole else rectangle(1.0, 1.0)
    operator = body(region, 0.05, 3, SOLID, [Crack((mouth, height), (-mouth, height))])
    points = operator.bonds.lattice.points
    # Rows on the very line of the crack belong to its left.
    upper = points[:, 1] > height - 1e-9
    apart = np.zeros((3, len(points)))
    apart[1] = np.where(upper, 1.0, -1.0)
    force = operator.matvec(apart.ravel())
    assert np.abs(force).max() < 1e-8 * np.abs(operator.bulk).max()


twentieths = st.integers(-9, 9).map(lambda k: k / 20)
fortieths = st.integers(-18, 18).map(lambda k: k / 40)


@st.composite
def networks(draw):
    """Cracks that cross, branch, meet, bend and run through particles, some through the plate."""
    place = st.tuples(st.one_of(twentieths, fortieths), st.one_of(twentieths, fortieths))
    points = draw(st.lists(place, min_size=4, max_size=6, unique=True))
    cracks = [Crack((-0.7, draw(fortieths)), points[0], (0.7, draw(fortieths)))]
    for _ in range(draw(st.integers(1, 3))):
        bend = draw(st.lists(st.sampled_from(points), min_size=2, max_size=4, unique=True))
        cracks.append(Crack(*bend, *bend[: draw(st.integers(0, 1))]))
    return cracks


def faces_of(region, cracks, lattice):
    """Which of the pieces that cracks leave of a region each particle belongs to."""
    shape = region.outline(lattice.spacing)
    lines = shapely.union_all([shape.boundary, *(shapely.LineString(c.points) for c in cracks)])
    pieces = shapely.get_parts(shapely.polygonize([shapely.node(lines)]))
    inside = [piece for piece in pieces if shape.contains(piece.representative_point())]
    # Particles on a crack belong to its upper side, of an upright one to its right.
    points = shapely.points(lattice.points + np.array([1e-9, 1e-5]))
    return np.argmin([shapely.distance(piece, points) for piece in inside], axis=0)


@exact
@given(networks(), st.booleans(), st.sampled_from([2, 3]), st.booleans())
def test_nothing_joins_what_cracks_part(cracks, hole, m, sharp_tips):
    region = rectangle(1.0, 1.0) - rectangle(0.33, 0.21) if hole else rectangle(1.0, 1.0)
    family = Family(m, 0.1)
    lattice = Lattice(region, 0.1, family.reach)
    try:
        bonds = Bonds(lattice, family, cracks, "extrapolated", sharp_tips=sharp_tips)
    except SceneError:
        return  # a crack that lies in the hole
    # Every bond that does not reach a neighbour ends somewhere.
    whole = (bonds.strengths_of(np.arange(lattice.count)) > 0).sum(axis=0)
    ended = np.bincount(bonds.ended.particle, minlength=lattice.count)
    np.testing.assert_array_equal(whole + ended, family.size)
    operator = BondOperator(bonds, calibrate(family, SOLID), np.zeros((3, lattice.count), bool))
    matrix, scale = to_csr(operator), np.abs(operator.bulk).max()
    assert abs(matrix - matrix.T).max() < 1e-11 * scale
    labels = faces_of(region, cracks, lattice)
    x, y = lattice.points.T
    for piece in np.unique(labels):
        mine = (labels == piece).astype(float)
        for u in ([mine, 0 * mine, 0 * mine], [-y * mine, x * mine, 0.1 * mine]):
            assert np.abs(matrix @ np.concatenate(u)).max() < 1e-9 * scale


@few
@given(networks(), st.randoms(use_true_random=False))
def test_how_cracks_are_drawn_does_not_matter(cracks, random):
    family = Family(2, 0.1)
    lattice = Lattice(rectangle(1.0, 1.0), 0.1, family.reach)
    pieces = [Crack(*piece[:: random.choice([1, -1])]) for c in cracks for piece in c.segments]
    random.shuffle(pieces)

    def matrix(cracks):
        bonds = Bonds(lattice, family, cracks, "extrapolated")
        none = np.zeros((3, lattice.count), dtype=bool)
        return to_csr(BondOperator(bonds, calibrate(family, SOLID), none))

    try:
        wanted, found = matrix(cracks), matrix(pieces)
    except SceneError:
        return  # a piece alone lies on the particles at the edge
    # Nodes are numbered by place: every bit is the same.
    assert abs(found - wanted).max() == 0.0
