"""Modes of bodies of several solids, and of several parts."""

import numpy as np
import pytest

from references.fem.body import Body, of_solids
from references.fem.polygons import polygons
from references.fem.vibrations import vibrations

SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
VOIGT = np.array([[1.5, 0.5, 0.0], [0.5, 1.5, 0.0], [0.0, 0.0, 1.0]])


def nowhere(nodes, edge):
    return np.full((len(nodes), 2), np.nan)


def test_lames_mode_of_a_square_of_two_solids_that_are_one():
    """ω = π/L √((C11 − C12)/ρ) = π, and a solid of twice both stiffness and density."""
    left, right = SQUARE * [0.5, 1.0], SQUARE * [0.5, 1.0] + np.array([0.5, 0.0])
    mesh = polygons([(left, []), (right, [])], 0.12)
    solid = (mesh.points[mesh.triangles].mean(axis=1)[:, 0] > 0.5).astype(np.int64)
    body = Body(mesh, 2, solid)
    found = vibrations(body, of_solids([VOIGT, VOIGT]), [1.0, 1.0], nowhere, 5)
    assert found.rigid == 3
    k = int(np.abs(found.frequencies - np.pi).argmin())
    assert found.frequencies[k] == pytest.approx(np.pi, rel=1e-4)
    points = np.array([[0.3, 0.2], [0.7, 0.9], [0.5, 0.25]])
    u1, u2 = found.at(points)[k].T
    x, y = np.pi * points.T
    # Lamé's: u = (cos x sin y, −sin x cos y) up to a factor, here with free edges at 0 and 1.
    wanted = np.stack([np.cos(x) * np.sin(y), -np.sin(x) * np.cos(y)])
    factor = (u1 @ wanted[0] + u2 @ wanted[1]) / (wanted**2).sum()
    np.testing.assert_allclose([u1, u2], factor * wanted, atol=2e-3)
    heavy = vibrations(body, of_solids([VOIGT, VOIGT]), [4.0, 4.0], nowhere, 5)
    np.testing.assert_allclose(heavy.frequencies, 0.5 * found.frequencies, rtol=1e-9)
    stiff = vibrations(body, of_solids([VOIGT, 3 * VOIGT]), [1.0, 3.0], nowhere, 2).frequencies
    assert (stiff != found.frequencies[:2]).all()


def test_parts_that_nothing_holds_move_apart():
    mesh = polygons([(SQUARE, []), (SQUARE + np.array([2.0, 0.0]), [])], 0.5)
    body = Body(mesh, 2, np.zeros(len(mesh.triangles), dtype=np.int64))

    def left(nodes, edge):
        return np.where((edge & (nodes[:, 0] < 1e-9))[:, None], 0.0, nowhere(nodes, edge))

    given = of_solids(VOIGT[None])
    assert vibrations(body, given, [1.0], nowhere, 2).rigid == 6
    assert vibrations(body, given, [1.0], left, 2).rigid == 3
    with pytest.raises(ValueError, match="too many"):
        vibrations(body, given, [1.0], nowhere, 10**4)
