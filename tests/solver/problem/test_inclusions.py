"""Bodies of several solids: exact states, closed forms, the limit of one solid, refusals."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from references.analytic.inclusion import ConductingInclusion, ElasticInclusion
from solver import (
    ConductivityTensor,
    Crack,
    Discretisation,
    ElasticTensor,
    ElectricConductivityTensor,
    ExpansionTensor,
    Inclusion,
    Load,
    Programme,
    Scene,
    SceneError,
    Support,
    Toughness,
    disc,
    fracture,
    modes,
    recovery,
    rectangle,
    transient,
    waves,
)
from solver.fracture.sensing import Sensor
from tests.solver.bodies import few

SOLID = ElasticTensor.isotropic(1.0, 0.2)
TREATMENTS = ("extrapolated", "volume", "none")
contrast = st.sampled_from([1e-3, 0.1, 1.0, 7.0, 1e3])


def conducting(inner, outer, offset, treatment, slope=0.4, m=3):
    """Largest error of a state that is homogeneous on both sides of the line x = offset.

    The gradient along the line and the flux across it (1) are those of both sides.
    """
    gradient = [(1.0 - k[0][1] * slope) / k[0][0] for k in (outer, inner)]

    def field(x, y):
        return np.where(x < offset, gradient[0], gradient[1]) * (x - offset) + slope * y

    scene = Scene(
        rectangle(4.0, 4.0), 0.1, ConductivityTensor(outer),
        supports=[Support.layer(12, temperature=field)], m=m, surface=treatment,
        inclusions=[Inclusion(rectangle(4.0, 6.0, (2.0 + offset, 0.0)), ConductivityTensor(inner))],
    )  # fmt: skip
    solution = scene.solve(tolerance=1e-12)
    error = solution.temperature - field(*solution.points.T)
    return np.abs(error).max(), solution


@few
@given(contrast, st.sampled_from([0.0, 0.033, -0.071]), st.sampled_from(TREATMENTS))
def test_homogeneous_flux_across_an_interface_is_exact(ratio, offset, treatment):
    """Whatever the contrast, the treatment and the place of the interface in its cell.

    What is left comes from the ends of the interface, twelve cells deep in the support: a quarter
    is left from node to node, which are four cells apart where the interface cuts cells.
    """
    outer, inner = [[2.0, 0.6], [0.6, 1.0]], ratio * np.array([[1.0, -0.3], [-0.3, 2.0]])
    error, solution = conducting(inner, outer, offset, treatment)
    assert error < (1e-9 if offset == 0.0 else 3e-4) * max(1.0, 1.0 / ratio)
    flux = recovery.flux(solution)[~solution.prescribed]
    allowed = (1e-7 if offset == 0.0 else 4e-3) * max(1.0, ratio)
    np.testing.assert_allclose(flux[:, 0], -1.0, atol=allowed)


def test_particles_on_an_interface_are_told_of():
    """It then seems a fraction of a cell thick, of the more resistant solid."""
    outer, inner = [[2.0, 0.6], [0.6, 1.0]], [[1.0, -0.3], [-0.3, 2.0]]
    error, solution = conducting(inner, outer, 0.05, "none")
    assert any("on an interface" in said for said in solution.statistics.warnings)
    assert 1e-3 < error < 0.07 * 0.1 * 1.2
    assert not any(
        "interface" in said
        for said in conducting(inner, outer, 0.03, "none")[1].statistics.warnings
    )


@pytest.mark.parametrize("ratio", [1e-3, 1.0, 1e3])
def test_homogeneous_stress_across_an_interface_is_exact(ratio):
    """Between two rows of particles, with a shear that turns both sides differently."""
    voigts = SOLID.voigt, ElasticTensor.orthotropic(3.0, 1.0, 0.8, 0.2).rotated(0.4).voigt * ratio
    strains = []
    for voigt in voigts:
        across = np.linalg.solve(voigt[::2, ::2], np.array([1.0, 0.7]) - voigt[::2, 1] * 0.3)
        strains.append([across[0], 0.3, across[1]])

    def strain(x):
        return np.where((x < 0)[..., None], *strains)

    def displacement(x, y):
        e = strain(x)
        return np.stack([e[..., 0] * x, e[..., 1] * y + e[..., 2] * x], axis=-1)

    scene = Scene(
        rectangle(4.0, 4.0), 0.1, SOLID, m=3, surface="none",
        supports=[Support.layer(12, displacement=displacement,
                                rotation=lambda x, y: 0.5 * strain(x)[..., 2])],
        inclusions=[Inclusion(rectangle(4.0, 6.0, (2.0, 0.0)), ElasticTensor(voigts[1]))],
    )  # fmt: skip
    solution = scene.solve(tolerance=1e-12)
    exact = displacement(*solution.points.T)
    error = np.abs(solution.displacement - exact).max() / np.abs(exact).max()
    assert error < 1e-9
    stress = recovery.stress(solution)[~solution.prescribed]
    np.testing.assert_allclose(stress[:, 0], [[1.0, 0.7]] * len(stress), atol=1e-5 * max(1, ratio))


def disc_in_a_plate(cells, ratio, elastic, treatment="volume"):
    """Root mean square of the error of a disc in a far field, relative to the field's largest."""
    m = 3
    if elastic:
        exact = ElasticInclusion((1.0, 0.2), (ratio, 0.25), (1.0, 0.3, 0.4), 0.5)
        solid, other = SOLID, ElasticTensor.isotropic(ratio, 0.25)
        given_there = {"displacement": exact.displacement, "rotation": exact.rotation}
    else:
        exact = ConductingInclusion(1.0, ratio, (1.0, 0.3), 0.5)
        solid, other = (ConductivityTensor.isotropic(k) for k in (1.0, ratio))
        given_there = {"temperature": exact.value}
    scene = Scene(
        rectangle(2.0, 2.0), 1 / cells, solid, m=m, surface=treatment,
        supports=[Support.layer(m + 0.5, **given_there)], inclusions=[Inclusion(disc(0.5), other)],
    )  # fmt: skip
    solution = scene.solve()
    found = solution.displacement if elastic else solution.temperature
    wanted = exact.displacement(*solution.points.T) if elastic else exact.value(*solution.points.T)
    error = np.sqrt(np.mean((found - wanted) ** 2)) / np.abs(wanted).max()
    return error, solution.statistics.iterations


