"""Supports and loads: values of every kind, resultants, and clear refusals."""

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
    polygon,
    rectangle,
)
from solver.geometry import Lattice
from solver.problem.conditions import evaluate
from tests.solver.bodies import exact

SQUARE = rectangle(1.0, 1.0)
SOLID, CONDUCTOR = ElasticTensor.isotropic(1.0, 0.2), ConductivityTensor.isotropic(1.0)
HELD = Support.layer(1, displacement=0.0, rotation=0.0)


def plate(*supports, loads=(), material=SOLID, **options):
    return Scene(
        region=SQUARE,
        spacing=0.1,
        m=2,
        material=material,
        supports=supports,
        loads=loads,
        **options,
    ).discretise()


def wall(*supports):
    return plate(*supports, material=CONDUCTOR)


# ---- values -------------------------------------------------------------------------------------


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
    ("value", "components", "message"),
    [
        (np.ones(3), 1, "needs one value a particle for 5 particles"),
        (np.ones((5, 3)), 2, "needs 2 values a particle for 5 particles"),
        (lambda x, y: np.stack([x, y]), 2, "needs 2 values"),
        (np.nan, 1, "is not finite at x = "),
        (lambda x, y: np.where(x > 2.5, np.inf, 0.0), 1, r"is not finite at x = \(3, "),
        (["a"] * 5, 1, "needs one value"),
        (lambda x, y: None, 1, "needs one value|not finite"),
        (1j, 1, "needs one value"),
    ],
)
def test_values_that_do_not_fit(value, components, message):
    points = np.column_stack([np.arange(5.0), np.zeros(5)])
    with pytest.raises(SceneError, match=message):
        evaluate(value, points, components, "a thing")


@pytest.mark.filterwarnings("error")
def test_functions_may_be_undefined_where_nobody_asks():
    points = np.array([[-1.0, 0.0], [4.0, 0.0]])
    found = evaluate(lambda x, y: np.where(x > 0, np.sqrt(x) / x, 0.0), points, 1, "a thing")
    np.testing.assert_array_equal(found, [[0.0], [0.5]])
    with pytest.raises(SceneError, match=r"a thing is not finite at x = \(-1, 0\)"):
        evaluate(lambda x, y: np.sqrt(x), points, 1, "a thing")
    parts = wall(Support.where(lambda x, y: np.log(x) > -1.2, temperature=1.0))
    assert parts.lattice.points[parts.prescribed[0], 0].min() > 0.3


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


# ---- loads --------------------------------------------------------------------------------------


def resultant(parts, component):
    """Force of an edge's load: on particles, or on the surface's nodes."""
    carried = parts.load[component].sum()
    if parts.nodal_load is not None:
        carried += parts.nodal_load[component].sum()
    return carried * parts.family.cell_area


treatments = st.sampled_from(["none", "volume", "extrapolated"])
LEFT = Support.where(lambda x, y: x < -0.2, displacement=0.0)


# Loads whose squares are no numbers are refused, see `test_discretisation`.
tractions = st.floats(-3, 3).filter(lambda t: t == 0.0 or abs(t) > 1e-30)


@exact
@given(tractions, tractions, treatments)
def test_traction_has_its_resultant_on_an_aligned_edge(t1, t2, surface):
    edge = Load.traction((t1, t2), (0.5, -0.5), (0.5, 0.5))
    parts = plate(LEFT, loads=[edge], surface=surface)
    assert resultant(parts, 0) == pytest.approx(t1, abs=1e-13)
    assert resultant(parts, 1) == pytest.approx(t2, abs=1e-13)
    loaded = np.abs(parts.load[:2]).sum(axis=0) > 0
    assert parts.lattice.points[loaded, 0].min(initial=1) > 0.4
    assert loaded.any() == (surface != "extrapolated" and (t1 != 0 or t2 != 0))


@exact
@given(st.floats(0.1, 1.4), treatments)
def test_traction_has_its_resultant_on_a_slanted_edge(angle, surface):
    c, s = np.cos(angle), np.sin(angle)
    corners = [(0.0, 0.0), (c, s), (c - s, s + c), (-s, c)]
    scene = Scene(
        region=polygon(corners),
        spacing=0.03,
        m=2,
        material=SOLID,
        surface=surface,
        supports=[Support.where(lambda x, y: c * x + s * y < 0.3, displacement=0.0)],
        loads=[Load.traction((2.0, -1.0), corners[1], corners[2])],
    )
    parts = scene.discretise()
    assert resultant(parts, 0) == pytest.approx(2.0, rel=1e-12)
    assert resultant(parts, 1) == pytest.approx(-1.0, rel=1e-12)


