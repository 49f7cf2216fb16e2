"""What is found in squares is what comparing all lines with all edges finds."""

import numpy as np
import pytest

from solver.geometry.faces import meet
from solver.geometry.meeting import Edges


def compared(start, way, first, last, low, high):
    """Pairs and places by comparing each with each."""
    k, e = (axis.ravel() for axis in np.indices((len(start), len(first))))
    position, share, valid = meet(start[k], way[k], first[e], last[e], low, high)
    return {
        (int(i), int(j)): (p, s)
        for i, j, p, s in zip(k[valid], e[valid], position[valid], share[valid], strict=True)
    }


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("between", [(0.0, 1.0), (-1.0, 0.0), (-1.0, 2.0)])
def test_random_lines_and_edges(seed, between):
    rng = np.random.default_rng(seed)
    first = rng.uniform(-3.0, 3.0, (60, 2)) * [1.0, 10.0**-seed]
    last = first + rng.normal(size=(60, 2)) * rng.choice([1e-3, 0.3, 2.0], (60, 1))
    start, way = rng.uniform(-4.0, 4.0, (80, 2)), rng.normal(size=(80, 2))
    # Some begin on an edge, end at a node, or run along one.
    start[:10] = 0.5 * (first[:10] + last[:10])
    way[10:20] = first[10:20] - start[10:20]
    start[20:30], way[20:30] = first[20:30], last[20:30] - first[20:30]
    edges = Edges(first, last)
    line, edge, position, share = edges.met_by(start, way, *between)
    assert (np.diff(line) >= 0).all()
    wanted = compared(start, way, first, last, *between)
    rows = zip(line.tolist(), edge.tolist(), position, share, strict=True)
    found = {(i, j): (p, s) for i, j, p, s in rows}
    assert len(found) == len(line), "each once"
    # Within TIE beyond an end a box may or may not reach.
    ends = {
        pair for pair, (p, s) in wanted.items()
        if not (0 <= p <= 1 and between[0] <= s <= between[1])
    }  # fmt: skip
    assert set(wanted) - ends <= set(found) <= set(wanted)
    assert all(found[pair] == wanted[pair] for pair in found)


def test_edges_of_one_square_and_lines_from_afar():
    first, last = np.array([[0.0, 0.0]]), np.array([[1.0, 0.0]])
    edges = Edges(first, last)
    start, way = np.array([[0.25, -1e6], [5.0, 5.0]]), np.array([[0.0, 2e6], [1.0, 1.0]])
    line, edge, position, share = edges.met_by(start, way)
    assert (line.tolist(), edge.tolist()) == ([0], [0])
    np.testing.assert_allclose([position[0], share[0]], [0.25, 0.5])
    assert not len(edges.met_by(start[:0], way[:0])[0])
