"""Calibrated tips in scenes: which are, which are left, and what is refused by name."""

from dataclasses import replace

import numpy as np
import pytest

from solver import (
    ConductivityTensor,
    Crack,
    ElasticTensor,
    Load,
    Scene,
    SceneError,
    Support,
    disc,
    fracture,
    modes,
    recovery,
    rectangle,
)
from solver.analyses import joule, piezoresistive, thermoelastic
from solver.fracture import sensed
from solver.reactions import reaction, residual

PAPER = np.array([[1.0, 1 / 5, 1 / 10], [1 / 5, 4 / 5, 1 / 6], [1 / 10, 1 / 6, 1 / 3]])
M = 2
ANGLE = np.radians(27.0)
ALONG = np.array([np.cos(ANGLE), np.sin(ANGLE)])


def cracked(displacement=lambda x, y: np.stack([0.2 * y, y], -1), half=9.3, **settings):
    """A disc of 19 cells with a crack through its middle."""
    end = half * ALONG
    given = {
        "region": disc(19.0),
        "spacing": 1.0,
        "m": M,
        "material": ElasticTensor(PAPER),
        "surface": "extrapolated",
        "cracks": [Crack(tuple(-end), tuple(end))],
        "supports": [Support.layer(cells=M + 0.5, displacement=displacement, rotation=0.0)],
        "tip": "calibrated",
    }
    return Scene(**(given | settings))


def test_a_stress_along_the_crack_stays_exact():
    """Between rows and of whole cells, where the faces themselves do not err."""
    e11, e22, shear = np.linalg.solve(PAPER, [1.0, 0.0, 0.0])

    def along(x, y):
        return np.stack([e11 * x + 0.5 * shear * y, 0.5 * shear * x + e22 * y], axis=-1)

    solution = cracked(along, cracks=[Crack((-9.0, 0.0), (9.0, 0.0))]).solve(tolerance=1e-13)
    assert len(solution.discretisation.operator.tips) == 2
    exact = along(*solution.points.T)
    assert np.abs(solution.displacement - exact).max() < 1e-9 * np.abs(exact).max()


def test_energy_and_reactions_count_what_tips_add():
    """Free particles are in balance, and the sum of the densities has what tips add."""
    solution = cracked().solve(tolerance=1e-12)
    parts = solution.discretisation
    rows = residual(parts, solution.unknowns)
    assert np.abs(rows[~parts.prescribed]).max() < 1e-9 * np.abs(rows).max()
    assert np.abs(reaction(solution, lambda x, y: x * x + y * y > 1).force).max() < 1e-9
    added = sum(tip.energy(solution.unknowns[:, tip.particles]) for tip in parts.operator.tips)
    assert added != 0.0
    without = replace(cracked(), tip="drawn").discretise(constrained=True)
    alone = recovery.strain_energy_density(replace(solution, discretisation=without)).sum()
    whole = recovery.strain_energy_density(solution).sum()
    assert whole - alone == pytest.approx(added, rel=1e-9)


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"cracks": [Crack((-40.0, 0.0), (14.2, 0.0))]}, "held particle"),
        ({"cracks": [Crack((-5.0, -2.0), (0.3, 0.2), (4.0, 9.0))]}, "bend"),
        ({"cracks": [Crack((-9.0, 0.5), (6.2, 0.5))]}, "runs through particles"),
        ({"half": 2.9}, "another"),
    ],
)
def test_tips_near_something_else_are_left_and_told(change, why):
    solution = cracked(**change).solve()
    assert any("is not calibrated" in line and why in line for line in solution.statistics.warnings)


def tips_of(cracks, side=30.0, **settings):
    """How many tips are calibrated in a square whose ends are held, and what is told of others."""
    ends = Support.where(lambda x, y: abs(y) > 0.5 * side - M - 0.6, displacement=0.0, rotation=0.0)
    scene = cracked(
        cracks=cracks, **({"region": rectangle(side, side), "supports": [ends]} | settings)
    )
    parts = scene.discretise(constrained=True)
    return len(parts.operator.tips), parts.tips_left


def test_tips_that_share_particles_are_both_left():
    """Whichever was drawn first: else a symmetric body would answer unsymmetrically, by 3 %."""
    facing = [Crack((-30.0, 0.0), (-3.3, 0.0)), Crack((3.3, 0.0), (30.0, 0.0))]
    for cracks in (facing, facing[::-1]):
        count, told = tips_of(cracks)
        assert count == 0
        assert sum("another tip" in line for line in told) == 2


