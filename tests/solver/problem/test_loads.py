"""Loads: what they add up to, on particles and edges, and clear refusals."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import (
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
from tests.solver.bodies import exact
from tests.solver.problem.squares import CONDUCTOR, HELD, SOLID, SQUARE, plate

treatments = st.sampled_from(["none", "volume", "extrapolated"])
LEFT = Support.where(lambda x, y: x < -0.2, displacement=0.0)
tractions = st.floats(-3, 3).filter(lambda t: t == 0.0 or abs(t) > 1e-30)


def resultant(parts, component):
    """Force of an edge's load: on particles, or on the surface's nodes."""
    carried = parts.load[component].sum()
    if parts.nodal_load is not None:
        carried += parts.nodal_load[component].sum()
    return carried * parts.family.cell_area


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
