"""Strained conductors: uniform strains are exact up to every edge, what does not fit is refused."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solver import (
    Crack,
    ElasticTensor,
    ElectricConductivityTensor,
    ExpansionTensor,
    Load,
    Piezoresistance,
    Scene,
    SceneError,
    Support,
    disc,
    recovery,
    rectangle,
    strained,
)

few = settings(derandomize=True, deadline=None, max_examples=8)
N, M = 12, 3
BONE = ElectricConductivityTensor.of_resistivities(170.0, 540.0, 0.4)
SOLID = ElasticTensor.isotropic(1.0, 0.2)
FIELD = np.array([1.0, -0.5])


def state(strain, turn=0.0, region=None, **options):
    """A body in which every displacement is that of a uniform strain and a small turn."""
    exx, eyy, gxy = strain

    def u(x, y):
        return np.stack([exx * x + (gxy / 2 - turn) * y, (gxy / 2 + turn) * x + eyy * y], axis=-1)

    held = Support.where(lambda x, y: x < 9, displacement=u, rotation=turn)
    region = rectangle(1.0, 1.0) if region is None else region
    return Scene(region, 1.0 / N, SOLID, [held], m=M, **options).solve()


def nearest(x, y):
    return np.arange(len(x)) == np.argmin(np.hypot(x, y))


def conductor(region=None, **options):
    region = rectangle(1.0, 1.0) if region is None else region
    settings = {"supports": [Support.where(nearest, potential=0.0)], "m": M,
                "surface": "extrapolated", **options}  # fmt: skip
    return Scene(region, 1.0 / N, BONE, **settings)


def summed(parts, piezo, strain):
    """½ Σ α Λ Δv k f(s) n n of a uniform strain."""
    exx, eyy, gxy = strain
    family, n = parts.family, parts.family.normal
    s = exx * n[:, 0] ** 2 + eyy * n[:, 1] ** 2 + gxy * n[:, 0] * n[:, 1]
    gauges = piezo.gauges(family, parts.moduli, BONE)
    k = parts.moduli.conductivity * piezo.factor(gauges, s, s)
    return 0.5 * np.einsum("n,ni,nj->ij", family.weight * family.cell_area * k, n, n)


@few
@given(
    st.tuples(*[st.floats(-2e-2, 2e-2)] * 3),
    st.sampled_from(["conductivity", "resistivity"]),
    st.sampled_from(["reference", "actual"]),
    st.floats(-10.0, 10.0),
    st.floats(-1e-2, 1e-2),
)
def test_uniform_strains_conduct_as_their_sum_up_to_the_edge(strain, law, length, gauge, turn):
    """A rigid turn changes nothing; ended bonds, corners and membrane change as the bulk does."""
    piezo = Piezoresistance(gauge, law, length)
    scene = conductor()
    tensor = summed(scene.discretise(), piezo, strain)
    scene = replace(scene, loads=[Load.flux(tuple(tensor @ FIELD))])
    solution = strained(scene, state(strain, turn), piezo).solve(tolerance=1e-13)
    exact = -solution.points @ FIELD
    exact -= exact[nearest(*solution.points.T)]
    assert np.abs(solution.potential - exact).max() < 1e-11
    current = recovery.current_density(solution)
    assert np.abs(current - tensor @ FIELD).max() < 1e-10 * np.abs(current).max()
    heat = recovery.joule_heat(solution)
    assert np.abs(heat / (FIELD @ tensor @ FIELD) - 1).max() < 1e-10


@pytest.mark.parametrize("region", [disc(0.5), rectangle(1.0 + 0.4 / N, 0.9)], ids=["disc", "cut"])
def test_a_uniform_strain_makes_another_uniform_conductor(region):
    """Bond by bond that of the moduli times their factors: membranes along the edge, too."""
    strain, piezo = (2e-2, -1e-2, 1e-2), Piezoresistance(6.0, length="actual")
    parts = conductor(region).discretise()
    exx, eyy, gxy = strain
    n = parts.family.normal
    s = exx * n[:, 0] ** 2 + eyy * n[:, 1] ** 2 + gxy * n[:, 0] * n[:, 1]
    factor = piezo.factor(piezo.gauges(parts.family, parts.moduli, BONE), s, s)
    wanted = parts.operator.with_moduli(parts.moduli.scaled(factor))
    found = strained(conductor(region), state(strain, region=region), piezo).discretise().operator
    x = np.cos(1.7 * np.arange(found.shape[0]))
    size = np.abs(wanted.matvec(x) - parts.operator.matvec(x)).max()
    assert np.abs(found.matvec(x) - wanted.matvec(x)).max() < 1e-10 * size


def test_without_strain_or_gauge_nothing_changes():
    scene = replace(conductor(disc(0.5)), loads=[Load.flux((1.0, 0.3))])
    plain = scene.solve(tolerance=1e-12).potential
    for strain, gauge in (((0.0, 0.0, 0.0), 5.0), ((1e-2, 0.0, 1e-2), 0.0)):
        other = strained(scene, state(strain, region=disc(0.5)), Piezoresistance(gauge))
        assert np.abs(other.solve(tolerance=1e-12).potential - plain).max() < 1e-9


def test_what_a_temperature_strains_counts_for_the_length_only():
    expands = ExpansionTensor.isotropic(1e-2)
    hot = Scene(
        rectangle(1.0, 1.0), 1.0 / N, SOLID,
        [Support.where(nearest, displacement=(0.0, 0.0), rotation=0.0)],
        [Load.temperature(1.0, expands)], m=M, surface="none",
    ).solve(tolerance=1e-12)  # fmt: skip
    held = Support.layer(M + 0.5, potential=lambda x, y: x)
    scene = conductor(surface="none", supports=[held])
    inside = np.abs(hot.points).max(axis=1) < 0.5 - (M + 1.5) / N
    unstrained = recovery.current_density(scene.solve())[inside]
    for length, factor in (("reference", 1.0), ("actual", 1.01**-2)):
        now = strained(scene, hot, Piezoresistance(7.0, length=length, moments="lattice")).solve()
        np.testing.assert_allclose(
            recovery.current_density(now)[inside], factor * unstrained, rtol=1e-7, atol=1e-12
        )


def test_a_negative_conductivity_is_refused_with_its_place():
    shrunk = state((-0.3, 0.0, 0.0))
    for law in ("conductivity", "resistivity"):
        with pytest.raises(SceneError, match=f"stretched by -0.3, where its {law} 1 .* negative"):
            strained(conductor(), shrunk, Piezoresistance(4.0, law, moments="lattice")).solve()


def test_what_does_not_fit_is_refused():
    pulled, law = state((1e-3, 0.0, 0.0)), Piezoresistance(2.0)
    with pytest.raises(SceneError, match="only conductors"):
        strained(pulled.scene, pulled, law)
    with pytest.raises(SceneError, match="it must be elastic"):
        strained(conductor(), conductor().solve(), law)
    with pytest.raises(SceneError, match="strained already"):
        strained(strained(conductor(), pulled, law), pulled, law)
    with pytest.raises(SceneError, match="their particles differ"):
        strained(conductor(rectangle(1.0, 1.2)), pulled, law).solve()
    cracked = state((1e-3, 0.0, 0.0), cracks=[Crack((-0.6, 0.0), (0.0, 0.0))])
    with pytest.raises(SceneError, match="conducts across what has parted"):
        strained(conductor(), cracked, law).solve()
