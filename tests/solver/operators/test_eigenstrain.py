"""Strains without stress: free expansion, clamped bodies, and the work that the forces do."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import (
    ChiralTensor,
    Crack,
    ElasticTensor,
    ExpansionTensor,
    Inclusion,
    Load,
    PolarTensor,
    Scene,
    SceneError,
    Support,
    polygon,
    recovery,
    rectangle,
)
from solver import disc as round_body
from tests.solver.bodies import exact, voigts

SURFACES = ("none", "volume", "extrapolated")
PLATE = rectangle(1.0, 0.8)
STEP = 0.1


def at(i, j):
    """The particle nearest to the middle of a cell."""

    def where(x, y):
        away = np.hypot(x - (i + 0.5) * STEP, y - (j + 0.5) * STEP)
        return np.arange(len(x)) == np.argmin(away)

    return where


FREE = (Support.where(at(0, 0), displacement=0.0), Support.where(at(3, 0), u2=0.0))


def heated(material, change, expansion, supports=FREE, body=PLATE, **options):
    loads = [Load.temperature(change, expansion)]
    scene = Scene(body, STEP, material, supports, loads, m=2.5, **options)
    return scene.solve(tolerance=1e-11)


def tensor(seed):
    a, b, c = np.random.default_rng(seed).normal(size=3)
    return ExpansionTensor([[a, c], [c, b]])


def size(material, expansion):
    return np.abs(material.voigt).max() * np.abs(expansion.matrix).max()


def oblique(x, y):
    return 0.3 + x - 2 * y


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("surface", SURFACES)
def test_uniform_and_linear_temperatures_leave_a_free_body_without_stress(surface, seed):
    """Whatever the tensor, edges along the lattice, across it and round, notched and cracked."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(3, 3))
    # C66 well above C12, so that every bond is positive or nearly so.
    material = ElasticTensor(0.3 * root @ root.T + np.diag([3.0, 3.0, 2.0]))
    expansion = tensor(seed)
    crack = Crack((-0.6, 0.0), (-0.12, 0.13))
    for change in (1.3, oblique):
        for body, cracks in (
            (PLATE, []),
            (PLATE, [crack]),
            (rectangle(1.04, 0.77), []),
            (round_body(0.55), []),
            (polygon([(-0.5, -0.5), (0.6, -0.4), (0.2, 0.0), (0.5, 0.5), (-0.5, 0.4)]), []),
        ):
            solution = heated(
                material, change, expansion, surface=surface, body=body, cracks=cracks
            )
            assert np.abs(recovery.stress(solution)).max() < 1e-10 * size(material, expansion)
            assert np.abs(solution.displacement).max() > 0.1 * np.abs(expansion.matrix).max()
    # The strain is that of the solid.
    gradient = recovery.displacement_gradient(heated(material, 1.3, expansion, surface=surface))
    strain = 0.5 * (gradient + gradient.swapaxes(1, 2))
    wanted = np.broadcast_to(1.3 * expansion.matrix, strain.shape)
    np.testing.assert_allclose(strain, wanted, atol=1e-9)


@pytest.mark.parametrize("change", [1.3, oblique])
def test_two_solids_that_expand_alike_are_free_of_stress(change):
    """Stiff in soft, across an oblique interface: free expansion does not ask for stiffness."""
    expansion, soft = tensor(5), ElasticTensor.isotropic(1.0, 0.2)
    wedge = Inclusion(
        polygon([(-0.2, -0.6), (0.6, -0.6), (0.6, 0.7), (0.1, 0.7)]),
        ElasticTensor.isotropic(4.0, 0.1),
        expansion=expansion,
    )
    for surface in SURFACES:
        solution = heated(soft, change, expansion, surface=surface, inclusions=[wedge])
        assert np.abs(recovery.stress(solution)).max() < 4e-10 * size(soft, expansion)
    # A solid that expands by itself bears stress, and one that does not say how it expands is no
    # part of a heated body.
    other = replace(wedge, expansion=tensor(6))
    found = heated(soft, change, expansion, surface="extrapolated", inclusions=[other])
    assert np.abs(recovery.stress(found)).max() > 1e-2 * size(soft, expansion)
    with pytest.raises(SceneError, match="an inclusion needs its expansion"):
        heated(soft, change, expansion, inclusions=[replace(wedge, expansion=None)])
    with pytest.raises(SceneError, match="must be an ExpansionTensor"):
        replace(wedge, expansion=1e-5)


def test_plane_strain_is_free_of_stress_in_the_plane():
    for change in (1.3, oblique):
        for surface in SURFACES:
            material = ElasticTensor.isotropic(1.0, 0.2, "strain")
            expansion = ExpansionTensor.isotropic(0.7, "strain", 0.2)
            solution = heated(material, change, expansion, surface=surface)
            assert np.abs(recovery.stress(solution)).max() < 1e-10 * size(material, expansion)
            if change is not oblique:
                # (1 + ν) α T, not α T.
                slope = recovery.displacement_gradient(solution)[:, 0, 0]
                np.testing.assert_allclose(slope, 1.2 * 0.7 * change, rtol=1e-9)


def test_a_chiral_body_expands_freely():
    """No stress, and points turn with the body alone: nothing strains its bonds."""
    material = ChiralTensor(ElasticTensor.isotropic(2.4, 0.2), [0.2, 0.2, 0.0])
    expansion = tensor(3)
    for surface in SURFACES:
        solution = heated(material, oblique, expansion, surface=surface)
        assert np.abs(recovery.stress(solution)).max() < 1e-10 * size(material, expansion)