@pytest.mark.parametrize("elastic", [False, True])
@pytest.mark.parametrize("ratio", [1e-3, 10.0, 1e3])
def test_a_disc_of_another_solid_is_the_closed_form(ratio, elastic):
    """Second order at any contrast, in as many iterations as without it."""
    coarse, _ = disc_in_a_plate(20, ratio, elastic)
    fine, iterations = disc_in_a_plate(40, ratio, elastic)
    # Measured: 2.3e-4 … 4.4e-4; orders from 1.6 to 2.
    assert fine < 6e-4
    assert np.log2(coarse / fine) > 1.4
    assert iterations <= 26


@pytest.mark.parametrize("treatment", TREATMENTS)
@pytest.mark.parametrize("offset", [0.0, 0.03, 0.05])
def test_an_inclusion_of_the_same_solid_changes_next_to_nothing(treatment, offset):
    """A bar bent by its end: the interface runs along it, along a row, across its free edges."""
    # Measured without: the bar's own error is ten to a hundred times as large.
    held = Support.where(lambda x, y: x < -0.8, displacement=0.0)
    pull = Load.traction((0.0, 1.0), (1.0, -0.5), (1.0, 0.5))
    scenes = [
        Scene(rectangle(2.0, 1.0), 0.1, SOLID, m=3, surface=treatment, supports=[held],
              loads=[pull], inclusions=inclusions)
        for inclusions in ([], [Inclusion(rectangle(4.0, 2.0, (0.0, 1.0 + offset)), SOLID)])
    ]  # fmt: skip
    one, other = (scene.solve().displacement for scene in scenes)
    assert np.abs(one - other).max() < 0.012 * np.abs(one).max()


def test_a_body_that_only_interfaces_hold_together_is_one():
    """The right half hangs on the left one by the nodes of their interface alone."""
    left = Support.where(lambda x, y: x < -0.7, temperature=0.0)
    right = Inclusion(rectangle(2.0, 2.0, (1.0, 0.0)), ConductivityTensor.isotropic(2.0))
    scene = Scene(rectangle(2.0, 1.0), 0.1, ConductivityTensor.isotropic(1.0), m=2,
                  supports=[left], loads=[Load.source(1.0, lambda x, y: x > 0.9)],
                  inclusions=[right])  # fmt: skip
    solution = scene.solve()
    # A source of 0.1 runs through a length of 0.7 of k = 1 and 0.95 of k = 2.
    rise = solution.temperature[solution.points[:, 0] > 0.9].mean()
    assert rise == pytest.approx(0.1 * (0.65 + 0.95 / 2), rel=0.06)


