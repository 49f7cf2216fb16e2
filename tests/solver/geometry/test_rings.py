"""Rings that bonds and outline share: corners stay, curves are thinned."""

import numpy as np
import pytest
import shapely

from solver import disc, polygon, rectangle
from solver.geometry.rings import rings, thinned


def test_a_thin_slot_keeps_its_corners():
    slotted = rectangle(1.0, 1.0) - rectangle(0.001, 0.6, (0.0, 0.3))
    ((ring,),) = rings(slotted, 0.05)
    assert shapely.Polygon(ring).equals(slotted.outline(0.1))


@pytest.mark.parametrize("count", [40, 400, 4000])
def test_vertices_of_a_fine_curve_become_fewer(count):
    angle = 2 * np.pi * np.arange(count) / count
    fine = polygon(list(zip(np.cos(angle), np.sin(angle), strict=True)))
    ((ring,),) = rings(fine, 0.05)
    size = np.hypot(*(np.roll(ring, -1, axis=0) - ring).T)
    assert size.min() > 0.74 * 0.05
    assert shapely.Polygon(ring).area == pytest.approx(np.pi, rel=5e-3)


def test_a_fillet_smaller_than_a_cell_keeps_a_corner():
    angle = np.linspace(0, np.pi / 2, 30)
    fillet = np.column_stack([np.cos(angle), np.sin(angle)]) * 0.01 + 0.99
    ring = thinned(np.array([*fillet, (0.0, 1.0), (0.0, 0.0), (1.0, 0.0)]), 0.1)
    assert shapely.Polygon(ring).symmetric_difference(shapely.box(0, 0, 1, 1)).area < 3e-5
    assert len(ring) < 10


def test_bodies_and_holes_are_told_apart_and_turned():
    two = rectangle(4.0, 1.0) - rectangle(1.0, 2.0) - disc(0.2, (1.2, 0.0))
    found = rings(two, 0.1)
    assert sorted(len(body) for body in found) == [1, 2]
    for body in found:
        outer, *holes = map(shapely.LinearRing, body)
        assert outer.is_ccw
        assert not any(hole.is_ccw for hole in holes)


def test_faces_nearer_than_the_chords_of_a_curve_stay_apart():
    # A thin ring of fine polygons: thinned, its two curves would cross.
    angle = 2 * np.pi * np.arange(3000) / 3000
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    ring = polygon([tuple(p) for p in circle]) - polygon([tuple(0.9995 * p) for p in circle[::-1]])
    for body in rings(ring, 0.1):
        assert shapely.Polygon(body[0], body[1:]).is_valid