@pytest.mark.parametrize("surface", ["none", "extrapolated"])
def test_traction_on_a_part_of_an_edge(surface):
    edge = Load.traction((1.0, 0.0), (0.5, -0.2), (0.5, 0.3))
    parts = plate(LEFT, loads=[edge], surface=surface)
    assert resultant(parts, 0) == pytest.approx(0.5)
    if surface == "none":
        y = parts.lattice.points[parts.load[0] > 0, 1]
        np.testing.assert_allclose(np.sort(y), [-0.15, -0.05, 0.05, 0.15, 0.25])


@exact
@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(-3, 3), treatments)
def test_a_homogeneous_stress_on_all_edges_pulls_at_nothing(s11, s22, s12, surface):
    body = rectangle(1.0, 0.7, angle=0.3) - disc(0.2)
    load = Load.stress((s11, s22, s12))
    parts = Scene(body, 0.05, SOLID, [HELD], [load], m=2, surface=surface).discretise()
    assert resultant(parts, 0) == pytest.approx(0.0, abs=1e-12)
    assert resultant(parts, 1) == pytest.approx(0.0, abs=1e-12)


def test_a_stress_on_a_part_of_the_edges_has_its_resultant():
    load = Load.stress((2.0, 0.0, 1.0), where=lambda x, y: x > 0.499)
    for surface in ("none", "extrapolated"):
        parts = plate(LEFT, loads=[load], surface=surface)
        assert resultant(parts, 0) == pytest.approx(2.0)
        assert resultant(parts, 1) == pytest.approx(1.0)


@pytest.mark.parametrize("surface", ["none", "extrapolated"])
def test_a_flux_carries_in_what_does_not_flow_out(surface):
    load = Load.flux(lambda x, y: np.stack([-3.0 * x, 0 * y], axis=-1))
    held = [Support.where(lambda x, y: x < -0.4, temperature=0.0)]
    parts = Scene(SQUARE, 0.1, CONDUCTOR, held, [load], m=2, surface=surface).discretise()
    # div q = −3 over the unit square.
    assert resultant(parts, 0) == pytest.approx(3.0)


def test_body_loads_add_up():
    here = rectangle(0.2, 0.2)
    loads = [
        Load.body_force((1.0, 2.0)),
        Load.body_force(lambda x, y: np.stack([x, 0 * y], axis=-1), where=lambda x, y: x > 0),
        Load.couple(4.0, where=here),
    ]
    parts = plate(HELD, loads=loads)
    x, y = parts.lattice.points.T
    np.testing.assert_allclose(parts.load[0], 1.0 + np.where(x > 0, x, 0.0))
    np.testing.assert_array_equal(parts.load[1], 2.0)
    # Work-conjugate to θ Δx: the couple over the spacing.
    inside = (np.abs(x) < 0.1) & (np.abs(y) < 0.1)
    np.testing.assert_allclose(parts.load[2], np.where(inside, 40.0, 0.0))
    heat = Scene(
        region=SQUARE,
        spacing=0.1,
        m=2,
        material=CONDUCTOR,
        supports=[Support.layer(1, temperature=0.0)],
        loads=[Load.source(lambda x, y: y), Load.source(1.0)],
    ).discretise()
    np.testing.assert_allclose(heat.load[0], 1 + y)


def test_loads_of_the_other_physics():
    for load in (Load.body_force((1.0, 0.0)), Load.couple(1.0)):
        with pytest.raises(SceneError, match=r"(force|couple) does not act on an? conductive"):
            Scene(SQUARE, 0.1, CONDUCTOR, loads=[load])
    with pytest.raises(SceneError, match="source does not act on an elastic"):
        Scene(SQUARE, 0.1, SOLID, loads=[Load.source(1.0)])
    with pytest.raises(SceneError, match="inflow does not act on an elastic"):
        Scene(SQUARE, 0.1, SOLID, loads=[Load.flux((1.0, 0.0))])
    with pytest.raises(SceneError, match="traction does not act on a conductive"):
        Scene(SQUARE, 0.1, CONDUCTOR, loads=[Load.stress((1.0, 0.0, 0.0))])


def test_a_couple_needs_shear_stiffness():
    with pytest.raises(SceneError, match="do not resist rotation"):
        plate(HELD, loads=[Load.couple(1.0)], material=ElasticTensor.isotropic(1.0, 1 / 3))


def test_loads_that_act_on_nothing():
    with pytest.raises(SceneError, match="a force acts on no particle"):
        plate(HELD, loads=[Load.body_force((1.0, 0.0), where=lambda x, y: x > 5)])
    with pytest.raises(SceneError, match="no edge of the body runs along"):
        plate(HELD, loads=[Load.traction((1.0, 0.0), (3.0, 0.0), (3.0, 1.0))])