@pytest.mark.parametrize(
    "cracks",
    [
        [Crack((-20.0, -0.45), (-3.0, 0.25), (0.0, 0.25))],
        [Crack((-30.0, 0.0), (0.0, 0.0)), Crack((-30.0, 0.3), (-0.5, 0.3))],
    ],
)
def test_bonds_that_end_elsewhere_tell_bends_and_neighbours_within_a_cell(cracks):
    """The same bonds are cut there as by a straight crack."""
    count, told = tips_of(cracks)
    assert count == 0
    assert "a bend or another crack" in told[0]


def test_a_crack_drawn_in_two_is_one():
    count, told = tips_of([Crack((-20.0, -10.1), (-4.0, -2.1), (0.0, -0.1))])
    assert (count, told) == (1, ())


def test_particles_on_the_crack_a_horizon_behind_count():
    """Named for what they are: negative energies, or factors of 0.06, were what came of them."""
    count, told = tips_of([Crack((-5.7, -7.6), (5.7, 7.6))], side=31.0)
    assert count == 0
    assert len(told) == 2
    assert all("runs through particles" in line for line in told)


def test_mechanics_of_a_strained_conductor_may_be_calibrated():
    ends = Support.where(lambda x, y: abs(y) > 6.4, displacement=[0.0, 0.0], rotation=0.0)
    scene = cracked(
        region=rectangle(18.0, 18.0), cracks=[Crack((-30.0, 0.0), (0.2, 0.0))], supports=[ends]
    )
    resistor = piezoresistive.run(
        scene, 2.0, lambda x, y: y > 8, lambda x, y: y < -8, (1.0, 1.0), tolerance=1e-6
    )
    assert len(resistor.mechanics.discretisation.operator.tips) == 1


def test_loads_around_a_tip_are_told_of():
    tip = 9.3 * ALONG

    def force(x0, y0):
        about = {"where": lambda x, y: np.hypot(x - x0, y - y0) < 1.5}
        return Load.body_force((0.0, 1e-3), **about)

    near, far = force(*tip), force(0.0, 0.0)
    scene = cracked()

    def said(load):
        warnings = replace(scene, loads=[load]).solve().statistics.warnings
        return [w for w in warnings if "loads act on particles around 1 calibrated" in w]

    assert said(near)
    assert not said(far)


def test_a_body_that_current_heats_refuses_it_by_that_name():
    def up(x, y):
        return y > 8

    def down(x, y):
        return y < -8

    with pytest.raises(SceneError, match="no temperature strains"):
        joule.run(cracked(), up, down, down, 1.0, (1.0, 1.0), (1.0, 1.0), (1e-6, 1e-6))
    with pytest.raises(SceneError, match="no temperature strains"):
        thermoelastic.motion(cracked(density=1.0), (1.0, 1.0), (1e-6, 1e-6), 1.0, 300.0, 1e-3, 2)


def test_a_crack_that_grows_and_is_sensed_refuses_it_as_one_that_grows():
    def up(x, y):
        return y > 8

    def down(x, y):
        return y < -8

    with pytest.raises(SceneError, match="with fracture"):
        sensed.run(
            cracked(),
            (1.0, 1.0),
            up,
            down,
            up,
            down,
            G1=1.0,
            max_solves=2,
        )


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"tip": "sharp"}, "'drawn' or 'calibrated'"),
        ({"cracks": []}, "the scene has none"),
        ({"surface": "volume"}, "surface='extrapolated'"),
        (
            {
                "material": ConductivityTensor.isotropic(1.0),
                "supports": [Support.layer(cells=2, temperature=0.0)],
            },
            "elastic bodies",
        ),
        ({"thickness": lambda x, y: 1.0 + 0.0 * x}, "one thickness"),
        ({"material": ElasticTensor.isotropic(1.0, 0.4)}, "C66 < C12"),
    ],
)
def test_what_cannot_be_calibrated_is_refused_by_name(change, why):
    with pytest.raises(SceneError, match=why):
        cracked(**change).solve()


def test_cracks_that_grow_and_bodies_that_move_refuse_it():
    with pytest.raises(SceneError, match="with fracture"):
        fracture.grow(cracked(), 1.0, max_solves=3)
    with pytest.raises(SceneError, match="statics only"):
        modes.solve(cracked(density=1.0), 2)
