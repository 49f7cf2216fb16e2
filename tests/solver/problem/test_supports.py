"""Supports: values of every kind, where they hold, and clear refusals."""

import numpy as np
import pytest

from solver import (
    ConductivityTensor,
    ElasticTensor,
    Load,
    Scene,
    SceneError,
    Support,
    disc,
    rectangle,
)
from solver.geometry import Lattice
from solver.problem.values import evaluate
from tests.solver.problem.squares import CONDUCTOR, HELD, SOLID, SQUARE, plate, wall


@pytest.mark.filterwarnings("error")
def test_functions_may_be_undefined_where_nobody_asks():
    points = np.array([[-1.0, 0.0], [4.0, 0.0]])
    found = evaluate(lambda x, y: np.where(x > 0, np.sqrt(x) / x, 0.0), points, 1, "a thing")
    np.testing.assert_array_equal(found, [[0.0], [0.5]])
    with pytest.raises(SceneError, match=r"a thing is not finite at x = \(-1, 0\)"):
        evaluate(lambda x, y: np.sqrt(x), points, 1, "a thing")
    parts = wall(Support.where(lambda x, y: np.log(x) > -1.2, temperature=1.0))
    assert parts.lattice.points[parts.prescribed[0], 0].min() > 0.3


def test_a_number_an_array_and_a_function_say_the_same():
    x, y = Lattice(SQUARE, 0.1, 2).points.T
    edge = np.minimum(0.5 - np.abs(x), 0.5 - np.abs(y)) < 0.1
    by_array = wall(Support.layer(1, temperature=2 * x[edge] + 1))
    by_function = wall(Support.layer(1, temperature=lambda x, y: 2 * x + 1))
    np.testing.assert_allclose(by_array.values, by_function.values, rtol=1e-15)
    np.testing.assert_array_equal(by_array.prescribed[0], edge)
    by_number = wall(Support.layer(1, temperature=3.0))
    np.testing.assert_array_equal(by_number.values, np.where(edge, 3.0, 0.0)[None])


def test_displacement_pairs_arrays_and_functions():
    pair = plate(Support.layer(1, displacement=(1.0, -2.0), rotation=0.5))
    edge = pair.prescribed[0]
    np.testing.assert_array_equal(pair.values[0, edge], 1.0)
    np.testing.assert_array_equal(pair.values[1, edge], -2.0)
    # Rotations are kept as θ Δx.
    np.testing.assert_allclose(pair.values[2, edge], 0.05)
    rows = np.column_stack([np.arange(edge.sum()), -np.arange(edge.sum())])
    array = plate(Support.layer(1, displacement=rows, rotation=0.0))
    np.testing.assert_array_equal(array.values[:2, edge], rows.T)
    function = plate(
        Support.layer(1, displacement=lambda x, y: np.stack([x, y], axis=-1), rotation=0.0)
    )
    np.testing.assert_array_equal(function.values[:2, edge], function.lattice.points[edge].T)


def test_rollers_hold_one_component():
    parts = plate(
        Support.where(lambda x, y: y < -0.4, u2=lambda x, y: x),
        Support.where(lambda x, y: x < -0.4, u1=0.0),
    )
    x, y = parts.lattice.points.T
    np.testing.assert_array_equal(parts.prescribed, [x < -0.4, y < -0.4, np.zeros(100, bool)])
    np.testing.assert_array_equal(parts.values[1], np.where(y < -0.4, x, 0.0))


def test_later_supports_win_where_they_overlap():
    parts = wall(
        Support.layer(1, temperature=1.0), Support.where(lambda x, y: x > 0, temperature=2.0)
    )
    x = parts.lattice.points[:, 0]
    np.testing.assert_array_equal(parts.values[0, x > 0], 2.0)
    edge = parts.lattice.edge_distance < 0.1
    np.testing.assert_array_equal(parts.values[0, edge & (x < 0)], 1.0)
    other = wall(
        Support.where(lambda x, y: x > 0, temperature=2.0), Support.layer(1, temperature=1.0)
    )
    np.testing.assert_array_equal(other.values[0, edge], 1.0)


def test_a_later_support_leaves_alone_what_it_does_not_name():
    parts = plate(HELD, Support.where(lambda x, y: x > 0.4, u1=0.3))
    right = parts.lattice.points[:, 0] > 0.4
    np.testing.assert_array_equal(parts.values[0, right], 0.3)
    np.testing.assert_array_equal(parts.values[1:, right], 0.0)
    assert parts.prescribed[:, right].all()


def test_a_region_selects_too():
    parts = wall(Support.where(disc(0.2), temperature=1.0))
    r = np.hypot(*parts.lattice.points.T)
    np.testing.assert_array_equal(parts.prescribed[0], r <= 0.2)


