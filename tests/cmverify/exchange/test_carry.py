"""Values between the points of an answer: exact for what the rule says, refused elsewhere."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import Delaunay

from cmverify.exchange.answers import Answer, AnswerError
from cmverify.exchange.carry import carry
from cmverify.exchange.statement import Target


def grid(n, low=-1.0, high=1.0):
    axis = low + (np.arange(n) + 0.5) * (high - low) / n
    return np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)


def target(points, times=None):
    shape = (len(points),) if times is None else (len(times), len(points))
    return Target("T", "T", "K", np.ones(shape), points=points, times=times)


WANTED = np.random.default_rng(3).uniform(-0.9, 0.9, (60, 2))
COEFFICIENTS = st.lists(st.floats(-2, 2), min_size=6, max_size=6)


@given(COEFFICIENTS)
@settings(max_examples=20, deadline=None)
def test_quadratics_pass_between_particles(c):
    def field(p):
        x, y = p.T
        return c[0] + c[1] * x + c[2] * y + c[3] * x * x + c[4] * x * y + c[5] * y * y

    points = grid(14)
    answer = Answer("mine", {"T": field(points)}, points)
    assert carry(answer, target(WANTED), 0.1) == pytest.approx(field(WANTED), abs=1e-9)


def test_linear_fields_pass_through_triangles_and_a_little_beyond():
    points = np.random.default_rng(5).uniform(-1, 1, (200, 2))
    triangles = Delaunay(points).simplices
    answer = Answer("mine", {"T": points @ [2.0, -1.0] + 3.0}, points, triangles.astype(np.int64))
    beyond = np.vstack([WANTED, points[points[:, 0].argmax()] + [0.01, 0.0]])
    assert carry(answer, target(beyond), 0.1) == pytest.approx(beyond @ [2.0, -1.0] + 3.0)


def test_what_is_there_is_taken_as_it_is():
    points = grid(6)
    values = np.random.default_rng(7).normal(size=len(points))
    answer = Answer("mine", {"T": values}, points)
    assert np.array_equal(carry(answer, target(points[::3]), 0.1), values[::3])


def test_nothing_crosses_a_crack():
    points = grid(20)
    above = points[:, 1] > 0
    answer = Answer("mine", {"T": np.where(above, 1.0, -1.0)}, points)
    wanted = np.array([[-0.52, 0.02], [-0.52, -0.02], [-0.33, 0.04]])
    crack = (((-1.1, 0.0), (0.0, 0.0)),)
    assert carry(answer, target(wanted), 0.1, crack) == pytest.approx([1.0, -1.0, 1.0])
    # Without the crack the two sides are mixed.
    assert abs(carry(answer, target(wanted), 0.1)[0]) < 0.9


def test_times_between_those_of_the_answer():
    points, times = grid(8), np.linspace(0.0, 2.0, 41)
    values = np.sin(times)[:, None] * (points @ [1.0, 2.0])
    answer = Answer("mine", {"T": values}, points, times=times)
    asked = np.linspace(0.03, 1.9, 7)
    found = carry(answer, target(WANTED[:5], asked), 0.1)
    assert found == pytest.approx(np.sin(asked)[:, None] * (WANTED[:5] @ [1.0, 2.0]), abs=1e-6)
    with pytest.raises(AnswerError, match="do not cover"):
        carry(answer, target(WANTED[:5], np.linspace(0.0, 2.5, 6)), 0.1)


def test_what_an_answer_does_not_reach_is_refused():
    points = grid(10)
    far = np.array([[0.0, 0.0], [3.0, 0.0]])
    with pytest.raises(AnswerError, match=r"nothing near \(3, 0\) and at 1 of"):
        carry(Answer("mine", {"T": points[:, 0]}, points), target(far), 0.1)
    triangles = Delaunay(points).simplices.astype(np.int64)
    with pytest.raises(AnswerError, match=r"nothing near \(3, 0\)"):
        carry(Answer("mine", {"T": points[:, 0]}, points, triangles), target(far), 0.1)
    line = np.column_stack([np.linspace(-1, 1, 30), np.zeros(30)])
    with pytest.raises(AnswerError, match="lie on a line"):
        carry(Answer("mine", {"T": line[:, 0]}, line), target(np.array([[0.01, 0.0]])), 0.1)


@given(st.sampled_from([1e3, 1e2 * 1.5, 25.4 * 100]), st.booleans(), st.integers(0, 99))
@settings(max_examples=20, deadline=None)
def test_millimetres_are_no_metres(factor, meshed, seed):
    """Twelve far points make a smooth guess of anything: nothing is taken from another unit."""
    points = np.random.default_rng(seed).uniform(-1, 1, (200, 2))
    triangles = Delaunay(points).simplices.astype(np.int64) if meshed else None
    answer = Answer("mine", {"T": points[:, 0]}, factor * points, triangles)
    with pytest.raises(AnswerError, match="are they in metres"):
        carry(answer, target(WANTED), 0.1)


@given(st.integers(0, 2**32 - 1), st.floats(1e-3, 10.0), st.booleans())
@settings(max_examples=20, deadline=None)
def test_two_values_at_one_place_are_refused(seed, change, there):
    rng = np.random.default_rng(seed)
    points = grid(6)
    values = rng.uniform(1.0, 2.0, len(points))
    twice = int(rng.integers(len(points)))
    order = rng.permutation(len(points) + 1)
    many = np.vstack([points, points[twice]])[order]
    wanted = target(points if there else 0.9 * points + 0.01)
    same = Answer("mine", {"T": np.append(values, values[twice])[order]}, many)
    carry(same, wanted, 0.1)
    other = Answer("mine", {"T": np.append(values, values[twice] + change)[order]}, many)
    with pytest.raises(AnswerError, match="two values at"):
        carry(other, wanted, 0.1)


def test_both_faces_of_a_slit_have_their_own_value():
    points = np.array(
        [[-1.0, 0], [0, 0], [1, 0], [-1, 1], [1, 1], [-1, -1], [1, -1], [-1, 0], [0, 0]]
    )
    above = [[3, 0, 1], [3, 1, 4], [4, 1, 2]]
    below = [[5, 8, 7], [5, 6, 8], [6, 2, 8]]
    values = np.array([1.0, 1, 0, 1, 1, -1, -1, -1, -1])
    answer = Answer("mine", {"T": values}, points, np.array(above + below))
    wanted = np.array([[-0.5, 0.2], [-0.5, -0.2]])
    assert carry(answer, target(wanted), 0.1) == pytest.approx([1.0, -1.0])
    with pytest.raises(AnswerError, match="two values at"):
        carry(answer, target(np.array([[-1.0, 0.0]])), 0.1)
