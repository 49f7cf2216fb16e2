"""Points on edges: lengths, outward normals, closed contours, parts of edges."""

import numpy as np
import pytest

from solver import SceneError, disc, rectangle
from solver.geometry import Outline, Quadrature

SQUARE = Outline.of(rectangle(2.0, 1.0), (), 0.1)


def test_weights_are_the_length_of_the_edge():
    assert Quadrature.over(SQUARE).weight.sum() == pytest.approx(6.0, rel=1e-12)
    round_ = Quadrature.over(Outline.of(disc(1.0) - disc(0.5), (), 0.05))
    assert round_.weight.sum() == pytest.approx(3 * np.pi, rel=5e-3)


@pytest.mark.parametrize(
    ("region", "area"),
    [(rectangle(2.0, 1.0, angle=0.3), 2.0), (disc(1.0) - disc(0.4), 0.84 * np.pi)],
)
def test_normals_point_outwards_and_close(region, area):
    """∮ n ds = 0 and ½ ∮ x·n ds is the area (Gauss)."""
    rule = Quadrature.over(Outline.of(region, (), 0.05))
    np.testing.assert_allclose(rule.weight @ rule.normals, 0.0, atol=1e-12)
    found = 0.5 * rule.weight @ np.sum(rule.points * rule.normals, axis=1)
    assert found == pytest.approx(area, rel=5e-3)
    outside = rule.points + 0.05 * rule.normals
    assert not region.contains(*outside.T).any()


def test_a_part_of_the_edge():
    right = Quadrature.over(SQUARE, lambda x, y: x > 0.5)
    assert right.weight.sum() == pytest.approx(2.0, rel=2e-2)
    assert (right.points[:, 0] >= 0.5 - 1e-9).all()
    half = Quadrature.between(SQUARE, np.array([1.0, 0.0]), np.array([1.0, 0.5]))
    assert half.weight.sum() == pytest.approx(0.5, rel=1e-12)
    backwards = Quadrature.between(SQUARE, np.array([1.0, 0.5]), np.array([1.0, 0.0]))
    assert backwards.weight.sum() == pytest.approx(0.5, rel=1e-12)
    assert not len(Quadrature.between(SQUARE, np.array([0.0, 0.0]), np.array([0.0, 0.4])))


def test_force_is_density_times_length():
    rule = Quadrature.over(SQUARE)
    loaded = rule.carrying(rule.normals)
    np.testing.assert_allclose(loaded.force, rule.weight[:, None] * rule.normals)
    assert rule.density.shape == (len(rule), 0)


def test_selections_are_checked():
    with pytest.raises(SceneError, match="acts nowhere"):
        Quadrature.over(SQUARE, lambda x, y: x > 9.0)
    with pytest.raises(SceneError, match="one boolean a point"):
        Quadrature.over(SQUARE, lambda x, y: x)
