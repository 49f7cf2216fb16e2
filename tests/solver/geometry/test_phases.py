"""Phases: who belongs to which, and interfaces whose nodes both sides share."""

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from solver import Crack, SceneError, disc, rectangle
from solver.geometry import Lattice, Phases, polygon
from solver.geometry.outline import INNER
from solver.geometry.phases import moved
from tests.solver.bodies import few

BODY = rectangle(2.0, 1.4)
place = st.floats(-0.7, 0.7)


def phases(*inclusions, spacing=0.1, body=BODY):
    lattice = Lattice(body, spacing, 3).centred
    x, y = lattice.shift
    return Phases(lattice, moved(inclusions, (-x, -y), lattice.grid))


def interface_lengths(outline):
    """Length (m) of the interface between each pair of phases, by their numbers."""
    inner = np.nonzero(outline.face == INNER)[0]
    ends = outline.shared[outline.edges[inner]]
    owner = {(int(a), int(b)): int(p) for (a, b), p in zip(ends, outline.phase[inner], strict=True)}
    found = {}
    for (a, b), length in zip(ends, outline.length[inner], strict=True):
        one, other = owner[int(a), int(b)], owner[int(b), int(a)]
        if one < other:
            found[one, other] = found.get((one, other), 0.0) + float(length)
    return found


@st.composite
def shapes(draw):
    """A disc or a turned rectangle, in the body, across its edge or flush with it."""
    centre = draw(place), draw(place)
    kind = draw(st.sampled_from(["disc", "turned", "flush"]))
    if kind == "disc":
        return disc(draw(st.floats(0.25, 0.5)), centre)
    if kind == "turned":
        return rectangle(draw(st.floats(0.3, 1.0)), 0.4, centre, draw(st.floats(0, 3)))
    return rectangle(0.6, 1.4, (centre[0], 0.0))


@few
@given(shapes(), shapes())
def test_phases_cover_the_body_and_share_their_interfaces(one, other):
    try:
        found = phases(one, other)
    except SceneError:
        assume(False)
    area = [region.shape.area for region in found.regions]
    # Chords of the discs are the same from both sides.
    assert sum(area) == pytest.approx(2.0 * 1.4, rel=1e-9)
    for a, b in ((0, 1), (0, 2), (1, 2)):
        common = found.regions[a].shape.intersection(found.regions[b].shape)
        assert common.area < 1e-6 * 0.1
    outline = found.outline()
    inner = outline.face == INNER
    ends = outline.shared[outline.edges[inner]]
    pairs = {tuple(pair) for pair in ends}
    assert {(b, a) for a, b in pairs} == pairs
    # What is no interface is the body's own edge, all of it.
    own = ~inner
    assert outline.length[own].sum() == pytest.approx(2 * (2.0 + 1.4), rel=1e-6)
    lengths = interface_lengths(outline)
    assert sum(lengths.values()) == pytest.approx(0.5 * outline.length[inner].sum())
    np.testing.assert_allclose(outline.nodes, outline.nodes[outline.shared], atol=1e-6)


def test_the_last_inclusion_wins_and_owns_its_edge():
    found = phases(rectangle(1.0, 2.0, (0.5, 0.0)), disc(0.3))
    x, y = found.lattice.points.T
    inside = np.hypot(x, y) <= 0.3 * (1 + 1e-9)
    np.testing.assert_array_equal(found.of == 2, inside)
    np.testing.assert_array_equal(found.of == 1, ~inside & (x > 0) & (x < 1))
    # Centres on the interface.
    edge = phases(rectangle(1.05, 2.0, (0.475, 0.0)))
    x = edge.lattice.points[:, 0]
    np.testing.assert_array_equal(edge.of, (x > -0.06).astype(int))


def test_three_phases_meet_in_a_point():
    outline = phases(rectangle(2.0, 0.7, (0.0, 0.35)), rectangle(1.0, 0.7, (0.5, -0.35))).outline()
    at = np.hypot(*outline.nodes.T) < 1e-9
    assert at.sum() == 3
    assert len(np.unique(outline.shared[at])) == 1
    lengths = interface_lengths(outline)
    assert lengths == {
        (0, 1): pytest.approx(1.0),
        (0, 2): pytest.approx(0.7),
        (1, 2): pytest.approx(1.0),
    }


def test_flush_edges_leave_no_sliver():
    """An inclusion drawn as far as the body's edge, in thirds that no float holds."""
    body = rectangle(1.2, 0.9, (1 / 3, 1 / 7))
    inclusion = rectangle(0.4, 0.9, (1 / 3 - 0.4, 1 / 7))
    found = phases(inclusion, spacing=0.1, body=body)
    assert [len(shapely.get_parts(r.shape)) for r in found.regions] == [1, 1]
    assert interface_lengths(found.outline()) == {(0, 1): pytest.approx(0.9)}


@pytest.mark.parametrize(
    ("inclusion", "message"),
    [
        (disc(0.2, (5.0, 0.0)), "inclusion 1 holds no particle"),
        (rectangle(0.02, 2.0), "inclusion 1 holds no particle"),
        (rectangle(9.0, 9.0), "the body beside its inclusions holds no particle"),
    ],
)
def test_phases_without_particles_are_refused(inclusion, message):
    with pytest.raises(SceneError, match=message):
        phases(inclusion)


def test_cracks_keep_clear_of_interfaces():
    found = phases(disc(0.3))
    assert (found.outline([Crack((0.5, 0.0), (2.0, 0.0))]).face == 1).any()
    for crack in (Crack((0.0, 0.0), (0.5, 0.0)), Crack((0.35, 0.0), (0.8, 0.0))):
        with pytest.raises(SceneError, match="within a cell of an interface"):
            found.outline([crack])


def test_a_polygon_that_ends_on_an_edge_of_another():
    """Corners of one lie on edges of the other, which has none there."""
    wedge = polygon([(-0.3, -0.1), (0.3, -0.1), (0.0, 0.5)])
    below = rectangle(1.6, 0.4, (0.0, -0.3))
    outline = phases(wedge, below).outline()
    assert interface_lengths(outline)[1, 2] == pytest.approx(0.6)
