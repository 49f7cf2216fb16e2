"""Thickness: what it multiplies, what it leaves alone, and bands in series, exactly."""

import numpy as np
import pytest

from solver import (
    ConductivityTensor,
    Crack,
    ElasticTensor,
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
    reactions,
    recovery,
    rectangle,
)
from solver.problem import thickness

SOLID = ElasticTensor.isotropic(1.0, 0.2)
METAL = ConductivityTensor.isotropic(1.0)
BAND = {
    "function": {"thickness": lambda x, y: np.where(np.abs(x) < 0.5, 0.25, 1.0)},
    "inclusion": {
        "thickness": 1.0,
        "inclusions": [Inclusion(rectangle(1, 4), METAL, thickness=0.25)],
    },
}


@pytest.mark.parametrize("how", BAND)
def test_a_thinner_band_in_series_is_exact(how):
    """A quarter of the thickness has four times the gradient, wherever bonds cross the step."""

    def field(x, y):
        return np.where(np.abs(x) < 0.5, 4 * x, np.sign(x) * (1.5 + np.abs(x)))

    held = Support.where(lambda x, y: np.abs(x) > 1.7, temperature=field)
    scene = Scene(rectangle(4, 1), 0.1, METAL, m=3, surface="none", supports=[held], **BAND[how])
    solution = scene.solve(tolerance=1e-13)
    x, y = solution.points.T
    np.testing.assert_allclose(solution.temperature, field(x, y), atol=1e-11)
    inside = (np.abs(y) < 0.2) & (np.abs(x) < 1.4)
    # Of the solid, not of the plate.
    wanted = -np.where(np.abs(x) < 0.5, 4.0, 1.0)
    np.testing.assert_allclose(recovery.flux(solution)[inside, 0], wanted[inside], atol=1e-10)


def test_a_uniaxial_strain_across_a_band_is_exact():
    """Bars that cannot contract: elastic bonds at all angles in series, with ν = 0."""

    def stretch(x, y):
        return np.stack(
            [np.where(np.abs(x) < 0.5, 4 * x, np.sign(x) * (1.5 + np.abs(x))), 0 * y], -1
        )

    scene = Scene(
        rectangle(4, 2), 0.1, ElasticTensor.isotropic(1.0, 0.0), m=3, surface="none",
        supports=[Support.layer(3, displacement=stretch, rotation=0.0)], thickness=1.0,
        inclusions=[Inclusion(rectangle(1, 4), ElasticTensor.isotropic(1.0, 0.0), thickness=0.25)],
    )  # fmt: skip
    solution = scene.solve(tolerance=1e-12)
    # What the end of the interfaces, three cells deep in the support, leaves.
    error = np.abs(solution.displacement - stretch(*solution.points.T)).max()
    assert error < 5e-4 * 3.5


def bent(**changes):
    settings = {
        "supports": [Support.where(lambda x, y: x < -0.8, displacement=0.0)],
        "loads": [
            Load.traction((0.2, 1.0), (1.015, -0.5), (1.015, 0.5)),
            Load.body_force((0.3, -0.2)),
            Load.point((0.1, 0.2), (0.0, 0.5)),
        ],
        "m": 2,
    }
    return Scene(rectangle(2.03, 1.0), 0.1, SOLID, **{**settings, **changes})


@pytest.mark.parametrize("surface", ["volume", "extrapolated"])
@pytest.mark.parametrize("form", ["number", "function", "inclusion"])
def test_one_thickness_for_all_changes_forces_alone(surface, form):
    thick = {
        "number": {"thickness": 0.3},
        "function": {"thickness": lambda x, y: 0.3 + 0 * x},
        "inclusion": {"inclusions": [Inclusion(rectangle(0.6, 0.5), SOLID, thickness=0.3)],
                      "thickness": 0.3},
    }[form]  # fmt: skip
    inclusions = [Inclusion(rectangle(0.6, 0.5), SOLID)] if form == "inclusion" else []
    plain = bent(surface=surface, inclusions=inclusions).solve(tolerance=1e-12)
    found = bent(surface=surface, **thick).solve(tolerance=1e-12)
    size = np.abs(plain.displacement).max()
    np.testing.assert_allclose(found.displacement, plain.displacement, atol=1e-9 * size)
    np.testing.assert_allclose(recovery.stress(found), recovery.stress(plain), atol=1e-8)
    energy = recovery.strain_energy_density
    np.testing.assert_allclose(energy(found), energy(plain), atol=1e-8)

    def clamp(x, y):
        return x < -0.8

    force = reactions.reaction(found, clamp).force
    np.testing.assert_allclose(force, 0.3 * reactions.reaction(plain, clamp).force, atol=1e-9)


@pytest.mark.parametrize("how", BAND)
def test_sources_act_on_what_is_there(how):
    """The heat that leaves through the support is that of the volume, edges cut or not."""
    held = Support.where(lambda x, y: x > 1.7, temperature=0.0)
    scene = Scene(rectangle(4, 1.03), 0.1, METAL, m=2, surface="extrapolated", supports=[held],
                  loads=[Load.source(2.0)], **BAND[how])  # fmt: skip
    solution = scene.solve(tolerance=1e-12)
    given = 2.0 * 1.03 * (3.0 + 0.25)
    # What acts on held particles leaves there, too.
    assert reactions.supply(solution, lambda x, y: x > 1.7) == pytest.approx(-given, rel=1e-8)


