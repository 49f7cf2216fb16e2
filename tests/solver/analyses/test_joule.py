"""Joule's chain: energies balance on any body, temperatures follow potentials, bodies expand."""

import numpy as np
import pytest

from solver import (
    ConductivityTensor,
    ElasticTensor,
    ElectricConductivityTensor,
    ExpansionTensor,
    Inclusion,
    Load,
    Scene,
    SceneError,
    Support,
    disc,
    polygon,
    recovery,
    rectangle,
)
from solver.analyses import joule
from solver.reactions import supply

BONE = ElectricConductivityTensor.of_resistivities(170.0, 540.0, 0.4)


def left(x, y):
    return x < -0.7


def right(x, y):
    return x > 0.7


def body(region=None, **options):
    region = rectangle(2.0, 1.0) if region is None else region
    held = Support.where(left, displacement=(0.0, 0.0), rotation=0.0)
    settings = {"m": 3, "surface": "extrapolated", **options}
    return Scene(region, 0.08, ElasticTensor.isotropic(1.0, 0.2), [held], **settings)


def run(scene, **changes):
    options = {"plus": right, "minus": left, "sink": left, "voltage": 2.0,
               "resistivities": (1.0, 3.0), "conductivities": (1.0, 0.5),
               "expansions": (0.01, 0.02), "angle_degrees": 20.0, **changes}  # fmt: skip
    return joule.run(scene, **options)


@pytest.mark.parametrize("surface", ["none", "volume", "extrapolated"])
@pytest.mark.parametrize(
    "region",
    [
        rectangle(2.0, 1.0),
        rectangle(2.03, 0.97) - disc(0.23, (0.1, 0.05)),
        polygon([(-1.0, -0.6), (1.0, -0.3), (1.0, 0.5), (-1.0, 0.4)]),
    ],
    ids=["plate", "hole", "turned"],
)
def test_what_is_supplied_is_made_and_removed(surface, region):
    chain = run(body(region, surface=surface))
    assert chain.supplied > 0
    assert chain.imbalance < 1e-8
    assert np.nanmin(chain.heat.temperature) > -1e-9 * np.nanmax(chain.heat.temperature)


@pytest.mark.parametrize("surface", ["none", "volume", "extrapolated"])
def test_dissipation_is_what_any_lead_feeds_in(surface):
    """Currents given and potentials held, bonds that end at leads' rims, floating metal."""
    fed, sunk, metal = (rectangle(0.24, 0.24, (x, 0.05)) for x in (0.6, -0.6, 0.0))
    solution = Scene(
        rectangle(2.0, 1.0), 0.08, BONE,
        [Support.lead(sunk, potential=0.3), Support.lead(metal)],
        [Load.lead(3.0, fed)], m=3, surface=surface,
    ).solve(tolerance=1e-12)  # fmt: skip
    parts = solution.discretisation
    area = parts.family.cell_area
    supplied = float((parts.load * np.nan_to_num(solution.unknowns)).sum()) * area
    supplied += 0.3 * supply(solution, sunk)
    assert recovery.dissipation(solution).sum() * area == pytest.approx(supplied, rel=1e-9)
    with pytest.raises(TypeError, match="electrical conduction only"):
        recovery.dissipation(body().solve())


@pytest.mark.parametrize("thickness", [0.25, lambda x, y: 0.25 + 0 * x])
def test_a_thickness_makes_powers_less_and_temperatures_the_same(thickness):
    whole, thin = run(body()), run(body(thickness=thickness))
    assert thin.made == pytest.approx(0.25 * whole.made, rel=1e-8)
    assert thin.imbalance < 1e-8
    hottest = np.nanmax(whole.heat.temperature)
    assert np.nanmax(thin.heat.temperature) == pytest.approx(hottest, rel=1e-8)


def test_a_bar_heats_as_a_parabola_and_grows():
    """σ V²/(8 κ) in the middle, whatever the expansion's sign."""
    region, spacing = rectangle(2.0, 0.5), 0.05
    common = {"region": region, "spacing": spacing, "m": 3, "surface": "extrapolated"}

    def end(side):
        return lambda x, y: side * x > 1.0 - 1e-6

    current = Scene(
        material=ElectricConductivityTensor.isotropic(3.0),
        supports=[Support.edge(end(1), potential=2.0), Support.edge(end(-1), potential=0.0)],
        **common,
    ).solve()
    cold = [Support.edge(end(s), temperature=0.0) for s in (1, -1)]
    thermal = Scene(material=ConductivityTensor.isotropic(0.5), supports=cold, **common)
    heat = joule.heated(thermal, current).solve()
    x = heat.points[:, 0]
    assert heat.temperature == pytest.approx(3.0 * (1 - x**2), abs=0.02)
    held = Support.where(lambda x, y: x < -0.9, displacement=(0.0, 0.0), rotation=0.0)
    elastic = Scene(material=ElasticTensor.isotropic(1.0, 0.2), supports=[held], **common)
    grown = [
        joule.expanded(elastic, heat, ExpansionTensor.isotropic(alpha)).solve().displacement[-1, 0]
        for alpha in (0.01, -0.01)
    ]
    assert grown[0] == pytest.approx(0.01 * 3.0 * 4 / 3, rel=0.03)
    assert grown[1] == pytest.approx(-grown[0], rel=1e-6)


def test_fields_and_refusals(tmp_path):
    chain = run(body())
    assert {"displacement", "temperature", "potential", "joule_heat"} <= set(chain.fields())
    assert chain.summary()["imbalance"] < 1e-8
    assert np.load(chain.write(tmp_path / "fuse")[1])["temperature"].shape == (len(chain.points),)
    other = Inclusion(rectangle(0.4, 0.4), ElasticTensor.isotropic(2.0, 0.2))
    with pytest.raises(SceneError, match="know one solid"):
        run(body(inclusions=[other]))
    with pytest.raises(SceneError, match="heat strains an elastic body"):
        run(chain.current.scene)
    with pytest.raises(SceneError, match="without a voltage"):
        run(body(), voltage=0.0)
    with pytest.raises(SceneError, match="conductivities must be positive"):
        run(body(), conductivities=(1.0, -1.0))
    other = Scene(rectangle(1.0, 1.0), 0.08, ConductivityTensor.isotropic(1.0),
                  [Support.layer(1.5, temperature=0.0)], m=3)  # fmt: skip
    with pytest.raises(SceneError, match="their particles differ"):
        joule.heated(other, chain.current).solve()
