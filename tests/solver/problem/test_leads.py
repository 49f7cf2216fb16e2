"""Leads: what they feed in adds up, and those that cannot be meant are refused."""

import numpy as np
import pytest

from solver import (
    ElasticTensor,
    ElectricConductivityTensor,
    Inclusion,
    Load,
    MechanismError,
    Scene,
    SceneError,
    Support,
    disc,
    polygon,
    recovery,
    rectangle,
)
from solver.reactions import supply

BONE = ElectricConductivityTensor.of_resistivities(170.0, 540.0, 0.4)
BODY = rectangle(2.0, 1.0)
EAST, WEST = rectangle(0.2, 0.2, (0.5, 0.0)), rectangle(0.2, 0.2, (-0.5, 0.0))
GROUND = Support.lead(WEST, potential=0.0)


def scene(loads=(), supports=(), **options):
    return Scene(BODY, 0.05, BONE, supports, loads, m=3, **options)


@pytest.mark.parametrize("surface", ["none", "volume", "extrapolated"])
@pytest.mark.parametrize("where", [EAST, disc(0.13, (0.51, 0.03)), lambda x, y: x > 0.83])
def test_what_a_lead_feeds_in_leaves_by_the_other(surface, where):
    solution = scene([Load.lead(3.0, where)], [GROUND], surface=surface).solve(tolerance=1e-12)
    assert supply(solution, WEST) == pytest.approx(-3.0, rel=1e-9)
    assert abs(supply(solution, where)) < 1e-9


def test_a_lead_of_metal_has_one_potential_and_makes_the_heat_that_it_is_fed():
    loads, supports = [Load.lead(3.0, EAST)], [GROUND, Support.lead(EAST)]
    solution = scene(loads, supports, surface="none").solve(tolerance=1e-12)
    lead = EAST.contains(*solution.points.T)
    at = solution.potential[lead]
    assert np.ptp(at) < 1e-9 * at.mean()
    heat = recovery.joule_heat(solution).sum() * 0.05**2
    assert heat == pytest.approx(3.0 * at.mean(), rel=1e-8)
    still = Support.layer(2.5, displacement=0.0, rotation=0.0)
    elastic = Scene(BODY, 0.1, ElasticTensor.isotropic(1.0, 0.2), [still], m=2).solve()
    with pytest.raises(SceneError, match="conducts nothing"):
        supply(elastic, WEST)


@pytest.mark.parametrize(
    "metal",
    [
        rectangle(0.2, 0.2, (0.5, 0.0)),
        rectangle(0.33, 0.11, (0.415, 0.075)),
        disc(0.17, (0.513, 0.03)),
        polygon([(0.3, -0.2), (0.62, -0.13), (0.44, 0.21)]),
    ],
    ids=["square", "cut", "disc", "triangle"],
)
def test_a_lead_is_a_hole_with_a_held_edge(metal):
    """Bonds end at its rim; those that pass through it end there, too."""
    ends = [Support.where(lambda x, y: np.abs(x) > 0.95, potential=lambda x, y: 0.3 * y)]
    lead = scene(supports=[*ends, Support.lead(metal, potential=1.0)], surface="extrapolated")
    x0, y0, x1, y1 = metal.bounds

    def rim(x, y):
        return (x > x0 - 0.01) & (x < x1 + 0.01) & (y > y0 - 0.01) & (y < y1 + 0.01)

    hole = Scene(BODY - metal, 0.05, BONE, [*ends, Support.edge(rim, potential=1.0)], m=3,
                 surface="extrapolated", phase=(0.0, 0.0))  # fmt: skip
    found, wanted = (s.solve(tolerance=1e-13) for s in (lead, hole))
    outside = ~metal.contains(*found.points.T)
    assert found.points[outside] == pytest.approx(wanted.points, abs=1e-12)
    # Of a round rim the hole's edge has longer chords: a hundredth of a cell apart.
    slack = 1e-2 if isinstance(metal, type(disc(1.0))) else 1e-10
    assert np.abs(found.potential[outside] - wanted.potential).max() < slack


def test_particles_on_the_rim_change_nothing():
    """Whether rows of particles lie on the rim or just beside it."""
    found = []
    for beside in (0.0, 1e-4):
        metal = rectangle(0.33, 0.11, (0.41 + beside, 0.07 + beside))
        found.append(scene(supports=[GROUND, Support.lead(metal, 1.0)]).solve(tolerance=1e-10))
    first, second = (supply(solution, WEST) for solution in found)
    assert first == pytest.approx(second, rel=1e-2)