@pytest.mark.parametrize("part", [rectangle(0.43, 0.43), disc(0.237, (0.1, 0.05))])
@pytest.mark.parametrize("where", [None, rectangle(0.53, 0.31, (0.1, 0.0))])
def test_the_weight_of_an_inclusion_is_that_of_its_own_area(part, where):
    """An interface that cuts cells parts what acts on them: weight is thickness × area."""
    body = rectangle(2.0, 1.2)
    scene = Scene(body, 0.05, SOLID, m=2, surface="extrapolated",
                  supports=[Support.where(lambda x, y: x < -0.8, displacement=0.0)],
                  loads=[Load.body_force((0.0, -1.0), where)],
                  inclusions=[Inclusion(part, SOLID, thickness=20.0)])  # fmt: skip
    fine = 0.05 / 16
    loaded = (body if where is None else where).outline(fine)
    inside = loaded.intersection(part.outline(fine)).area
    given = loaded.area + 19.0 * inside
    force = reactions.reaction(scene.solve(), lambda x, y: x < -0.8).force
    # The disc's chords leave out 1e-4 of it.
    assert force[1] == pytest.approx(given, rel=3e-4)


def test_a_smooth_taper_is_of_second_order():
    errors = []
    for cells in (20, 40):
        h = 1 / cells
        held = Support.where(
            lambda x, y, h=h: np.abs(x) > 1 - 3 * h, temperature=lambda x, y: np.log(2 + x)
        )
        scene = Scene(rectangle(2, 1), h, METAL, m=3, surface="none", supports=[held],
                      thickness=lambda x, y: 2 + x)  # fmt: skip
        solution = scene.solve()
        errors.append(np.abs(solution.temperature - np.log(2 + solution.points[:, 0])).max())
    assert errors[1] < 2e-5
    assert np.log2(errors[0] / errors[1]) > 1.6


def test_frequencies_do_not_depend_on_one_thickness():
    plates = [
        Scene(rectangle(1.0, 1.0), 0.1, SOLID, m=2, density=1.0, thickness=thick)
        for thick in (None, 0.01, lambda x, y: 0.01 + 0 * x)
    ]
    found = [modes.solve(plate, 3).frequencies for plate in plates]
    np.testing.assert_allclose(found[1], found[0], rtol=1e-7)
    np.testing.assert_allclose(found[2], found[0], rtol=1e-7)


def grown(thick):
    grips = [Support.where(lambda x, y, s=s: s * y > 0.35, u2=s, u1=0.0) for s in (-1.0, 1.0)]
    scene = Scene(rectangle(1.0, 1.0), 0.1, SOLID, m=2, supports=grips, surface="extrapolated",
                  cracks=[Crack((-0.5, 0.0), (0.0, 0.0))], thickness=thick)  # fmt: skip
    return fracture.grow(scene, Toughness(1.0), Programme(stop=3.0, control="following"))


def test_breaking_costs_what_is_broken():
    """The same bonds at the same loads; work and dissipation times the thickness."""
    plain = grown(None)
    for thick in (0.2, lambda x, y: 0.2 + 0 * x):
        found = grown(thick)
        np.testing.assert_array_equal(found.broken_bonds, plain.broken_bonds)
        np.testing.assert_allclose(found.history.load_factor, plain.history.load_factor, rtol=1e-6)
        for name in ("work", "stored", "dissipated", "force"):
            np.testing.assert_allclose(
                found.history[name],
                0.2 * plain.history[name],
                atol=1e-6 * plain.history[name].max(),
            )
    # Half of the thickness ahead of the crack: it breaks there for half of the energy.
    thin = grown(lambda x, y: np.where(x > 0, 0.5, 1.0))
    assert thin.history.dissipated[-1] == pytest.approx(
        0.5 * plain.history.dissipated[-1], rel=0.15
    )
    assert np.abs(thin.history.imbalance).max() < 1e-6 * np.abs(thin.history.work).max()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"thickness": 0.0}, "thickness must be positive"),
        ({"thickness": "thin"}, "thickness must be positive"),
        (
            {"inclusions": [Inclusion(disc(0.2), SOLID, thickness=-1.0)]},
            "thickness must be positive",
        ),
        (
            {
                "thickness": lambda x, y: 1 + x,
                "inclusions": [Inclusion(disc(0.2), SOLID, thickness=1.0)],
            },
            "as a function of the scene, or as numbers",
        ),
        ({"inclusions": [Inclusion(disc(0.2), SOLID, thickness=abs)]}, "is a number"),
    ],
)
def test_what_is_no_thickness(changes, message):
    with pytest.raises(SceneError, match=message):
        bent(**changes)


def test_a_function_that_is_no_thickness_somewhere():
    with pytest.raises(SceneError, match="the thickness is -"):
        bent(thickness=lambda x, y: x).solve()
    with pytest.raises(SceneError, match="knows no time"):
        bent(thickness=lambda x, y, t: x).solve()


def test_shares_of_cells():
    cells, shares = thickness._shares(3, 1)
    assert cells == ((0, 0), (1, 0), (2, 1), (3, 1))
    np.testing.assert_allclose(shares, [1 / 6, 1 / 3, 1 / 3, 1 / 6])
    # Through corners: half of it in either end.
    assert thickness._shares(1, -1)[0] == ((0, 0), (1, -1))
    np.testing.assert_allclose(thickness._shares(2, 0)[1], [0.25, 0.5, 0.25])
