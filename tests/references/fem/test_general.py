"""Bodies of several solids under all that may act: homogeneous states, statics, other solvers."""

import numpy as np
import pytest

from references.fem.conduction import steady_conduction
from references.fem.elasticity import solve_elasticity
from references.fem.general import Acting, solve
from references.fem.mesh import rectangle
from references.fem.polygons import polygons

SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
LEFT = [(0.0, 0.0), (0.4, 0.0), (0.4, 1.0), (0.0, 1.0)]
RIGHT = [(0.4, 0.0), (1.0, 0.0), (1.0, 1.0), (0.4, 1.0)]
VOIGT = np.array([[2.0, 0.4, 0.1], [0.4, 1.5, 0.0], [0.1, 0.0, 0.6]])
D = np.array([[2.0, 0.5], [0.5, 1.0]])
POINTS = np.array([[0.21, 0.33], [0.77, 0.5], [0.5, 0.9]])


def solids(mesh, border=0.4):
    return (mesh.points[mesh.triangles].mean(axis=1)[:, 0] > border).astype(np.int64)


def at_left(nodes, edge):
    """u = 0 at x = 0 for its first component, and at one corner for the second."""
    held = np.full((len(nodes), 2), np.nan)
    left = edge & (nodes[:, 0] < 1e-9)
    held[left, 0] = 0.0
    held[left & (nodes[:, 1] < 1e-9), 1] = 0.0
    return held


def test_meshes_have_the_area_of_what_was_drawn_and_conform():
    mesh = polygons([(LEFT, []), (RIGHT, [])], 0.2)
    assert mesh.area == pytest.approx(1.0, rel=1e-12)
    assert len(np.unique(np.round(mesh.points, 9), axis=0)) == len(mesh.points)
    slit = [((5.0002, 5.0005), (5.0008, 5.0005))]
    far = polygons([(np.array(SQUARE) * 1e-3 + 5.0, [])], 2e-4, slit)
    assert far.area == pytest.approx(1e-6, rel=1e-6)
    assert len(far.tips) == 2
    assert {"edge", "crack"} == set(far.boundaries)
    hole = np.array([(0.6, 0.4), (0.8, 0.4), (0.7, 0.6)])
    for ring in (hole, hole[::-1]):  # drawn either way round
        cracked = polygons([(SQUARE, [ring])], 0.2, [((0.3, 1.0), (0.3, 0.5))])
        assert (cracked.area, len(cracked.tips)) == (pytest.approx(1 - 0.02), 1)
    with pytest.raises(ValueError, match="overlap"):
        polygons([(LEFT, []), (SQUARE, [])], 0.3)


def test_two_bars_in_a_row_stretch_as_springs_in_a_row():
    """σ11 = 1 in both; ν = 0 keeps the state homogeneous; half the thickness doubles the strain."""
    mesh = polygons([(LEFT, []), (RIGHT, [])], 0.3)
    tensors = np.array([np.diag([2.0, 2.0, 1.0]), np.diag([5.0, 5.0, 2.5])])
    pull = Acting(edge=[lambda x, y, n1, n2: np.stack([(x > 1 - 1e-9) * n1, 0 * y])])
    found = solve(mesh, tensors, solids(mesh), at_left, pull)
    wanted = np.where(POINTS[:, 0] < 0.4, POINTS[:, 0] / 2, 0.2 + (POINTS[:, 0] - 0.4) / 5)
    np.testing.assert_allclose(found.at(POINTS)[:, 0], wanted, atol=1e-12)
    np.testing.assert_allclose(found.flux_at(POINTS), [[1.0, 0, 0]] * 3, atol=1e-11)
    thin = solve(
        mesh, tensors, solids(mesh), at_left, pull, lambda x, y, s: np.where(s == 1, 0.5, 1.0)
    )
    # The traction acts on the right-hand part's half thickness.
    np.testing.assert_allclose(
        thin.flux_at(POINTS)[:, 0], np.where(POINTS[:, 0] < 0.4, 0.5, 1.0), atol=1e-11
    )


