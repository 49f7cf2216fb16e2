"""Damage sensing: the drop follows the bonds that break, as a drawn crack would have it."""

import numpy as np
import pytest

from solver import (
    Crack,
    ElectricConductivityTensor,
    Load,
    Programme,
    Scene,
    SceneError,
    Support,
    Toughness,
    rectangle,
)
from solver.fracture import grow
from solver.fracture.sensing import Sensor
from tests.solver.fracture import strip


def top(x, y):
    return y > 0.25


def bottom(x, y):
    return y < -0.25


CONDUCTOR = ElectricConductivityTensor.of_resistivities(170.0, 540.0)


def conductor(**changes) -> Scene:
    mechanical = strip.scene()
    settings = {
        "cracks": mechanical.cracks,
        "region": mechanical.region,
        "supports": [Support.where(bottom, potential=0.0)],
        "loads": [Load.lead(1.0, top)],
        **changes,
    }
    return Scene(spacing=1.0 / strip.N, material=CONDUCTOR, m=strip.M, surface="none", **settings)


def run(monitor, mechanical, **options):
    return grow(mechanical, Toughness(1e-3), Programme(stop=1.0), monitors={"drop": monitor},
                max_solves=30, **options)  # fmt: skip


def test_the_drop_rises_with_the_crack_and_is_that_of_the_broken_bonds():
    mechanical = strip.scene()
    sensor = Sensor(conductor(), top, bottom)
    growth = run(sensor, mechanical)
    drop = np.array(growth.history.drop)
    known = drop[np.isfinite(drop)]
    assert (np.diff(known) > -1e-6 * known[0]).all()
    assert known[-1] > 1.1 * known[0]
    # Without a broken bond it is the intact scene's, whose crack is as blunt as one that grows.
    assert drop[0] == sensor.read(sensor.solve(np.zeros_like(growth.broken)))


def test_bonds_broken_along_a_line_resist_as_a_crack_does():
    """The bonds that a longer crack would cut, broken one by one instead."""
    longer = [Crack((-0.6, 0.0), (0.2, 0.0))]
    drawn = Scene(strip.scene().region, 0.1, CONDUCTOR, [Support.where(bottom, potential=0.0)],
                  [Load.lead(1.0, top)], m=strip.M, surface="none", cracks=longer)  # fmt: skip
    parts = drawn.discretise(sharp_tips=False)
    half = parts.family.size // 2
    cut = np.array([parts.bonds.strength(o) == 0 for o in range(half)])
    rows = np.array([parts.bonds.lattice.points[:, 1] + dy * 0.1 for _, dy in parts.family.offsets])
    inside = (np.abs(rows[:half]) < 0.5) & cut
    sensor = Sensor(conductor(), top, bottom)
    assert sensor.read(sensor.solve(inside)) == pytest.approx(sensor.read(drawn.solve()), rel=1e-6)


def test_what_does_not_fit_is_refused():
    mechanical = strip.scene()
    with pytest.raises(SceneError, match="needs a conductor"):
        Sensor(mechanical, top, bottom)
    other = conductor(region=rectangle(1.0, 1.2))
    with pytest.raises(SceneError, match="their particles differ"):
        run(Sensor(other, top, bottom), mechanical)
    slit = Sensor(conductor(cracks=[Crack((-0.6, 0.0), (0.1, 0.0))]), top, bottom)
    with pytest.raises(SceneError, match="their cracks differ"):
        run(slit, mechanical)
    with pytest.raises(SceneError, match="no particle is where a probe"):
        run(Sensor(conductor(), lambda x, y: x > 9, bottom), mechanical)
    floating = conductor(supports=[])
    with pytest.raises(ValueError, match="floating conductor"):
        run(Sensor(floating, top, bottom), mechanical)