def test_masses_and_capacities_are_those_of_the_phases():
    """A disc of another density between cells: the sum is exact, edges cut or not."""
    inclusion = Inclusion(disc(0.31), SOLID, density=5.0)
    scene = Scene(rectangle(1.03, 1.0), 0.05, SOLID, m=2, surface="extrapolated", density=2.0,
                  inclusions=[inclusion])  # fmt: skip
    share = Discretisation.of(scene, free=True).storage("density")
    area = np.pi * 0.31**2
    assert share.sum() * 0.05**2 == pytest.approx(1.03 - area + 2.5 * area, rel=1e-4)
    assert modes.solve(scene, 3).frequencies.min() > 0
    # Half a bar that stores four times as much warms by a quarter in a short pulse.
    bar = Scene(
        rectangle(1.0, 0.2),
        0.05,
        ConductivityTensor.isotropic(1e-6),
        m=2,
        heat_capacity=1.0,
        loads=[Load.source(1.0)],
        inclusions=[
            Inclusion(
                rectangle(1.0, 1.0, (0.5, 0.0)),
                ConductivityTensor.isotropic(1e-6),
                heat_capacity=4.0,
            )
        ],
    )
    found = transient.run(bar, initial=0.0, times=[0.1])
    warm, x = found.temperature[-1], found.points[:, 0]
    np.testing.assert_allclose(warm[x < 0], 0.1, rtol=1e-3)
    np.testing.assert_allclose(warm[x > 0], 0.025, rtol=1e-3)


def test_a_wave_is_reflected_by_the_difference_of_impedances():
    """Z₂ = 4 Z₁ at the same speed: −3/5 of a pulse goes back, 2/5 goes on."""
    speed, place, width = np.sqrt(SOLID.voigt[0, 0]), -1.5, 0.4

    def pulse(x, y):
        return np.stack([np.exp(-(((x - place) / width) ** 2)), 0 * x], axis=-1)

    def velocity(x, y):
        return 2 * speed * ((x - place) / width**2)[..., None] * pulse(x, y)

    scene = Scene(
        rectangle(8.0, 0.3), 0.05, SOLID, m=2, density=1.0,
        supports=[Support.where(lambda x, y: np.abs(x) < 9, u2=0.0, rotation=0.0)],
        inclusions=[Inclusion(rectangle(4.0, 2.0, (2.0, 0.0)), ElasticTensor.isotropic(4.0, 0.2),
                              density=4.0)],
    )  # fmt: skip
    found = waves.run(scene, pulse, end=3.2 / speed, velocity=velocity)
    u, x = found.displacement[-1][:, 0], found.points[:, 0]
    # What the lattice disperses of a pulse of 16 cells is a few per cent.
    assert u[x < -0.3].min() == pytest.approx(-0.6, abs=0.02)
    assert u[x > 0.2].max() == pytest.approx(0.4, abs=0.02)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"inclusions": [Inclusion(disc(0.2), ConductivityTensor.isotropic(1.0))]}, "no inclusion"),
        ({"inclusions": [Inclusion(disc(0.2), SOLID, density=1.0)]}, "the scene has none"),
        ({"inclusions": [disc(0.2)]}, "inclusions must be a list of Inclusion"),
        ({"broken": lambda lattice, family: None}, "single bonds cannot be broken"),
        ({"loads": [Load.temperature(1.0, ExpansionTensor.isotropic(1.0))]}, "needs its expansion"),
    ],
)
def test_scenes_that_inclusions_do_not_fit(changes, message):
    settings = {"inclusions": [Inclusion(disc(0.2), SOLID)], **changes}
    with pytest.raises(SceneError, match=message):
        Scene(rectangle(1.0, 1.0), 0.05, SOLID, m=2, **settings)


def test_what_an_inclusion_needs():
    for arguments, message in (
        ((1.0, SOLID), "must be a Region"),
        ((disc(1.0), None), "needs a material"),
        ((disc(1.0), SOLID, -1.0), "density of an inclusion must be positive"),
    ):
        with pytest.raises(SceneError, match=message):
            Inclusion(*arguments)