def test_it_is_the_solver_of_one_solid_where_there_is_one():
    mesh = rectangle(1.0, 1.0, 0.3)
    both = polygons([(np.array(SQUARE) - 0.5, [])], 0.3)
    force = lambda x, y: np.stack([1 + y, x], axis=-1)  # noqa: E731
    other = solve_elasticity(mesh, VOIGT, {"left": (0.0, 0.0)}, {"right": (1.0, 0.5)}, force)

    def held(nodes, edge):
        left = edge & (nodes[:, 0] < -0.5 + 1e-9)
        return np.where(left[:, None], 0.0, np.full((len(nodes), 2), np.nan))

    acting = Acting(
        volume=[lambda x, y: np.stack([1 + y, x])],
        edge=[lambda x, y, n1, n2: np.stack([n1 > 0.5, 0.5 * (n1 > 0.5)])],
    )
    found = solve(both, VOIGT[None], np.zeros(len(both.triangles), dtype=np.int64), held, acting)
    here = POINTS - 0.5
    # Two meshes: their own errors apart.
    np.testing.assert_allclose(found.at(here), other.at(here), rtol=2e-2)
    heat = steady_conduction(mesh, D, lambda x, y: x * y, source=2.0)
    mine = solve(
        both, D[None], np.zeros(len(both.triangles), dtype=np.int64),
        lambda nodes, edge: np.where(edge, nodes[:, 0] * nodes[:, 1], np.nan)[:, None],
        Acting(volume=[lambda x, y: 2.0 + 0 * x]),
    )  # fmt: skip
    np.testing.assert_allclose(mine.at(here), heat.at(here), atol=2e-3)
    np.testing.assert_allclose(mine.flux_at(here), heat.flux_at(here), atol=0.1)


def test_what_a_temperature_strains_has_no_stress_if_it_is_free():
    mesh = polygons([(SQUARE, [])], 0.4)
    one, expansion = np.zeros(len(mesh.triangles), dtype=np.int64), np.array([1e-3, 2e-3, 5e-4])

    def stress(change):
        strain = lambda x, y, s: np.multiply.outer(expansion, change(x, y))  # noqa: E731
        return solve(mesh, VOIGT[None], one, at_left, Acting(strain=strain)).flux_at(POINTS)

    assert np.abs(stress(lambda x, y: 1 + 0 * x)).max() < 1e-14
    # Not compatible: ∂²ε22/∂x² is not zero.
    assert np.abs(stress(lambda x, y: x**2)).max() > 1e-5


def test_forces_at_points_are_carried_whole():
    """The reaction at x = 0 is what acts: by the work of the unit displacement, ∫ σ11 dy."""
    mesh = polygons([(SQUARE, [])], 0.2)
    places, force = np.array([[0.7, 0.4], [0.9, 0.8]]), np.array([[1.0, 0.0], [2.0, 0.0]])
    one, tensor = np.zeros(len(mesh.triangles), dtype=np.int64), np.diag([2.0, 2.0, 1.0])
    found = solve(mesh, tensor[None], one, at_left, Acting(points=[(places, force)]))
    y = (np.arange(400) + 0.5) / 400
    section = found.flux_at(np.stack([np.full(400, 0.35), y], axis=1))[:, 0].mean()
    assert section == pytest.approx(3.0, rel=0.02)


def test_what_nothing_holds_is_refused():
    mesh = polygons([(SQUARE, [])], 0.5)
    one = np.zeros(len(mesh.triangles), dtype=np.int64)
    for tensor, size in ((VOIGT, 2), (D, 1)):
        with pytest.raises(ValueError, match=r"motion|temperature|rigid|constant"):
            solve(
                mesh, tensor[None], one, lambda n, e, c=size: np.full((len(n), c), np.nan), Acting()
            )


@pytest.mark.parametrize("size", [0.4, 0.2])
def test_what_is_spread_enters_whole_whatever_the_mesh_makes_of_its_rim(size):
    """A current into a disc of an element's size leaves through the left edge, all of it."""
    mesh = polygons([(SQUARE, [])], size)
    one = np.zeros(len(mesh.triangles), dtype=np.int64)

    def held(nodes, edge):
        return np.where(edge & (nodes[:, 0] < 1e-9), 0.0, np.nan)[:, None]

    def spread(radius):
        where = lambda x, y: np.hypot(x - 0.7, y - 0.5) < radius  # noqa: E731
        return solve(mesh, np.eye(2)[None], one, held, Acting(spread=[(where, 3.0)]))

    # φ = x is tested by any field: its work is that of what leaves, ∫ j·∇x = amount × mean x.
    found = spread(0.15)
    corners = mesh.points[mesh.triangles]
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    middles = [(corners[:, i] + corners[:, (i + 1) % 3]) / 2 for i in range(3)]
    # Linear in each triangle: its middles integrate it exactly.
    inward = sum(found.flux_at(0.999999 * p + 1e-6 * corners.mean(axis=1))[:, 0] for p in middles)
    assert (inward / 3 * area).sum() == pytest.approx(-3.0 * 0.7, rel=0.06)
    with pytest.raises(ValueError, match="no point of the mesh"):
        spread(1e-6)