@pytest.mark.parametrize("floating", [False, True])
def test_a_round_lead_feeds_what_the_ring_says(floating):
    """2π σ V/ln(R/r), at nearly second order, held or floating."""
    errors = []
    for n in (10, 20, 40):
        metal, wanted = disc(0.3), 2 * np.pi / np.log(1 / 0.3)
        ring = Scene(
            disc(1.0), 1.0 / n, ElectricConductivityTensor.isotropic(1.0),
            [Support.edge(lambda x, y: np.hypot(x, y) > 0.9, potential=0.0),
             Support.lead(metal) if floating else Support.lead(metal, 1.0)],
            [Load.lead(wanted, metal)] if floating else [], m=3, surface="extrapolated",
        ).solve(tolerance=1e-11)  # fmt: skip
        if floating:
            errors.append(abs(ring.potential[metal.contains(*ring.points.T)].mean() - 1))
        else:
            errors.append(abs(supply(ring, metal) / wanted - 1))
    assert errors[0] < 0.02
    assert errors[2] < 2e-3
    assert 1.5 < np.log2(errors[0] / errors[2]) / 2 < 2.3


@pytest.mark.parametrize("surface", ["none", "extrapolated"])
def test_cells_stand_for_a_lead_given_by_a_condition(surface):
    """Held particles without a rim were a smaller lead: by 13.9 % at 12 cells, 7.4 % at 24."""

    def potential(x, y):
        return np.log(np.hypot(x, y)) / np.log(0.3)

    far = Support.where(lambda x, y: np.hypot(x, y) >= 1.0, potential=potential)
    metal = Support.lead(lambda x, y: np.hypot(x, y) <= 0.3, 1.0)
    conductor = ElectricConductivityTensor.isotropic(1.0)
    for n, bound in ((20, 0.008), (40, 0.004)):
        ring = Scene(disc(1.3), 1.0 / n, conductor, [far, metal], m=5, surface=surface).solve()
        wanted = 2 * np.pi / np.log(1 / 0.3)
        inside = disc(0.35)
        assert supply(ring, inside) == pytest.approx(wanted, rel=bound)
        said = [w for w in ring.statistics.warnings if "given by a condition" in w]
        assert len(said) == 1
        assert "about (0, 0)" in said[0]
        assert f"its size to {100 / np.sqrt(np.pi) / 0.3 / n:.0f}%" in said[0]
    # One that is whole cells is that region.
    box = rectangle(0.2, 0.2, (0.5, 0.0))
    drawn, asked = (
        scene(supports=[GROUND, Support.lead(w, 1.0)]).solve(tolerance=1e-12)
        for w in (box, lambda x, y: (abs(x - 0.5) < 0.1) & (abs(y) < 0.1))
    )
    assert supply(asked, WEST) == pytest.approx(supply(drawn, WEST), rel=1e-10)


@pytest.mark.parametrize(
    ("loads", "supports", "message"),
    [
        ([Load.lead(1.0, EAST), Load.lead(-1.0, WEST)], [], "floating conductor"),
        ([], [Support.lead(EAST)], "floating conductor"),
        ([Load.lead(1.0, rectangle(0.2, 0.2, (5.0, 0.0)))], [GROUND], "outside the body"),
        ([Load.lead(1.0, rectangle(0.2, 0.2, (1.0, 0.0)))], [GROUND], "50% of the lead"),
        ([], [GROUND, Support.lead(rectangle(0.2, 0.2, (-0.3, 0.0)), 1.0)], "touch"),
        ([Load.lead(1.0, EAST), Load.lead(1.0, disc(0.1, (0.5, 0.2)))], [GROUND], "touch"),
        ([Load.lead(1.0, EAST)], [GROUND, Support.lead(EAST, 0.0)], "would be lost"),
        ([Load.lead(1.0, EAST)], [Support.layer(3.5, potential=0.0),
                                  Support.where(EAST, potential=1.0)], "would be lost"),
        ([], [Support.where(EAST, temperature=0.0)], "no temperature to prescribe"),
        ([Load.body_force((0.0, 1.0))], [GROUND], "a force does not act on an electrically"),
    ],
)  # fmt: skip
def test_what_cannot_be_meant_is_refused(loads, supports, message):
    with pytest.raises((SceneError, MechanismError), match=message):
        scene(loads, supports).solve()


def test_metal_beside_inclusions_is_refused_by_name():
    other = Inclusion(rectangle(0.1, 0.1), ElectricConductivityTensor.isotropic(3.0))
    with pytest.raises(SceneError, match="leads on metal"):
        scene([], [GROUND, Support.lead(EAST, 1.0)], inclusions=[other]).solve()


def test_a_lead_s_current_is_a_number():
    with pytest.raises(SceneError, match="finite number"):
        Load.lead(float("nan"), EAST)
    with pytest.raises(ValueError, match="resistivities must be positive"):
        ElectricConductivityTensor.of_resistivities(170.0, 0.0)


def test_an_isolated_part_is_named():
    """A slit that cuts the plate leaves the part with the lead floating."""
    from solver import Crack

    with pytest.raises(MechanismError, match=r"the part about .* is a floating conductor"):
        scene([Load.lead(1.0, EAST)], [GROUND], cracks=[Crack((0.0, -0.6), (0.0, 0.6))]).solve()
