"""The body's surface: areas, sides, mouths and tips of cracks, and where bonds leave the body."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from solver import Crack, SceneError, disc, polygon, rectangle
from solver.geometry import Outline, Region
from tests.solver.bodies import exact


def area(outline, kind=0):
    """By the divergence theorem: ½ ∮ x·n ds over the edges of one kind."""
    edges = outline.face == kind
    middle = outline.along(0.5)[edges]
    flow = np.einsum("ki,ki->k", middle, outline.outward[edges])
    return 0.5 * (flow * outline.length[edges]).sum()


def pieces(outline):
    """Connected chains of edges."""
    i, j = outline.edges.T
    size = len(outline.nodes)
    graph = sparse.coo_array((np.ones(len(i)), (i, j)), shape=(size, size))
    count, labels = connected_components(graph, directed=False)
    return count, labels


@exact
@given(st.floats(0, 1.5), st.floats(0.03, 0.2))
def test_area_and_perimeter_of_a_turned_rectangle(angle, spacing):
    outline = Outline.of(rectangle(1.0, 0.6, (0.2, -0.1), angle), [], spacing)
    assert area(outline) == pytest.approx(0.6, rel=1e-12)
    assert outline.length.sum() == pytest.approx(3.2, rel=1e-12)


@exact
@given(st.floats(0.01, 0.05))
def test_a_hole_is_an_edge_that_turns_the_other_way(spacing):
    outline = Outline.of(rectangle(1.0, 1.0) - disc(0.2), [], spacing)
    # A polygon of 24 corners has 98.9 % of its circle's area, one of more corners more.
    assert 1 - np.pi * 0.04 <= area(outline) <= 1 - 0.988 * np.pi * 0.04
    assert pieces(outline)[0] == 2
    near = np.hypot(*outline.along(0.5).T) < 0.3
    inwards = np.einsum("ki,ki->k", outline.along(0.5), outline.outward)
    assert (inwards[near] < 0).all()
    assert (inwards[~near] > 0).all()


def test_faces_of_a_crack_meet_at_its_tips_only():
    crack = Crack((-0.2, 0.0), (0.2, 0.1))
    for joined, chains, shared in ((True, 2, 2), (False, 3, 0)):
        outline = Outline.of(rectangle(1.0, 1.0), [crack], 0.05, joined)
        assert pieces(outline)[0] == chains
        faces = [set(outline.edges[outline.face == kind].ravel()) for kind in (1, 2)]
        assert len(faces[0] & faces[1]) == shared
        left, right = (outline.outward[outline.face == kind] for kind in (1, 2))
        assert (left[:, 1] < 0).all()
        assert (right[:, 1] > 0).all()


def test_a_closed_crack_has_two_separate_faces():
    crack = Crack((0.2, 0.0), (0.0, 0.2), (-0.2, 0.0), (0.2, 0.0))
    outline = Outline.of(rectangle(1.0, 1.0), [crack], 0.05)
    assert pieces(outline)[0] == 3
    # Both faces bound the triangle, from inside and from outside.
    _, labels = pieces(outline)
    chains = [outline.edges[:, 0][labels[outline.edges[:, 0]] == k] for k in range(3)]
    middle = outline.along(0.5)
    flow = 0.5 * np.einsum("ki,ki->k", middle, outline.outward) * outline.length
    areas = [flow[np.isin(outline.edges[:, 0], chain)].sum() for chain in chains]
    np.testing.assert_allclose(sorted(areas), [-0.04, 0.04, 1.0], rtol=1e-5)


@pytest.mark.parametrize("mouth", [-0.6, -0.51])
@pytest.mark.parametrize("height", [0.0, 0.013, 0.024])
def test_a_crack_that_runs_into_the_edge_opens_it(mouth, height):
    through = Outline.of(rectangle(1.0, 1.0), [Crack((mouth, height), (0.6, height))], 0.02)
    _, labels = pieces(through)
    ring = np.unique(through.edges[through.face == 0])
    # Upper and lower half.
    assert len(np.unique(labels[ring])) == 2
    assert area(through) == pytest.approx(1.0)
    edge = Outline.of(rectangle(1.0, 1.0), [Crack((mouth, height), (0.1, height))], 0.02)
    assert len(np.unique(pieces(edge)[1][np.unique(edge.edges[edge.face == 0])])) == 1


def test_where_bonds_leave_a_square():
    outline = Outline.of(rectangle(1.0, 1.0), [], 0.1)
    start = np.array([[0.45, 0.0], [0.45, 0.05], [0.4, 0.45], [0.5, 0.0]])
    bond = np.array([[0.2, 0.0], [0.2, 0.1], [0.0, 0.1], [0.1, 0.0]])
    edge, position, share = outline.first_hit(start, bond)
    met = outline.nodes[outline.edges[edge, 0]] * (1 - position)[:, None]
    met += outline.nodes[outline.edges[edge, 1]] * position[:, None]
    np.testing.assert_allclose(share, [0.25, 0.25, 0.5, 0.0], atol=1e-12)
    np.testing.assert_allclose(met, start + share[:, None] * bond, atol=1e-12)


def test_bonds_end_at_the_face_they_see():
    outline = Outline.of(rectangle(1.0, 1.0), [Crack((-0.2, 0.0), (0.2, 0.0))], 0.05)
    start = np.array([[0.0, 0.05], [0.0, -0.05], [0.0, 0.0]])
    bond = np.array([[0.0, -0.1], [0.0, 0.1], [0.0, -0.1]])
    edge, _, share = outline.first_hit(start, bond)
    # A particle on the crack's line belongs to its left.
    np.testing.assert_array_equal(outline.face[edge], [1, 2, 1])
    np.testing.assert_allclose(share, [0.5, 0.5, 0.0], atol=1e-12)


def test_slivers_between_a_circle_and_its_chords():
    outline = Outline.of(disc(1.0), [], 0.1)
    middle = outline.along(0.5)[0]
    outwards = outline.outward[0]
    # The particle beyond the chord: its bond ends just before it starts.
    _, _, share = outline.first_hit((middle + 1e-4 * outwards)[None], 0.2 * outwards[None])
    assert share == pytest.approx(-5e-4)
    # One that goes inwards through the chord and leaves on the other side does not end there.
    _, _, share = outline.first_hit((middle + 1e-4 * outwards)[None], -3.0 * outwards[None])
    assert share > 0.5
    # The neighbour beyond the hole's circle, but not beyond its chord: a little more than whole.
    hole = Outline.of(rectangle(4.0, 4.0) - disc(1.0), [], 0.1)
    chord = int(np.argmin(np.hypot(*(hole.along(0.5) - middle).T)))
    across = hole.outward[[chord]]
    end = hole.along(0.5)[[chord]] - 1e-4 * across
    _, _, share = hole.first_hit(end - 0.2 * across, 0.2 * across)
    assert share == pytest.approx(1 + 5e-4)


def test_corners_are_those_that_stick_out():
    notched = polygon([(0, 0), (1, 0), (1, 1), (0.5, 0.4), (0, 1)])
    corners = Outline.of(notched, [], 0.05).corners(0.2)
    np.testing.assert_allclose(
        sorted(map(tuple, corners)), [(0, 0), (0, 1), (1, 0), (1, 1)], atol=1e-12
    )
    assert len(Outline.of(disc(1.0), [], 0.01).corners(0.2)) == 0


def test_a_region_without_an_outline_says_so():
    class Blob(Region):
        bounds = (0.0, 0.0, 1.0, 1.0)

        def contains(self, x, y):
            return x * y < 0.2

        def edge_distance(self, x, y):
            return x

    with pytest.raises(SceneError, match="Blob has no outline"):
        Outline.of(Blob(), [], 0.1)


@pytest.mark.parametrize(("rise", "oblique"), [(9.0, True), (0.3, False), (0.0, False)])
def test_nodes_on_an_oblique_face_are_close_beside_its_tips_only(rise, oblique):
    crack = Crack((-10.2, -0.5 * rise), (10.2, 0.5 * rise))
    outline = Outline.of(rectangle(60.0, 60.0), [crack], 1.0)
    for kind in (1, 2):
        edges = outline.face == kind
        middle, length = outline.along(0.5)[edges], outline.length[edges]
        from_tip = np.hypot(10.2, 0.5 * rise) - np.hypot(*middle.T)
        assert length.sum() == pytest.approx(np.hypot(20.4, rise))
        assert (length[from_tip < 3.0] <= 1.0 + 1e-9).all()
        far = length[from_tip > 3.0]
        assert ((far > 1.5) & (far <= 2.5)).all() if oblique else (far <= 1.0 + 1e-9).all()