def test_a_polar_body_bears_couple_stress_under_a_linear_temperature():
    """Points turn by ½ curl u, which no temperature asks for: κ = ∇ω is mechanical."""
    solid = ElasticTensor.isotropic(1.0, 0.2)
    polar = PolarTensor(solid, 1e-6 * np.eye(2))
    expansion = ExpansionTensor.isotropic(1.0)
    uniform = heated(polar, 1.3, expansion, surface="extrapolated")
    assert np.abs(recovery.couple_stress(uniform)).max() < 1e-15
    linear = heated(polar, lambda x, y: x, expansion, surface="extrapolated")
    # E11 = E22 = x: ω,1 = E21,1 − E11,2 = 0, ω,2 = E22,1 − E12,2 = 1.
    inside = np.abs(linear.points).max(axis=1) < 0.1
    found = recovery.couple_stress(linear)[inside] / 1e-6
    np.testing.assert_allclose(found, np.broadcast_to([0.0, 1.0], found.shape), atol=1e-3)


@exact
@given(voigts(), st.integers(0, 10**6))
def test_a_clamped_body_bears_minus_c_a_t(voigt, seed):
    material, expansion = ElasticTensor(voigt), tensor(seed)
    clamp = Support.layer(3.5, displacement=0.0, rotation=0.0)
    try:
        solution = heated(material, 2.0, expansion, [clamp], rectangle(1.4, 1.4))
    except (ValueError, RuntimeError):  # a tensor that this family does not admit
        return
    inside = np.abs(solution.points).max(axis=1) < 0.1
    s11, s22, s12 = -2.0 * material.voigt @ expansion.voigt
    found = recovery.stress(solution)[inside]
    wanted = np.broadcast_to([[s11, s12], [s12, s22]], found.shape)
    np.testing.assert_allclose(found, wanted, atol=1e-10 * size(material, expansion))
    energy = recovery.strain_energy_density(solution)[inside]
    stored = 2.0 * expansion.voigt @ material.voigt @ expansion.voigt
    np.testing.assert_allclose(energy, stored, rtol=1e-9)


@pytest.mark.parametrize("surface", SURFACES)
def test_forces_of_a_temperature_balance_and_add_up(surface):
    """No resultant and no moment, whatever the temperature; loads superpose."""
    material, hot = ElasticTensor.isotropic(1.0, 0.2), lambda x, y: np.sin(3 * x) + y**2

    def parts(*loads):
        return Scene(PLATE, STEP, material, FREE, loads, m=2, surface=surface).discretise(
            constrained=True
        )

    first, second = Load.temperature(hot, tensor(1)), Load.temperature(oblique, tensor(2))
    both = parts(first, second)
    apart = [parts(first), parts(second)]
    np.testing.assert_allclose(both.load, sum(p.load for p in apart), atol=1e-13)
    x, y = both.lattice.centred.points.T
    f, scale = both.load, np.abs(both.load).max()
    total, moment = f[:2].sum(axis=1), (x * f[1] - y * f[0]).sum() + STEP * f[2].sum()
    if both.nodal_load is not None:
        n = both.nodal_load
        a, b = both.operator.ended_stiffness.ended.outline.nodes.T
        total = total + n[:2].sum(axis=1)
        moment += (a * n[1] - b * n[0]).sum() + STEP * n[2].sum()
    assert np.abs(total).max() < 1e-12 * scale
    assert abs(moment) < 1e-12 * scale


def test_values_at_the_surface_are_those_of_the_function():
    """A temperature given as arrays, as a conduction problem has it, is the same load."""
    material, expansion = ElasticTensor.isotropic(1.0, 0.2), tensor(3)
    wanted = heated(material, oblique, expansion, surface="extrapolated")
    x, y = wanted.points.T
    arrays = Load.temperature(oblique(x, y), expansion, oblique(*wanted.surface_points.T))
    scene = Scene(PLATE, STEP, material, FREE, [arrays], m=2.5, surface="extrapolated")
    np.testing.assert_array_equal(scene.solve(tolerance=1e-11).unknowns, wanted.unknowns)
    with pytest.raises(SceneError, match="says nothing of the surface"):
        heated(material, oblique(x, y), expansion, surface="extrapolated")


def test_who_does_not_know_temperatures_says_so():
    from solver import ConductivityTensor, Programme, Toughness
    from solver.fracture import grow

    load = Load.temperature(1.0, ExpansionTensor.isotropic(1e-5))
    with pytest.raises(SceneError, match="a temperature does not act on a conductive body"):
        Scene(PLATE, STEP, ConductivityTensor.isotropic(1.0), loads=[load])
    scene = Scene(PLATE, STEP, ElasticTensor.isotropic(1.0, 0.2), FREE, [load], m=2)
    with pytest.raises(SceneError, match="cannot be broken under temperatures"):
        grow(replace(scene, surface="extrapolated"), Toughness(1.0), Programme(stop=1.0))
    with pytest.raises(SceneError, match="ExpansionTensor"):
        Load.temperature(1.0, 1e-5)


def test_neither_waves_nor_functions_of_time_know_temperatures():
    load = Load.temperature(1.0, ExpansionTensor.isotropic(1e-5))
    scene = Scene(PLATE, STEP, ElasticTensor.isotropic(1.0, 0.2), FREE, [load], m=2)
    with pytest.raises(SceneError, match="known to statics and quasi-static fracture only"):
        scene.discretise()
    with pytest.raises(SceneError, match="known to statics only"):
        Load.temperature(lambda x, y, t: x * t, ExpansionTensor.isotropic(1e-5))
