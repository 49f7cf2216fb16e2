"""Stress, flux, energy and macrorotation: exact on homogeneous fields, counted bond by bond."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from solver import (
    ConductivityTensor,
    Crack,
    ElasticTensor,
    ExpansionTensor,
    Family,
    Load,
    Scene,
    Support,
    TwoHarmonic,
    recovery,
    rectangle,
)
from solver.material import assess, calibrate
from solver.operators import BondOperator
from solver.recovery import displacement_gradient
from solver.solution import Solution
from tests.solver.bodies import DISC, FIG_7, Cells, block, conductivities, exact, few, masks, voigts
from tests.solver.bonds.test_bonds import pair_factors

STRAIN = np.array([[0.7, -0.2], [0.5, 0.3]])


def imposed(scene, *fields):
    """A solution that holds the fields given (u1, u2, θ Δx or T, one row each), unsolved."""
    parts = scene.discretise()
    statistics = scene.solve().statistics
    return Solution(parts, np.array(fields, dtype=float), statistics)


def elastic_body(region, spacing=0.5, material=FIG_7, m=2.0, **options):
    """A body all of whose particles are held: no surface factors, any field may be imposed."""
    everywhere = Support.where(lambda x, y: x == x, displacement=0.0, rotation=0.0)
    return Scene(region, spacing, ElasticTensor(material), [everywhere], m=m, **options)


def linear(gradient, spacing=0.5, region=None, theta=None, **options):
    """A homogeneous displacement gradient, particles turning with the body unless told."""
    scene = elastic_body(block(16, 15, spacing) if region is None else region, spacing, **options)
    parts = scene.discretise()
    u = parts.lattice.points @ np.asarray(gradient).T
    spin = 0.5 * (gradient[1, 0] - gradient[0, 1]) if theta is None else theta
    fields = [*u.T, np.full(len(u), spin * spacing)]
    return imposed(scene, *fields[: parts.operator.components])


def deep(found, cells):
    """Particles farther than `cells` from the edge: some, or a check of them shows nothing."""
    inside = found.discretisation.lattice.edge_distance > cells * found.spacing
    assert inside.sum() > 5
    return inside


def tensor_of(strain_stress):
    """[σ11, σ22, σ12] as a matrix."""
    a, b, c = strain_stress
    return np.array([[a, c], [c, b]])


# ---- stress -------------------------------------------------------------------------------------


@exact
@given(
    voigts(floor=0.3),
    st.tuples(*[st.floats(-1, 1)] * 4),
    st.sampled_from([2, 2.5, 3]),
    st.sampled_from(["plane", "family"]),
)
def test_stress_of_a_homogeneous_strain_is_hooke_s(voigt, gradient, m, rule):
    gradient = np.reshape(gradient, (2, 2))
    family = Family(m, 0.5)
    assume(assess(family, calibrate(family, ElasticTensor(voigt))).kind != "inadmissible")
    found = linear(gradient, material=voigt, m=m, region=block(18, 17, 0.5))
    strain = [gradient[0, 0], gradient[1, 1], gradient[0, 1] + gradient[1, 0]]
    wanted = tensor_of(voigt @ strain)
    reach = found.discretisation.family.reach
    inside = deep(found, (2 if rule == "plane" else 1) * reach)
    stress = recovery.stress(found, rule)
    tolerance = 1e-11 * max(np.abs(voigt).max(), 1e-3)
    np.testing.assert_allclose(stress[inside], np.broadcast_to(wanted, (inside.sum(), 2, 2)),
                               atol=tolerance)  # fmt: skip


@pytest.mark.parametrize("rule", ["plane", "family"])
def test_stress_that_is_not_symmetric(rule):
    # Particles turned against the body by −c: γ = c in every bond, so σ21 = −σ12 is the couple
    # stress balance, 2 (C66 − C12) c (half of the moment 4 (C66 − C12) c of a uniform couple).
    c = 0.3
    found = linear(np.zeros((2, 2)), theta=-c, m=3)
    moment = 4 * (FIG_7[2, 2] - FIG_7[0, 1]) * c
    stress = recovery.stress(found, rule)[deep(found, 6 if rule == "plane" else 3)]
    # [i, j] is component i on the plane of normal j: a bond along 1 pulls along +2.
    np.testing.assert_allclose(stress[:, 1, 0] - stress[:, 0, 1], moment, rtol=1e-11)
    np.testing.assert_allclose(stress[:, [0, 1], [0, 1]], 0.0, atol=1e-13)


def crossing_sum(found, p, axis):
    """Traction on p's section normal to `axis`, from every single bond that passes through it.

    The section is the Δx about p; the mean over a hair's breadth to either side in both
    directions counts ties by half.
    """
    parts = found.discretisation
    family, moduli = parts.family, parts.moduli
    dx, points = family.spacing, parts.lattice.points
    u, theta = found.displacement, found.rotation
    index = {tuple(o): k for k, o in enumerate(family.offsets.tolist())}
    total = np.zeros(2)
    for (a, b), factor in pair_factors(parts.bonds).items():
        xi = points[b] - points[a]
        if xi[axis] <= 1e-12:
            continue
        size = np.hypot(*xi)
        n = xi / size
        t = np.array([-n[1], n[0]])
        o = index[tuple(np.rint(xi / dx).astype(int))]
        eta = u[b] - u[a]
        s = eta @ n / size
        gamma = eta @ t / size - 0.5 * (theta[a] + theta[b])
        force = moduli.normal[o] * s * n + moduli.shear[o] * gamma * t
        share = 0.0
        for ahead in (-1e-6, 1e-6):
            plane = points[p, axis] + ahead * dx
            fraction = (plane - points[a, axis]) / xi[axis]
            if not 0 < fraction < 1:
                continue
            height = points[a, 1 - axis] + fraction * xi[1 - axis]
            for side in (-1e-3, 1e-3):
                share += 0.25 * (abs(height - points[p, 1 - axis] - side * dx) < 0.5 * dx)
        total += share * factor * family.weight[o] * force * dx**4 / dx
    return total


@few
@given(st.integers(0, 10**6), st.sampled_from([2.0, 3.0, 3.5]))
def test_plane_stress_is_the_sum_of_the_bonds_that_cross(seed, m):
    rng = np.random.default_rng(seed)
    mask = rng.random((7, 8)) < 0.85
    mask[3, 2:6] = True
    crack = Crack((0.7, 1.6), (2.1, 2.2))
    scene = elastic_body(Cells(mask, 0.5), m=m, cracks=[crack])
    count = int(mask.sum())
    found = imposed(scene, *rng.normal(size=(3, count)))
    stress = recovery.stress(found, "plane")
    scale = np.abs(stress).max()
    for p in rng.choice(count, 5, replace=False):
        for axis in (0, 1):
            wanted = crossing_sum(found, p, axis)
            np.testing.assert_allclose(stress[p, :, axis], wanted, atol=1e-11 * scale)


def test_rigid_motion_has_no_stress():
    turn = np.array([[0.0, -0.4], [0.4, 0.0]])
    found = linear(turn, cracks=[Crack((-1.0, 3.0), (3.0, 3.0))])
    for rule in ("plane", "family"):
        assert np.abs(recovery.stress(found, rule)).max() < 1e-13


def test_stress_of_a_solid_without_rotations():
    voigt = ElasticTensor.isotropic(2.0, 1 / 3).voigt
    found = linear(STRAIN, material=voigt, m=3)
    assert np.isnan(found.rotation).all()
    wanted = tensor_of(voigt @ [0.7, 0.3, 0.3])
    for rule, cells in (("plane", 6), ("family", 3)):
        stress = recovery.stress(found, rule)[deep(found, cells)]
        np.testing.assert_allclose(stress, np.broadcast_to(wanted, stress.shape), atol=1e-12)


def test_a_strain_wrong_by_one_per_cent_is_seen():
    for rule in ("plane", "family"):
        right, off = (recovery.stress(linear(k * STRAIN, m=3), rule) for k in (1.0, 1.01))
        middle = deep(linear(STRAIN, m=3), 6)
        assert np.abs(off - right)[middle].max() > 5e-3


# ---- flux ---------------------------------------------------------------------------------------


def conductor(matrix, m=3.0, **options):
    everywhere = Support.where(lambda x, y: x == x, temperature=0.0)
    return Scene(block(14, 12, 0.5), 0.5, ConductivityTensor(matrix), [everywhere], m=m, **options)


@exact
@given(conductivities(), st.tuples(*[st.floats(-1, 1)] * 2), st.sampled_from([2, 3, 4.5]))
def test_flux_of_a_linear_temperature_is_fourier_s(matrix, gradient, m):
    scene = conductor(matrix, m)
    points = scene.discretise().lattice.points
    found = imposed(scene, points @ np.array(gradient))
    inside = deep(found, found.discretisation.family.reach)
    wanted = -matrix @ np.array(gradient)
    for rule in ("consistent", "hotter"):
        flux = recovery.flux(found, rule)[inside]
        np.testing.assert_allclose(flux, np.broadcast_to(wanted, flux.shape), atol=1e-12)


def test_rules_differ_where_the_gradient_does():
    scene = conductor(DISC)
    x = scene.discretise().lattice.points[:, 0]
    found = imposed(scene, x**2)
    inside = deep(found, 3)
    wanted = -np.outer(2 * x, DISC[0])[inside]
    # The half sum takes the even part away: exact for quadratics too; one-sided sums do not.
    np.testing.assert_allclose(recovery.flux(found)[inside], wanted, atol=1e-11)
    assert np.abs(recovery.flux(found, "hotter")[inside] - wanted).max() > 0.1


def test_no_heat_crosses_a_crack():
    scene = conductor(DISC, cracks=[Crack((-1.0, 3.0), (8.0, 3.0))])
    y = scene.discretise().lattice.points[:, 1]
    found = imposed(scene, np.where(y > 3, 5.0, 1.0))
    assert np.abs(recovery.flux(found)).max() == 0.0


# ---- energy -------------------------------------------------------------------------------------


@few
@given(masks(), st.integers(0, 10**6), st.sampled_from(["none", "volume"]))
def test_energies_of_the_particles_sum_to_that_of_the_body(mask, seed, surface):
    mask[2:4, 1:6] = True
    rng = np.random.default_rng(seed)
    crack = Crack((0.4, 1.4), (2.0, 1.6))
    solids = [ElasticTensor(FIG_7), ElasticTensor.isotropic(1.0, 1 / 3), ConductivityTensor(DISC)]
    for material in solids:
        conductive = isinstance(material, ConductivityTensor)
        values = {"temperature": 0.0} if conductive else {"displacement": 0.0, "rotation": 0.0}
        held = Support.where(lambda x, y: x == x, **values)
        scene = Scene(Cells(mask, 0.5), 0.5, material, [held], m=2, cracks=[crack], surface=surface)
        parts = scene.discretise()
        whole = BondOperator(parts.bonds, parts.moduli, np.zeros_like(parts.prescribed))
        x = rng.normal(size=(whole.components, mask.sum()))
        found = imposed(scene, *x)
        energy = 0.5 * x.ravel() @ whole.matvec(x.ravel())
        assert recovery.strain_energy_density(found).sum() == pytest.approx(energy, rel=1e-11)


def test_energy_density_of_homogeneous_fields():
    found = linear(STRAIN, m=3)
    strain = np.array([0.7, 0.3, 0.3])
    inside = deep(found, 3)
    density = recovery.strain_energy_density(found)[inside]
    np.testing.assert_allclose(density, 0.5 * strain @ FIG_7 @ strain, rtol=1e-11)
    scene = conductor(DISC)
    gradient = np.array([0.4, -1.0])
    heat = imposed(scene, scene.discretise().lattice.points @ gradient)
    # The macro-potential of Eq. 115 for a homogeneous gradient is Eq. 148.
    density = recovery.strain_energy_density(heat)[deep(heat, 3)]
    np.testing.assert_allclose(density, 0.5 * gradient @ DISC @ gradient, rtol=1e-11)


@few
@given(masks(), st.sampled_from(["none", "volume", "extrapolated"]), st.floats(-2, 2))
def test_the_temperature_that_strains_a_body_is_written_with_its_stress(mask, surface, slope):
    """The sum of all, whatever they do to the body; nobody else has one."""
    mask[2:4, 1:6] = True
    change, more = lambda x, y: 1.0 + slope * x - y, np.arange(float(mask.sum()))
    expands, twists = ExpansionTensor([[1.0, 0.2], [0.2, 0.5]]), ExpansionTensor([[0, 1.0], [1, 0]])
    at = change if surface == "extrapolated" else None
    loads = [Load.temperature(change, expands), Load.temperature(more, twists, at)]
    held = [Support.where(lambda x, y: x == x, displacement=0.0, rotation=0.0)]
    scene = Scene(Cells(mask, 0.5), 0.5, ElasticTensor(FIG_7), held, loads, m=2, surface=surface)
    found = scene.solve()
    fields = recovery.fields(found)
    np.testing.assert_allclose(fields["temperature"], change(*found.points.T) + more, atol=1e-12)
    assert "temperature" not in recovery.fields(replace(scene, loads=[]).solve())


# ---- gradient -----------------------------------------------------------------------------------


@exact
@given(masks(), st.tuples(*[st.floats(-1, 1)] * 4), st.sampled_from([2, 3]))
def test_linear_fields_have_their_gradient_in_every_body(mask, gradient, m):
    mask[2:4, 1:6] = True
    gradient = np.reshape(gradient, (2, 2))
    crack = Crack((0.4, 1.5), (2.0, 1.6))
    found = linear(gradient, region=Cells(mask, 0.5), m=m, cracks=[crack])
    parts = found.discretisation
    # Families that are one line of bonds, or none, know one slope at most.
    moment = np.zeros((mask.sum(), 2, 2))
    for (p, q), factor in pair_factors(parts.bonds).items():
        xi = parts.lattice.points[q] - parts.lattice.points[p]
        moment[p] += (factor > 0) * np.outer(xi, xi)
    sound = np.linalg.eigvalsh(moment)[:, 0] > 1e-6
    assert sound.any()
    slope = displacement_gradient(found)[sound]
    np.testing.assert_allclose(slope, np.broadcast_to(gradient, slope.shape), atol=1e-10)
    spin = recovery.macrorotation(found)[sound]
    np.testing.assert_allclose(spin, 0.5 * (gradient[1, 0] - gradient[0, 1]), atol=1e-10)


def test_slopes_are_not_taken_across_a_crack():
    scene = elastic_body(block(12, 12, 0.5), cracks=[Crack((-1.0, 3.0), (8.0, 3.0))], m=3)
    points = scene.discretise().lattice.points
    upper = points[:, 1] > 3
    u = np.where(upper[:, None], points @ STRAIN.T + 9.0, points @ -STRAIN.T)
    found = imposed(scene, *u.T, np.zeros(len(u)))
    wanted = np.where(upper, 1.0, -1.0)[:, None, None] * STRAIN
    np.testing.assert_allclose(displacement_gradient(found), wanted, atol=1e-11)


# ---- refusals -----------------------------------------------------------------------------------


def test_wrong_physics_and_unknown_rules():
    elastic = linear(STRAIN)
    scene = conductor(DISC)
    heat = imposed(scene, np.zeros(scene.discretise().lattice.count))
    for ask in (recovery.stress, recovery.macrorotation):
        with pytest.raises(TypeError, match="of elasticity only, not of heat"):
            ask(heat)
    with pytest.raises(TypeError, match="of heat conduction only"):
        recovery.flux(elastic)
    with pytest.raises(ValueError, match="unknown stress rule 'virial'"):
        recovery.stress(elastic, "virial")
    with pytest.raises(ValueError, match="unknown flux rule 'colder'"):
        recovery.flux(heat, "colder")


def test_negative_micro_conductivities_conduct_right_too():
    scene = conductor(DISC, law=TwoHarmonic())
    points = scene.discretise().lattice.points
    assert not scene.discretise().moduli.non_negative
    found = imposed(scene, points @ np.array([1.0, 2.0]))
    flux = recovery.flux(found)[deep(found, 3)]
    np.testing.assert_allclose(flux, np.broadcast_to(-DISC @ [1.0, 2.0], flux.shape), atol=1e-12)


@pytest.mark.parametrize(("surface", "rule"), [("volume", "plane"), ("extrapolated", "family")])
def test_the_default_rule_fits_the_treatment(surface, rule):
    # A bar in uniform tension 1: on its free edge, too, where the plane sees 0.67.
    near = rectangle(0.06, 0.1, (-1.0, 0.0)), rectangle(0.06, 0.1, (1.0, 0.0))
    supports = [Support.where(near[0], displacement=0.0), Support.where(near[1], u2=0.0)]
    solid = ElasticTensor.isotropic(1.0, 0.2)
    scene = Scene(
        rectangle(2.0, 1.0),
        0.05,
        solid,
        supports,
        [Load.stress((1.0, 0.0, 0.0))],
        m=3,
        surface=surface,
    )
    solution = scene.solve()
    found = recovery.stress(solution)
    np.testing.assert_array_equal(found, recovery.stress(solution, rule))
    np.testing.assert_array_equal(solution.fields()["stress11"], found[:, 0, 0])
    if surface == "extrapolated":
        middle = np.abs(solution.points[:, 0]) < 0.5
        np.testing.assert_allclose(found[middle, 0, 0], 1.0, atol=2e-3)