@pytest.mark.parametrize(("cells", "columns"), [(0.5, 1), (1, 1), (1.5, 2), (2.5, 3), (5.5, 5)])
@pytest.mark.parametrize("spacing", [0.1, 0.1 * 3e-7, 7.0])
def test_a_layer_reaches_its_depth_and_includes_the_tie(cells, columns, spacing):
    scene = Scene(
        region=rectangle(10 * spacing, 10 * spacing),
        spacing=spacing,
        m=2,
        material=CONDUCTOR,
        supports=[Support.layer(cells, temperature=1.0)],
    )
    inner = max(10 - 2 * columns, 0)
    assert scene.discretise().prescribed.sum() == 100 - inner**2


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Support.layer(0, temperature=1.0), "positive thickness"),
        (lambda: Support.layer(-2, temperature=1.0), "positive thickness"),
        (lambda: Support.layer(np.nan, temperature=1.0), "positive thickness"),
        (lambda: Support.layer(1), "prescribes nothing"),
        (lambda: Support.layer(1, displacement=0.0, u1=0.0), "either displacement or u1"),
    ],
)
def test_bad_supports(make, message):
    with pytest.raises(SceneError, match=message):
        make()


def test_a_support_of_the_other_physics():
    with pytest.raises(SceneError, match="elastic scene has no temperature"):
        plate(Support.layer(1, temperature=1.0))
    with pytest.raises(SceneError, match="conductive scene has no displacement, rotation"):
        wall(HELD)


def test_a_support_that_holds_nothing():
    with pytest.raises(SceneError, match="holds no particle"):
        wall(Support.where(lambda x, y: x > 9, temperature=1.0))
    with pytest.raises(SceneError, match="holds no particle"):
        wall(Support.layer(0.3, temperature=1.0))


@pytest.mark.parametrize("answer", [lambda x, y: x, lambda x, y: True, lambda x, y: x[:3] > 0])
def test_a_selection_is_one_boolean_a_particle(answer):
    with pytest.raises(SceneError, match="one boolean a particle"):
        wall(Support.where(answer, temperature=1.0))


@pytest.mark.parametrize("surface", ["none", "volume", "extrapolated"])
def test_who_is_held_is_decided_by_displacement_alone(surface):
    # ν = 1/3 has no rotations, ν just below has them free in the clamp.
    tips = []
    for nu in (1 / 3, 0.33333333):
        scene = Scene(
            rectangle(30, 10),
            1.0,
            ElasticTensor.isotropic(1.0, nu),
            [Support.where(lambda x, y: x < -10, displacement=0.0)],
            [Load.body_force((0.0, 1e-3), where=lambda x, y: x > 14)],
            m=3,
            surface=surface,
        )
        tips.append(scene.solve().displacement[:, 1].max())
    assert tips[1] == pytest.approx(tips[0], rel=1e-7)


def test_a_held_edge_conducts_a_linear_temperature_to_rounding():
    """Bonds that end at nodes of the right temperature leave every particle in balance."""

    def exact(x, y):
        return 1 + 2 * x - 3 * y

    solution = Scene(
        region=SQUARE - disc(0.2),
        spacing=0.041,
        m=3,
        surface="extrapolated",
        material=ConductivityTensor([[5, 2], [2, 1]]),
        supports=[Support.edge(temperature=exact)],
    ).solve(tolerance=1e-12)
    # The hole's polygon lies inside its circle: some bonds are a little shorter than they look.
    assert solution.temperature == pytest.approx(exact(*solution.points.T), abs=2e-3)
    assert solution.surface_temperature == pytest.approx(exact(*solution.surface_points.T))


def test_a_bar_held_at_its_edge_is_as_long_as_the_body():
    """Pulled by 1 Pa: u1 = (x + 1/2)/E from the edge on, not from the middle of a layer."""
    corner = Support.edge(lambda x, y: (x < -0.4999) & (y < -0.4999), u2=0.0)
    wall = Support.edge(lambda x, y: x < -0.4999, u1=0.0)
    pull = Load.stress((1.0, 0.0, 0.0), where=lambda x, y: x > 0.4999)
    scene = {"region": SQUARE, "m": 3, "surface": "extrapolated", "material": SOLID}
    errors = []
    for n in (10, 20):
        solution = Scene(spacing=1 / n, supports=[wall, corner], loads=[pull], **scene).solve()
        x, y = solution.points.T
        exact = np.column_stack([x + 0.5, -0.2 * (y + 0.5)])
        errors.append(np.abs(solution.displacement - exact).max())
        assert np.ptp(solution.surface_displacement[solution.surface_points[:, 0] < -0.49, 0]) == 0
    assert errors[1] < 3e-3
    assert errors[1] < 0.6 * errors[0]


@pytest.mark.parametrize(
    ("support", "surface", "words"),
    [
        (Support.edge(displacement=0.0), "volume", "no nodes to hold"),
        (Support.edge(lambda x, y: x > 9, displacement=0.0), "extrapolated", "holds no node"),
        (Support.edge(lambda x, y: x < -0.499, u1=0.0), "extrapolated", "translation along 2"),
        (Support.edge(temperature=0.0), "extrapolated", "no temperature"),
    ],
)
def test_edges_that_cannot_be_held_so(support, surface, words):
    with pytest.raises(SceneError, match=words):
        plate(support, surface=surface)
