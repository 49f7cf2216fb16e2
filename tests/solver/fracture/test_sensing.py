"""Damage sensing: the drop follows the bonds that break, as a drawn crack would have it."""

from dataclasses import replace

import numpy as np
import pytest

from solver import (
    Crack,
    ElasticTensor,
    ElectricConductivityTensor,
    Load,
    MechanismError,
    Programme,
    Scene,
    SceneError,
    Support,
    Toughness,
    rectangle,
)
from solver.analyses.statics import solve
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
        "surface": "none",
        **changes,
    }
    return Scene(spacing=1.0 / strip.N, material=CONDUCTOR, m=strip.M, **settings)


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
    whole = sensor.read(sensor.solve(np.zeros_like(growth.broken)))
    assert drop[0] == pytest.approx(whole, rel=1e-8)


@pytest.mark.parametrize("surface", ["none", "volume"])
def test_what_is_kept_between_readings_gives_what_a_fresh_solve_gives(surface):
    mechanical = replace(strip.scene(), surface=surface)
    sensor, fresh = Sensor(conductor(surface=surface), top, bottom), []

    def read(growth):
        try:
            fresh.append(sensor.read(sensor.solve(growth.broken)))
        except MechanismError:
            fresh.append(np.inf)
        return sensor(growth)

    growth = run(read, mechanical)
    drop = np.array(growth.history.drop)
    parted = np.isinf(drop)
    assert (parted == np.isinf(fresh)).all()
    assert drop[~parted] == pytest.approx(np.array(fresh)[~parted], rel=1e-7)
    assert np.ptp(drop[~parted]) > 0.1 * drop[0]
    # Another run starts anew.
    assert run(sensor, mechanical).history.drop[0] == pytest.approx(drop[0], rel=1e-8)
    assert sensor.read(sensor.solution(growth)) == pytest.approx(drop[~parted][-1], rel=1e-12)


def test_a_way_that_a_crack_went_is_read_as_a_drawn_crack():
    sensor = Sensor(conductor(), top, bottom)
    scene = conductor()
    (known,) = scene.cracks
    tip = np.array(known.points[-1])
    way = tip + np.array([[0.0, 0.0], [0.1, 0.0], [0.2, 0.05]])
    longer = replace(scene, cracks=[known, Crack(*(tuple(map(float, p)) for p in way))])
    wanted = sensor.read(solve(longer.discretise(sharp_tips=False), 1e-9))
    assert sensor.along(way) == pytest.approx(wanted, rel=1e-9)
    # What has not grown is no crack.
    whole = sensor.read(solve(scene.discretise(sharp_tips=False), 1e-9))
    assert sensor.along(way[:1], np.zeros((0, 2))) == pytest.approx(whole, rel=1e-8)
    assert sensor.along(way) > 1.02 * whole


def test_nothing_is_solved_where_nothing_has_broken():
    sensor, iterations = Sensor(conductor(), top, bottom), []

    def read(growth):
        first = sensor(growth)
        before = sensor.solution(growth).statistics.iterations
        assert sensor(growth) == first
        iterations.append(sensor.solution(growth).statistics.iterations - before)
        return first

    run(read, strip.scene())
    assert not any(iterations)


def test_a_body_away_from_the_origin_reads_the_same():
    found = []
    for x0, y0 in ((0.0, 0.0), (5.0, -3.0)):
        body = rectangle(1.0, 1.0, (x0, y0))

        def ends(x, y, y0=y0):
            return abs(y - y0) > 0.3

        def pulled(x, y, y0=y0):
            return np.stack([0 * x, y - y0], axis=-1)

        common = {"region": body, "spacing": 0.1, "m": 2, "surface": "none",
                  "cracks": [Crack((x0 - 0.6, y0), (x0 - 0.2, y0))]}  # fmt: skip
        mechanical = Scene(material=ElasticTensor.isotropic(1.0, 0.2),
                           supports=[Support.where(ends, displacement=pulled, rotation=0.0)],
                           **common)  # fmt: skip
        up, down = rectangle(2.0, 0.2, (x0, y0 + 0.45)), rectangle(2.0, 0.2, (x0, y0 - 0.45))
        current = Scene(material=CONDUCTOR, supports=[Support.where(down, potential=0.0)],
                        loads=[Load.flux((0.0, -1.0), where=up)], **common)  # fmt: skip
        growth = grow(mechanical, Toughness(1e-3), Programme(stop=1.0),
                      monitors={"drop": Sensor(current, up, down)}, max_solves=4)  # fmt: skip
        found.append(np.array(growth.history.drop))
    assert np.ptp(found[0]) > 0
    np.testing.assert_allclose(found[1], found[0], rtol=1e-6)


def test_a_conductor_that_has_parted_stays_parted():
    """Bonds that break afterwards, on either side, find nothing to be solved."""
    sensor = Sensor(conductor(), top, bottom)
    fake = run(sensor, strip.scene())
    bonds, upper = fake.bonds, fake.points[:, 1] > 0
    _, p, q = bonds.ends(np.arange(bonds.whole.size))
    across = np.nonzero((bonds.strengths.ravel() > 0) & (upper[p] != upper[q]))[0]
    bonds.broken.add(across, len(fake.steps) + 1, 1.0, False)
    assert sensor(fake) == np.inf
    for at in (0.15, -0.15):
        near = np.argmin(np.hypot(fake.points[:, 0] - 0.35, fake.points[:, 1] - at))
        more = np.setdiff1d(bonds.of_particles(np.array([near])), bonds.broken.records["bond"])
        bonds.broken.add(more[:3], len(fake.steps) + 2, 1.0, False)
        assert sensor(fake) == np.inf


def test_a_part_without_a_lead_reads_as_no_number():
    """Its probe floats; the rest of the body is read as ever."""
    sensor = Sensor(conductor(), top, lambda x, y: (abs(x) < 0.06) & (abs(y) < 0.06))
    fake = run(sensor, strip.scene())
    island = np.abs(fake.points).max(axis=1) < 0.11
    bonds = fake.bonds.of_particles(np.nonzero(island)[0])
    fake.bonds.broken.add(bonds, len(fake.steps) + 1, 1.0, False)
    assert np.isnan(sensor(fake))


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