def test_edge_loads_that_act_nowhere():
    with pytest.raises(SceneError, match="no point of the edge is selected"):
        plate(HELD, loads=[Load.stress((1.0, 0.0, 0.0), where=lambda x, y: x > 5)])
    with pytest.raises(SceneError, match="one boolean a point"):
        plate(HELD, loads=[Load.stress((1.0, 0.0, 0.0), where=lambda x, y: x)])


def test_loads_that_do_not_fit():
    with pytest.raises(SceneError, match="a traction needs 2 values"):
        plate(HELD, loads=[Load.traction((1.0, 0.0, 0.0), (0.5, -0.5), (0.5, 0.5))])
    with pytest.raises(SceneError, match="a body force is not finite"):
        plate(HELD, loads=[Load.body_force((np.nan, 0.0))])


@pytest.mark.parametrize("spacing", [0.05, 0.037])
def test_body_loads_act_on_the_area_where_edges_are_as_drawn(spacing):
    part = rectangle(0.3, 0.41, (0.1, 0.05))
    loads = [Load.body_force((2.0, 0.0)), Load.body_force((0.0, 1.0), where=part)]
    body = rectangle(1.0245, 0.77)
    parts = Scene(body, spacing, SOLID, [HELD], loads, m=2, surface="extrapolated").discretise()
    assert resultant(parts, 0) == pytest.approx(2.0 * 1.0245 * 0.77, rel=1e-12)
    assert resultant(parts, 1) == pytest.approx(0.3 * 0.41, rel=1e-12)
    assert parts.volumes.sum() * spacing**2 == pytest.approx(1.0245 * 0.77, rel=1e-12)
    # The other treatments' bodies are whole cells.
    parts = Scene(body, spacing, SOLID, [HELD], loads, m=2).discretise()
    np.testing.assert_array_equal(parts.volumes, 1.0)
    np.testing.assert_array_equal(parts.load[0], 2.0)


def test_a_bar_with_a_source_feels_all_of_it():
    # Insulated but at the left, T'' = −1: 2.4 % of the width lies beyond whole cells.
    width = 1.0245

    def exact_field(x, y):
        return (x + width / 2) * (1.5 * width - x) / 2

    errors = []
    for cells in (20, 80):
        held = Support.where(
            lambda x, y, c=cells: x < -width / 2 + 5.01 / c, temperature=exact_field
        )
        scene = Scene(
            rectangle(width, 0.4),
            1 / cells,
            CONDUCTOR,
            [held],
            [Load.source(1.0)],
            surface="extrapolated",
        )
        solution = scene.solve()
        true = exact_field(*solution.points.T)
        errors.append(np.linalg.norm(solution.temperature - true) / np.linalg.norm(true))
    assert errors[0] < 3e-4
    assert errors[1] < 5e-5


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


# ---- points and lines ---------------------------------------------------------------------------


@exact
@given(st.floats(-0.49, 0.49), st.floats(-0.49, 0.49), treatments)
def test_a_point_load_has_its_resultant_and_its_moment(x, y, surface):
    parts = plate(LEFT, loads=[Load.point((2.0, -1.0), (x, y))], surface=surface)
    assert resultant(parts, 0) == pytest.approx(2.0, rel=1e-12)
    assert resultant(parts, 1) == pytest.approx(-1.0, rel=1e-12)
    if parts.nodal_load is None or not parts.nodal_load.any():
        carried = parts.load[0] @ parts.lattice.points * parts.family.cell_area
        np.testing.assert_allclose(carried, [2 * x, 2 * y], atol=1e-9)
    acting = parts.lattice.points[parts.load[0] != 0]
    assert np.hypot(*(acting - (x, y)).T).max(initial=0.0) < 0.3 + 1e-9


def test_a_point_load_at_a_particle_and_between_four():
    parts = plate(LEFT, loads=[Load.point((1.0, 0.0), (0.15, 0.25))])
    share = parts.load[0] * parts.family.cell_area
    assert share.max() == pytest.approx(1.0, abs=1e-9)
    parts = plate(LEFT, loads=[Load.point((1.0, 0.0), (0.1, 0.2))])
    share = np.sort(parts.load[0] * parts.family.cell_area)
    np.testing.assert_allclose(share[-4:], 0.25, atol=0.02)


def test_a_point_on_the_edge_loads_the_surface():
    load = Load.point((3.0, 0.0), (0.5, 0.03))
    parts = plate(LEFT, loads=[load], surface="extrapolated")
    assert not parts.load.any()
    nodes = parts.bonds.ended.outline.nodes + parts.bonds.lattice.shift
    carried = parts.nodal_load[0] @ nodes * parts.family.cell_area
    np.testing.assert_allclose(carried, [1.5, 0.09], atol=1e-12)


