"""Strains on the edge: exact on cubics, convergent round a hole and along a straight edge."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import (
    ConductivityTensor,
    Crack,
    ElasticTensor,
    Load,
    Scene,
    SceneError,
    Support,
    disc,
    recovery,
    rectangle,
)
from solver.solution import Solution
from tests.solver.bodies import DISC, few

NU = 0.2
SOLID = ElasticTensor.isotropic(1.0, NU)


def at(x0, y0):
    return lambda x, y: np.arange(len(x)) == np.argmin(np.hypot(x - x0, y - y0))


def held(x0):
    return [
        Support.where(at(-x0, 0.0), displacement=0.0),
        Support.where(at(x0, 0.0), u2=0.0),
    ]


def kirsch(x, y, radius=0.2):
    """Stress (..., 3) of an infinite plate with a hole under unit tension along axis 1."""
    r, t = np.hypot(x, y), np.arctan2(y, x)
    a = (radius / np.maximum(r, radius)) ** 2
    radial = 0.5 * (1 - a) + 0.5 * (1 - 4 * a + 3 * a * a) * np.cos(2 * t)
    hoop = 0.5 * (1 + a) - 0.5 * (1 + 3 * a * a) * np.cos(2 * t)
    shear = -0.5 * (1 + 2 * a - 3 * a * a) * np.sin(2 * t)
    c, s = np.cos(t), np.sin(t)
    return np.stack(
        [
            c * c * radial + s * s * hoop - 2 * c * s * shear,
            s * s * radial + c * c * hoop + 2 * c * s * shear,
            c * s * (radial - hoop) + (c * c - s * s) * shear,
        ],
        axis=-1,
    )


def holed(n, scale=1.0):
    def outer(x, y):
        return np.hypot(x, y) > 0.45

    return Scene(
        rectangle(1.0, 1.0) - disc(0.2),
        1 / n,
        SOLID,
        held(0.35),
        [Load.stress(lambda x, y: scale * kirsch(x, y), where=outer)],
        m=3,
        surface="extrapolated",
    ).solve()


def edge_errors(solution):
    """Errors of the hoop strain round the hole, and of all strains along a straight edge."""
    angle = np.radians(np.arange(2.5, 360.0, 15.0))
    along = np.column_stack([-np.sin(angle), np.cos(angle)])
    found = recovery.edge_strain(solution, 0.2 * along[:, ::-1] * [1, -1])
    hoop = np.einsum("ki,kij,kj->k", along, found, along)
    exact = 1.0 - 2.0 * np.cos(2 * angle)
    y = np.linspace(-0.45, 0.45, 13)
    places = np.column_stack([np.full_like(y, 0.5), y])
    strain = recovery.edge_strain(solution, places)
    wanted = kirsch(*places.T) @ np.linalg.inv(SOLID.voigt)
    straight = np.stack([strain[:, 0, 0], strain[:, 1, 1], 2 * strain[:, 0, 1]], axis=1)
    return [
        np.linalg.norm(one - other) / np.linalg.norm(other)
        for one, other in ((hoop, exact), (straight, wanted))
    ]


def test_strains_along_curved_and_straight_edges_converge():
    # Measured 7.8 and 1.9 % at 40 cells, 2.4 and 0.75 % at 80.
    coarse, fine = (edge_errors(holed(n)) for n in (40, 80))
    assert fine[0] < 3e-2
    assert fine[1] < 1e-2
    for one, other in zip(coarse, fine, strict=True):
        assert 0.7 < np.log2(one / other) < 2.5
    assert min(edge_errors(holed(80, scale=1.1))) > 5e-2


def imposed(scene, *fields):
    """A solution with given fields at the particles."""
    return Solution(scene.discretise(), np.array(fields), scene.solve().statistics)


@few
@given(st.lists(st.floats(-1, 1), min_size=20, max_size=20), st.floats(0, 6.28))
def test_exact_for_cubics(coefficients, angle):
    # A body wholly held has no nodes on its edge: particles alone know the field.
    region = rectangle(1.0, 0.8) - disc(0.15)
    everywhere = Support.where(lambda x, y: x == x, displacement=0.0, rotation=0.0)
    scene = Scene(region, 0.05, SOLID, [everywhere], m=3, surface="extrapolated")
    powers = [(i, k - i) for k in range(4) for i in range(k + 1)]
    one, two = np.reshape(coefficients, (2, 10))
    x, y = scene.discretise().lattice.points.T

    def field(c, x, y):
        return sum(a * x**i * y**j for a, (i, j) in zip(c, powers, strict=True))

    def slope(c, x, y):
        dx = sum(a * i * x ** max(i - 1, 0) * y**j for a, (i, j) in zip(c, powers, strict=True))
        dy = sum(a * j * x**i * y ** max(j - 1, 0) for a, (i, j) in zip(c, powers, strict=True))
        return dx, dy

    solution = imposed(scene, field(one, x, y), field(two, x, y), 0 * x)
    places = np.array([[0.15 * np.cos(angle), 0.15 * np.sin(angle)], [0.5, 0.1], [0.31, 0.22]])
    found = recovery.edge_gradient(solution, places)
    for k, place in enumerate(places):
        expected = [slope(one, *place), slope(two, *place)]
        np.testing.assert_allclose(found[k], expected, atol=1e-9)


def test_a_temperature_s_gradient():
    scene = Scene(
        rectangle(1.0, 0.5, angle=0.3),
        0.04,
        ConductivityTensor(DISC),
        [Support.where(at(0.0, 0.0), temperature=0.0)],
        [Load.flux((1.0, 0.5))],
        m=3,
        surface="extrapolated",
    )
    corner = np.array([[np.cos(0.3), np.sin(0.3)], [-np.sin(0.3), np.cos(0.3)]])
    places = np.array([[0.5, 0.0], [0.2, 0.25], [-0.3, -0.25]]) @ corner
    found = recovery.edge_gradient(scene.solve(), places)
    assert found.shape == (3, 1, 2)
    wanted = -np.linalg.solve(DISC, [1.0, 0.5])
    assert np.abs(found[:, 0] - wanted).max() < 0.03 * np.linalg.norm(wanted)


@pytest.mark.parametrize("slot", [False, True])
def test_what_a_crack_or_slot_hides_is_not_seen(slot):
    # Two halves that only touch along their grips: each strained alone, in opposite directions.
    region, cracks = rectangle(2.0, 1.0), [Crack((-0.8, 0.0), (0.8, 0.0))]
    if slot:
        region, cracks = region - rectangle(1.6, 0.01), []

    def everything(x, y):
        return x == x

    hold = [Support.where(everything, displacement=0.0, rotation=0.0)]
    scene = Scene(region, 0.05, SOLID, hold, cracks=cracks, m=3, surface="extrapolated")
    x, y = scene.discretise().lattice.points.T
    solution = imposed(scene, np.where(y > 0, 0.1, -0.1) * x, 0 * x, 0 * x)
    height = 0.005 if slot else 0.02
    found = recovery.edge_strain(solution, [(0.1, height), (0.1, -height)])
    np.testing.assert_allclose(found[:, 0, 0], [0.1, -0.1], atol=1e-9)
    np.testing.assert_allclose(found[:, 1, 1], 0.0, atol=1e-9)


def test_what_cannot_be_asked():
    solution = holed(20)
    for places, said in (
        ([(0.0, 0.0)], "outside the body"),
        ([(3.0, 0.0)], "outside the body"),
        ([0.5, 0.0], "finite points"),
        ([(0.5, np.nan)], "finite points"),
    ):
        with pytest.raises(SceneError, match=said):
            recovery.edge_gradient(solution, places)
    with pytest.raises(SceneError, match="positive radius"):
        recovery.edge_gradient(solution, [(0.5, 0.0)], window=0.0)
    with pytest.raises(SceneError, match=r"sees \d particles"):
        recovery.edge_gradient(solution, [(0.5, 0.0)], window=0.01)
    pulled = Scene(
        rectangle(1.0, 1.0),
        0.05,
        SOLID,
        [Support.where(lambda x, y: y < -0.3, displacement=0.0)],
        [Load.body_force((0.0, 1.0))],
        m=3,
        cracks=[Crack((-0.2, 0.0), (0.2, 0.0))],
        surface="extrapolated",
    )
    with pytest.raises(SceneError, match="lies on a crack"):
        recovery.edge_strain(pulled.solve(), [(0.1, 0.0)])
    warm = Scene(
        rectangle(1.0, 1.0),
        0.05,
        ConductivityTensor(DISC),
        [Support.where(lambda x, y: x < -0.3, temperature=0.0)],
        m=3,
        surface="volume",
    ).solve()
    assert recovery.edge_gradient(warm, [(0.0, 0.0)]).shape == (1, 1, 2)
    with pytest.raises(SceneError, match="surface='volume' strains a skin"):
        recovery.edge_gradient(warm, [(0.5, 0.0)])
    with pytest.raises(TypeError, match="elasticity only"):
        recovery.edge_strain(warm, [(0.0, 0.0)])
