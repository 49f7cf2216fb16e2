"""Nodes of cracks that branch, cross, bend and run into edges: one for each sector of the body."""

import numpy as np
import pytest

from solver import Crack, rectangle
from solver.geometry import Outline

SQUARE = rectangle(1.0, 1.0)


def nodes_at(outline, point):
    """Number of nodes at a point."""
    return int((np.hypot(*(outline.nodes - point).T) < 1e-4).sum())


@pytest.mark.parametrize(
    ("cracks", "point", "count"),
    [
        ([((-0.3, 0.0), (0.3, 0.1))], (0.3, 0.1), 1),
        ([((-0.3, 0.0), (0.1, 0.0), (0.3, 0.2))], (0.1, 0.0), 2),
        ([((-0.3, 0.0), (0.3, 0.0)), ((0.1, 0.3), (0.1, 0.0))], (0.1, 0.0), 3),
        ([((-0.3, 0.0), (0.3, 0.0)), ((0.1, 0.3), (0.1, -0.3))], (0.1, 0.0), 4),
        ([((-0.5, 0.0), (0.3, 0.0))], (-0.5, 0.0), 2),
        ([((-0.49, 0.0), (0.3, 0.0))], (-0.5, 0.0), 2),
        # Two cracks that run into the edge at one place.
        ([((-0.7, 0.2), (-0.5, 0.0), (0.3, 0.1)), ((-0.5, 0.0), (0.3, -0.1))], (-0.5, 0.0), 3),
    ],
)
def test_one_node_for_each_sector(cracks, point, count):
    outline = Outline.of(SQUARE, [Crack(*crack) for crack in cracks], 0.05)
    assert nodes_at(outline, point) == count
    # Every node has one edge before it and one after it: the outline is closed.
    for end in (0, 1):
        assert len(np.unique(outline.edges[:, end])) == len(outline.edges) == len(outline.nodes)


def test_tips_that_may_grow_have_a_node_for_each_face():
    crack = [Crack((-0.3, 0.0), (0.3, 0.1))]
    assert nodes_at(Outline.of(SQUARE, crack, 0.05, sharp_tips=False), (0.3, 0.1)) == 2


def test_the_area_is_that_of_the_body_whatever_the_cracks():
    cracks = [Crack((-0.7, 0.1), (0.3, 0.1)), Crack((0.0, -0.7), (0.0, 0.4), (0.3, 0.1))]
    outline = Outline.of(SQUARE, cracks, 0.05)
    flow = np.einsum("ki,ki->k", outline.along(0.5), outline.outward) * outline.length
    # Both faces of a crack cancel.
    assert 0.5 * flow.sum() == pytest.approx(1.0)


def test_pieces_of_a_straight_crack_have_the_nodes_of_the_whole():
    whole = Outline.of(SQUARE, [Crack((-0.37, 0.0), (0.3, 0.1))], 0.05)
    middle = tuple(np.array((-0.37, 0.0)) + 0.3 * np.array((0.67, 0.1)))
    parts = [Crack(middle, (-0.37, 0.0)), Crack((0.3, 0.1), middle)]
    pieces = Outline.of(SQUARE, parts, 0.05)
    np.testing.assert_allclose(pieces.nodes, whole.nodes, atol=1e-6)
    np.testing.assert_array_equal(pieces.edges, whole.edges)