def test_cracks_do_not_grow_in_it_and_sensors_are_of_one_solid():
    inclusions = [Inclusion(disc(0.2), SOLID)]
    scene = Scene(rectangle(1.0, 1.0), 0.05, SOLID, m=2, inclusions=inclusions,
                  supports=[Support.layer(2, displacement=0.0)])  # fmt: skip
    with pytest.raises(SceneError, match="do not grow in a body with inclusions"):
        fracture.grow(scene, Toughness(1.0), Programme(stop=1.0))
    metal = ElectricConductivityTensor.isotropic(1.0)
    with pytest.raises(SceneError, match="no inclusions"):
        Sensor(
            Scene(rectangle(1.0, 1.0), 0.05, metal, inclusions=[Inclusion(disc(0.2), metal)]),
            disc(0.1), disc(0.1),
        )  # fmt: skip
    # A crack away from the interfaces is no fault in statics.
    cracked = Scene(rectangle(1.0, 1.0), 0.05, SOLID, m=2, surface="extrapolated",
                    inclusions=inclusions, cracks=[Crack((0.3, 0.0), (0.6, 0.0))],
                    supports=[Support.where(lambda x, y: y < -0.4, displacement=0.0)],
                    loads=[Load.traction((0.0, 1.0), (-0.5, 0.5), (0.5, 0.5))])  # fmt: skip
    assert np.isfinite(cracked.solve().displacement).all()


@few
@given(
    st.floats(-2.5, 2.5),
    st.floats(0.0, 0.32),
    st.sampled_from([2, 3, 4, 5]),
    st.sampled_from(TREATMENTS),
    st.floats(0.0, 0.3),
    st.floats(0.0, 3.0),
)
def test_overlapping_inclusions_of_any_contrast_are_solved(power, nu, m, treatment, off, turn):
    """Interfaces anywhere in their cells, slivers, corners and free edges: no negative energy."""
    other = ElasticTensor.isotropic(10**power, nu)
    scene = Scene(
        rectangle(2.0, 1.4), 0.1, SOLID, m=m, surface=treatment,
        supports=[Support.where(lambda x, y: x < -0.8, displacement=0.0)],
        loads=[Load.body_force((1.0, 0.5))],
        inclusions=[
            Inclusion(rectangle(0.8, 1.0, (0.1 + off, 0.2 + off)), other),
            Inclusion(rectangle(0.77, 0.7, (0.09 + off, -0.2)), other),
            Inclusion(rectangle(0.5, 0.3, (-0.4, 0.3 + off), turn), other),
        ],
    )  # fmt: skip
    solution = scene.solve()
    assert np.isfinite(solution.displacement).all()
    stiff = np.abs(solution.displacement).max() * min(1.0, 10**power)
    assert stiff < 60.0


def test_leads_on_a_body_with_inclusions_are_refused():
    metal = ElectricConductivityTensor.isotropic(1.0)
    lead = rectangle(0.2, 0.2, (-0.3, 0.0))
    scene = Scene(
        rectangle(1.0, 1.0),
        0.05,
        metal,
        m=2,
        supports=[Support.lead(lead, 0.0)],
        loads=[Load.source(1.0)],
        inclusions=[Inclusion(disc(0.1, (0.2, 0.0)), metal)],
    )
    with pytest.raises(SceneError, match=r"leads on metal .* with inclusions"):
        scene.solve()


@few
@given(
    st.tuples(st.floats(-0.6, 0.6), st.floats(-0.3, 0.3)),
    st.floats(0.15, 0.6),
    st.floats(0, 3),
    st.sampled_from(TREATMENTS),
)
def test_what_acts_and_weighs_acts_on_the_area_of_each_solid(place, size, angle, treatment):
    """Interfaces lie where they are drawn whatever the edges do: cells that they cut are shared."""
    inner, thick = rectangle(size, 0.7 * size, place, angle), 3.0
    parts = Discretisation.of(
        Scene(
            rectangle(2.0, 1.4), 0.1, SOLID, [Support.layer(1.0, displacement=0.0)],
            [Load.body_force((0.0, -1.0))], m=2, surface=treatment, density=2.0,
            inclusions=[Inclusion(inner, SOLID, density=10.0, thickness=thick)], thickness=1.0,
        )
    )  # fmt: skip
    inside = parts.bonds.phases.of == 1
    area, whole = 0.7 * size**2, 2.8
    assert parts.volumes.min() > 0.1
    assert parts.volumes[inside].sum() * 0.01 == pytest.approx(area, rel=1e-9)
    assert parts.volumes.sum() * 0.01 == pytest.approx(whole, rel=1e-9)
    mass = 2.0 * parts.storage("density").sum() * 0.01
    assert mass == pytest.approx(2.0 * (whole - area) + 10.0 * thick * area, rel=1e-9)
    weight = -parts.load[1].sum() * 0.01
    assert weight == pytest.approx(whole - area + thick * area, rel=1e-9)
