"""Calibrated tips in scenes: which are, which are left, and what is refused by name."""

from dataclasses import replace

import numpy as np
import pytest

from solver import (
    ConductivityTensor,
    Crack,
    ElasticTensor,
    Scene,
    SceneError,
    Support,
    disc,
    fracture,
    modes,
    recovery,
)
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