@pytest.mark.parametrize("surface", ["none", "volume", "extrapolated"])
def test_a_point_load_stays_on_its_side_of_a_crack(surface):
    crack = Crack((-0.1, 0.02), (0.6, 0.02))
    parts = plate(
        LEFT, loads=[Load.point((0.0, 1.0), (0.3, 0.05))], cracks=[crack], surface=surface
    )
    assert parts.lattice.points[parts.load[1] != 0, 1].min() > 0.02


def test_a_line_source_makes_a_kink():
    # A bar held on the left: T rises by q/k a length up to the line, and no further.
    scene = Scene(
        rectangle(2.0, 0.5),
        0.05,
        CONDUCTOR,
        [Support.where(rectangle(0.3, 1.0, (-1.0, 0.0)), temperature=lambda x, y: x + 0.85)],
        [Load.line(1.0, (0.31, -0.25), (0.31, 0.25))],
        m=3,
        surface="extrapolated",
    )
    solution = scene.solve()
    x = solution.points[:, 0]
    far = np.abs(x - 0.31) > 0.2
    true = np.minimum(x, 0.31) + 0.85
    np.testing.assert_allclose(solution.temperature[far], true[far], atol=1e-3)


@pytest.mark.parametrize("surface", ["none", "extrapolated"])
def test_a_line_along_an_edge_is_a_traction(surface):
    # Without nodes a traction acts on the row beside the edge: its moment is half a cell off.
    pull = (1.0, 0.4 if surface == "extrapolated" else 0.0)
    kinds = Load.line(pull, (0.5, -0.5), (0.5, 0.5)), Load.traction(pull, (0.5, -0.5), (0.5, 0.5))
    one, other = (
        Scene(SQUARE, 0.1, SOLID, [LEFT], [load], m=2, surface=surface).solve().displacement
        for load in kinds
    )
    far = np.arange(100) % 10 < 7
    np.testing.assert_allclose(one[far], other[far], atol=0.02 * np.abs(other).max())


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Load.point((1.0, 2.0, 3.0), (0, 0)), "a point load is a force"),
        (lambda: Load.point((1.0, 2.0), (0, 0, 0)), "a point load is a force"),
        (lambda: Load.point((1.0, np.nan), (0, 0)), "not finite"),
        (lambda: Load.line(1.0, (0, 0), (0, 0)), "between two points"),
        (lambda: plate(HELD, loads=[Load.point((1.0, 0.0), (0.9, 0.0))]), "no particle sees it"),
        (lambda: plate(HELD, loads=[Load.point(1.0, (0.0, 0.0))]), "does not act on an elastic"),
    ],
)
def test_concentrated_loads_that_make_no_sense(make, message):
    with pytest.raises(SceneError, match=message):
        make()


# ---- parts of edges -----------------------------------------------------------------------------


@exact
@given(
    st.sampled_from([(0.5, 0.0), (-0.5, 0.0), (0.0, 0.5), (0.0, -0.5)]),
    st.floats(0.05, 0.9),
    st.floats(-0.04, 0.04),
    treatments,
)
def test_a_region_takes_its_part_of_an_edge_on_every_side(side, size, shift, surface):
    x, y = side
    # As wide as the edge is long, or with its rim on the edge itself.
    for depth in (0.3, 0.6):
        centre = (x + shift * (x == 0) + np.sign(x) * (depth - 0.3) / 2, y + shift * (y == 0))
        centre = (centre[0], centre[1] + np.sign(y) * (depth - 0.3) / 2)
        part = rectangle(*((depth, size) if x else (size, depth)), centre)
        load = Load.stress((1.0, 1.0, 0.0), where=part)
        parts = plate(LEFT, loads=[load], surface=surface)
        assert resultant(parts, 0) == pytest.approx(np.sign(x) * size, abs=1e-9)
        assert resultant(parts, 1) == pytest.approx(np.sign(y) * size, abs=1e-9)


@exact
@given(st.floats(0.1, 0.4), st.floats(0, 6.2), st.sampled_from(["none", "extrapolated"]))
def test_a_disc_and_a_function_cut_edges_where_they_end(radius, angle, surface):
    body = rectangle(1.0, 1.0, angle=angle)
    c, s = np.cos(angle), np.sin(angle)
    where = disc(radius, (0.5 * c + 0.1 * c, 0.5 * s + 0.1 * s))
    half = np.sqrt(max(radius**2 - 0.01, 0.0))

    def also(x, y):
        return np.hypot(x - 0.6 * c, y - 0.6 * s) <= radius

    held = [Support.where(disc(0.3), displacement=0.0)]
    for part in (where, also):
        if half < 0.01:
            continue
        load = Load.stress((1.0, 1.0, 0.0), where=part)
        parts = Scene(body, 0.1, SOLID, held, [load], m=2, surface=surface).discretise()
        assert resultant(parts, 0) == pytest.approx(2 * half * c, abs=1e-8)
        assert resultant(parts, 1) == pytest.approx(2 * half * s, abs=1e-8)


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
