"""The fracture engine: by hand on one and two bonds, then against the exact reference."""

import os
import signal
import subprocess
import sys
from dataclasses import replace

import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import (
    Crack,
    ElasticTensor,
    ExpansionTensor,
    Load,
    PolarTensor,
    Scene,
    SceneError,
    Support,
    fracture,
    recovery,
    rectangle,
    threads,
)
from solver.bonds import Bonds
from solver.fracture import Programme
from tests.solver.bodies import block, few
from tests.solver.fracture.one_bond_at_a_time import grow_singly

STIFF = np.array([[3.0, 0.8, 0.2], [0.8, 2.0, 0.1], [0.2, 0.1, 1.1]])
SOFT = ElasticTensor.isotropic(1.0, 0.2)


def chain(length, load=None, **end):
    """Particles in a row that can only move along it; the first is held, bonds reach one cell."""
    supports = [
        Support.where(lambda x, y: x < length, u2=0.0, rotation=0.0),
        Support.where(lambda x, y: x < 1, u1=0.0),
    ]
    if end:
        supports.append(Support.where(lambda x, y: x > length - 1, **end))
    return Scene(
        block(length, 1), 1.0, SOFT, m=1, area_rule="partial", calibration="continuum",
        surface="none", supports=supports, loads=[] if load is None else [load],
    )  # fmt: skip


def pair(scene):
    """Stiffness E of the energy ½ E u² of one bond of unit length, and its pair volume."""
    parts = scene.discretise()
    o = int(np.flatnonzero((parts.family.offsets == [1, 0]).all(axis=1))[0])
    weight = parts.family.weight[o] * parts.family.cell_area**2
    return parts.moduli.normal[o] * weight, weight


def test_one_bond_under_a_load():
    scene = chain(2, Load.body_force((1.0, 0.0), where=lambda x, y: x > 1))
    stiffness, volume = pair(scene)
    run = fracture.grow(scene, 0.03, Programme(stop=10.0))
    # u = F/E, and ½ E u² = w_c V.
    cost = 0.03 * volume
    critical = np.sqrt(2 * cost * stiffness)
    assert run.history.load_factor[-1] == pytest.approx(critical, rel=1e-12)
    assert run.history.work[-1] == pytest.approx(critical**2 / stiffness / 2, rel=1e-12)
    assert run.history.displacement[-1] == pytest.approx(critical / stiffness, rel=1e-12)
    assert run.history.stored[-1] == pytest.approx(cost, rel=1e-12)
    assert "come loose" in run.reason
    assert len(run.broken_bonds) == 1
    # A body that bears the load comes to the programme's end.
    strong = fracture.grow(scene, 0.03, Programme(stop=0.99 * critical))
    assert strong.reason == "the programme is done"
    assert strong.history.load_factor[-1] == 0.99 * critical
    assert not len(strong.broken_bonds)


def test_two_bonds_of_which_one_must_not_break():
    scene = chain(3, u1=1.0)
    stiffness, volume = pair(scene)
    run = fracture.grow(
        scene, 0.03, Programme(stop=100.0), no_fail=[lambda x, y: x < 1], monitors={"twice": lambda
        run: 2 * run.load_factor}
    )  # fmt: skip
    cost = 0.03 * volume
    # Each bond is stretched by λ/2.
    critical = 2 * np.sqrt(2 * cost / stiffness)
    h = run.history
    event = np.flatnonzero(h.broken)[0]
    assert h.load_factor[event] == pytest.approx(critical, rel=1e-12)
    # The other bond relaxes: its energy, equal to the first's, is excess.
    assert h.work[event] == pytest.approx(2 * cost, rel=1e-12)
    assert h.stored[event] == pytest.approx(0.0, abs=1e-15)
    assert h.dissipated[event] == pytest.approx(cost, rel=1e-12)
    assert h.excess[event] == pytest.approx(cost, rel=1e-12)
    assert h.force[event] == pytest.approx(0.0, abs=1e-14)
    assert h.twice[event] == 2 * h.load_factor[event]
    assert run.reason == "the body has parted"
    np.testing.assert_array_equal(run.damage, [0.0, 0.5, 1.0])


def test_two_equal_bonds_break_together_and_leave_the_middle_loose():
    run = fracture.grow(chain(3, u1=1.0), 0.03, Programme(stop=100.0), batch=1)
    assert len(run.broken_bonds) == 2
    assert run.loose.tolist() == [False, True, False] or "come loose" in run.reason


def plate(voigt=STIFF, size=9, surface="volume", loads=(), **options):
    """A plate with an edge crack, pulled up and sheared by its upper rows."""
    supports = [
        Support.where(lambda x, y: y < 1, displacement=(0.0, 0.0), rotation=0.0),
        Support.where(lambda x, y: y > size - 1, displacement=(0.3, 1.0)),
    ]
    return Scene(
        block(size + 1, size), 1.0, ElasticTensor(voigt), m=2, surface=surface, loads=loads,
        supports=supports, cracks=[Crack((-1.0, 4.7), (3.2, 4.9))], **options,
    )  # fmt: skip


@pytest.mark.parametrize(("seed", "surface"), [(1, "none"), (2, "volume"), (3, "extrapolated")])
def test_one_bond_at_a_time_is_the_exact_sequence(seed, surface):
    rng = np.random.default_rng(seed)
    tensor = STIFF + 0.05 * np.diag(rng.uniform(-1, 1, 3))
    scene = plate(tensor, surface=surface, loads=[Load.body_force((0.0, 1e-3))], loose="drop")
    half = scene.family().size // 2
    critical = np.tile(rng.uniform(0.8, 1.2, half), 2)
    exact = grow_singly(scene, critical, 8)
    whole = scene.discretise(sharp_tips=False).bonds.ended

    def parted(run):
        # The reference knows no cracks that cut bonds which end at the surface.
        return whole is not None and len(run.body.bonds.ended) < len(whole)

    run = fracture.grow(
        scene,
        critical,
        Programme(stop=1e6),
        batch=1,
        max_solves=2 * len(exact) + 2,
        tolerance=1e-12,
        until=parted,
    )
    breaks = run.breaks
    steps = np.unique(breaks["step"])
    assert len(exact) == 8
    assert len(steps) >= (8 if whole is None else 3)
    for step, event in zip(steps, exact, strict=False):
        mine = breaks[breaks["step"] == step]
        assert set(zip(mine["offset"].tolist(), mine["origin"].tolist(), strict=True)) == (
            event.bonds
        )
        np.testing.assert_allclose(mine["load_factor"], event.factor, rtol=1e-7)
    # A toughness one per cent higher is not the same sequence of loads.
    other = fracture.grow(scene, 1.01 * critical, Programme(stop=1e6), batch=1, max_solves=3)
    ratio = other.breaks["load_factor"][0] / breaks["load_factor"][0]
    assert ratio == pytest.approx(np.sqrt(1.01), rel=1e-6)


def test_batches_end_where_single_bonds_end():
    scene = plate(loose="drop")
    runs = [
        fracture.grow(scene, 1.0, Programme(stop=1e6), batch=b, until=lambda r: r.advance >= 3)
        for b in (1, 4, 8)
    ]
    peaks = [run.history.load_factor.max() for run in runs]
    # A family of 20 bonds and 3 cells of growth: the coarsest body there is.
    np.testing.assert_allclose(peaks, peaks[0], rtol=0.01)
    for run in runs[1:]:
        assert np.linalg.norm(run.tip - runs[0].tip) <= scene.m * scene.spacing


@pytest.mark.parametrize("material", [SOFT, PolarTensor(SOFT, 2.0 * np.eye(2))])
def test_energies_balance_with_bonds_that_end_at_the_surface(material):
    scene = slit(0.4, surface="extrapolated", material=material)
    run = fracture.grow(scene, 1.0, max_solves=15, tolerance=1e-10)
    h = run.history
    assert h.broken[-1] > 10
    assert np.abs(h.imbalance).max() <= 1e-8 * h.work.max()
    own = run.body.surface_energy()
    # The balance would see one per cent of what is stored in bonds that end.
    assert 0.01 * own > 1e-6 * h.stored[-1] / run.load_factor**2


@pytest.mark.parametrize("surface", ["none", "volume"])
@pytest.mark.parametrize("material", [SOFT, PolarTensor(SOFT, 0.5 * np.eye(2))])
def test_energies_balance_under_temperatures(material, surface):
    """Held ends and a body that shrinks: what cooling does is work, what breaks is booked."""
    held = Support.where(lambda x, y: (x < 1) | (x > 13), displacement=0.0, rotation=0.0)
    change = lambda x, y: -1.0 + 0.05 * y  # noqa: E731
    cold = Load.temperature(change, ExpansionTensor([[1.0, 0.2], [0.2, 0.5]]))
    scene = Scene(
        block(14, 9), 1.0, material, [held], [cold, Load.body_force((0.0, 1e-3))], m=2,
        surface=surface, cracks=[Crack((6.7, -1.0), (6.7, 2.2))], loose="drop",
    )  # fmt: skip
    run = fracture.grow(scene, 1.0, Programme(stop=1e6), max_solves=20, tolerance=1e-11)
    h = run.history
    assert h.dissipated[-1] > 0
    assert np.abs(h.imbalance).max() <= 1e-8 * h.work.max()
    assert 0.01 * h.dissipated[-1] > 1e-6 * h.work.max()
    # What a solve of the broken body says of its stress is what the run says, which solves
    # coarsely within an avalanche.
    solution = run.solution
    broken = replace(scene, broken=lambda lattice, family: run.broken).solve(tolerance=1e-11)
    kept = ~run.loose
    written = run.fields()["temperature"]
    np.testing.assert_allclose(written, run.load_factor * change(*run.points.T), rtol=1e-12)
    np.testing.assert_allclose(
        run.load_factor * recovery.stress(broken)[kept],
        recovery.stress(solution)[kept],
        atol=1e-4 * np.abs(recovery.stress(solution)[kept]).max(),
    )


def test_free_expansion_breaks_nothing():
    corner = [
        Support.where(lambda x, y: (x < 1) & (y < 1), displacement=(0.0, 0.0)),
        Support.where(lambda x, y: (x > 6) & (x < 7) & (y < 1), u2=0.0),
    ]
    hot = Load.temperature(lambda x, y: 1.0 + x - 2 * y, ExpansionTensor([[1.0, 0.2], [0.2, 0.5]]))
    run = fracture.grow(
        Scene(block(9, 7), 1.0, SOFT, corner, [hot], m=2), 1e-6, Programme(stop=10.0)
    )
    assert not len(run.broken_bonds)
    with pytest.raises(SceneError, match="end at the surface cannot be broken under temperatures"):
        fracture.grow(
            Scene(block(9, 7), 1.0, SOFT, corner, [hot], m=2, surface="extrapolated"),
            1e-6,
            max_solves=1,
        )


@few
@given(
    st.integers(0, 10**6),
    st.sampled_from(["fixed", "following"]),
    st.integers(1, 9),
    st.sampled_from(["volume", "extrapolated"]),
)
def test_energies_balance(seed, control, batch, surface):
    rng = np.random.default_rng(seed)
    loads = [Load.body_force(lambda x, y: 1e-2 * rng.standard_normal((len(x), 2)))]
    # On nodes of the surface, where there are some.
    loads.append(Load.stress((0.02, 0.01, 0.03), where=lambda x, y: (y > 2) & (y < 7)))
    scene = plate(loads=loads, surface=surface)
    run = fracture.grow(
        scene, 1.0, Programme(control=control, stop=1e6), batch=batch, max_solves=16,
        tolerance=1e-11,
    )  # fmt: skip
    h = run.history
    assert h.dissipated[-1] > 0
    assert np.abs(h.imbalance).max() <= 1e-8 * h.work.max()
    # The balance sees one per cent of what is dissipated.
    assert 0.01 * h.dissipated[-1] > 1e-6 * h.work.max()
    # No bond breaks below its strength, so that the excess only grows.
    if control == "fixed":
        assert (np.diff(h.excess) >= -1e-8 * h.work.max()).all()


@pytest.mark.parametrize("surface", ["none", "volume", "extrapolated"])
def test_cracks_leave_through_free_edges(surface):
    # A strip pulled apart along its held rows: bonds that end at an edge must not hold it.
    scene = Scene(
        rectangle(8.0, 12.0), 1.0, ElasticTensor(STIFF), m=2, surface=surface,
        supports=[Support.where(lambda x, y: y < -5, displacement=(0.0, 0.0), rotation=0.0)],
        loads=[Load.body_force((0.0, 1.0), where=lambda x, y: y < 4)], loose="drop",
    )  # fmt: skip
    run = fracture.grow(scene, 1e-3, Programme(stop=1e6), batch=8, max_solves=200)
    assert "come loose" in run.reason
    h = run.history
    assert np.abs(h.imbalance).max() <= 1e-8 * h.work.max()


def pulled(angle, surface, n=16, **options):
    """A turned strip with an edge crack, its ends moved apart until it is in two."""
    c, s = np.cos(angle), np.sin(angle)

    def along(x, y):
        return c * x + s * y

    def ends(x, y):
        return np.sign(along(x, y))[:, None] * [c, s]

    start, stop = (-0.6 * n * -s, -0.6 * n * c), (-0.2 * n * -s, -0.2 * n * c)
    return Scene(
        rectangle(2 * n, n, angle=angle), 1.0, SOFT, m=3, surface=surface, cracks=[Crack(start,
        stop)], supports=[Support.where(lambda x, y: abs(along(x, y)) > n - 3.5, displacement=ends,
        rotation=0.0)], loose="drop", **options,
    )  # fmt: skip


@pytest.mark.parametrize("angle", [0.0, 0.3])
@pytest.mark.parametrize("surface", ["volume", "extrapolated"])
def test_an_edge_crack_runs_through_and_the_run_ends(angle, surface):
    run = fracture.grow(pulled(angle, surface), 1.0, batch=4, max_solves=500)
    assert run.reason == "the body has parted"
    h = run.history
    assert np.abs(h.imbalance).max() <= 1e-8 * h.work.max()
    assert h.stored[-1] <= 1e-9 * h.stored.max()
    # It has cost what its length costs, edges included, to some cells; here w_c = 1 a bond.
    assert len(run.broken_bonds) > 30
    # Nothing joins the two sides: the field is a rigid motion of each.
    x, y = run.solution.points.T
    u = run.solution.displacement
    there = (np.cos(angle) * x + np.sin(angle) * y > 4) & ~run.loose
    assert np.ptp(u[there], axis=0).max() <= 1e-6 * np.abs(u[there]).max()


@pytest.mark.parametrize("control", ["fixed", "following"])
@pytest.mark.parametrize("surface", ["none", "volume", "extrapolated"])
def test_a_strip_that_was_cut_right_through_is_in_two_from_the_start(surface, control):
    """Each half moves as one: what strains bonds is rounding, and breaks none of them."""
    ends = Support.where(
        lambda x, y: abs(y) > 4, displacement=lambda x, y: np.sign(y)[:, None] * [0.0, 1.0]
    )
    cut = Scene(
        rectangle(24, 12),
        1.0,
        SOFT,
        [ends],
        m=3,
        surface=surface,
        cracks=[Crack((-14, 0), (14, 0))],
    )
    run = fracture.grow(cut, 1e-3, Programme(control=control), max_solves=50)
    assert "moves the body and does not strain it" in run.reason
    assert len(run.broken_bonds) == 0
    assert len(run.history.work) == 1
    # A slender body strains little, and is loaded all the same.
    left = Support.where(lambda x, y: x < -97, displacement=0.0)
    beam = Scene(rectangle(200, 4), 1.0, SOFT, [left], [Load.point((0.0, 1.0), (99.0, 0.0))], m=2)
    assert fracture.grow(beam, 1.0, max_solves=1).reason == "1 solves are done"


def test_a_run_that_loads_end_can_be_looked_at():
    """The part that came loose carries the load; its bonds to the surface went with it."""
    held = Support.where(lambda x, y: x < 0, displacement=0.0, rotation=0.0)
    scene = Scene(
        rectangle(2, 1), 1.0, SOFT, [held], [Load.stress((1.0, 0.0, 0.0))], m=1,
        surface="extrapolated",
    )  # fmt: skip
    run = fracture.grow(scene, 1.0, max_solves=4)
    assert "come loose" in run.reason
    assert np.isnan(run.fields()["displacement"]).any()
    assert len(run.broken_bonds) == 1


def test_a_body_in_two_ends_the_run():
    # What the solver leaves of a force between the halves breaks nothing.
    for control in ("fixed", "following"):
        scene = Scene(
            rectangle(6.0, 12.0), 1.0, ElasticTensor(STIFF), m=2, surface="none",
            supports=[
                Support.where(lambda x, y: y < -4, displacement=(0.0, 0.0), rotation=0.0),
                Support.where(lambda x, y: y > 4, displacement=(0.0, 1.0), rotation=0.0),
            ],
        )  # fmt: skip
        run = fracture.grow(scene, 1e-3, Programme(control=control), batch=8, max_solves=300)
        assert run.reason == "the body has parted"
        assert run.history.load_factor.max() < 1e4 * run.history.load_factor[1]


def slit(shear, n=8, **options):
    """A disc with a slit, its rim moved as in mode I and `shear` times mode II."""

    def rim(x, y):
        return np.stack([shear * y, y], axis=-1)

    supports = [Support.layer(cells=2.5, displacement=rim, rotation=0.0)]
    return Scene(
        rectangle(4 * n, 3 * n), 1.0, options.pop("material", SOFT), m=3,
        cracks=[Crack((-3 * n, 0), (-n, 0))], supports=supports, **options,
    )  # fmt: skip


def test_a_symmetric_body_cracks_straight():
    run = fracture.grow(slit(0.0), 1.0, until=lambda run: run.advance >= 10)
    assert run.tip[1] == pytest.approx(0.0, abs=1e-12)
    assert run.advance >= 10
    np.testing.assert_allclose(run.path[:, 1], 0.0, atol=1e-12)
    y = run.midpoints[:, 1]
    np.testing.assert_allclose(np.sort(y), np.sort(-y), atol=1e-12)
    assert run.damage.max() < 0.9


def test_a_mirrored_load_makes_the_mirrored_crack():
    runs = [fracture.grow(slit(s), 1.0, until=lambda run: run.advance >= 8) for s in (2.5, -2.5)]
    mirrored = runs[1].midpoints * [1.0, -1.0]
    assert abs(runs[0].tip[1]) > 1
    np.testing.assert_allclose(
        sorted(map(tuple, runs[0].midpoints.round(9))), sorted(map(tuple, mirrored.round(9)))
    )
    np.testing.assert_allclose(runs[0].history.load_factor, runs[1].history.load_factor, rtol=1e-6)


@pytest.mark.skipif(numba.config.NUMBA_NUM_THREADS < 2, reason="one thread only")
def test_results_do_not_depend_on_threads(monkeypatch):
    # Or so small a body would keep to one thread both times.
    monkeypatch.setattr(threads, "_WORK", 1)
    before = numba.get_num_threads()
    try:
        runs = []
        for count in (1, numba.config.NUMBA_NUM_THREADS):
            numba.set_num_threads(count)
            runs.append(fracture.grow(slit(0.5), 1.0, max_solves=12))
    finally:
        numba.set_num_threads(before)
    np.testing.assert_array_equal(runs[0].body.x, runs[1].body.x)
    np.testing.assert_array_equal(runs[0].history.array, runs[1].history.array)


@pytest.mark.parametrize("interrupted", [7, 20])
def test_a_run_goes_on_from_its_checkpoint_to_the_last_bit(tmp_path, interrupted):
    path = tmp_path / "run.npz"
    options = {"max_solves": 30, "batch": 6}
    whole = fracture.grow(slit(0.5), 1.0, **options)
    fracture.grow(slit(0.5), 1.0, **(options | {"max_solves": interrupted}), checkpoint=path)
    later = fracture.grow(slit(0.5), 1.0, **options, checkpoint=path)
    np.testing.assert_array_equal(later.body.x, whole.body.x)
    np.testing.assert_array_equal(later.breaks, whole.breaks)
    np.testing.assert_array_equal(later.steps, whole.steps)
    np.testing.assert_array_equal(later.history.array, whole.history.array)
    assert whole.steps["refreshed"].sum() > 1, "the preconditioner was never brought up to date"
    # A finished run is only read, and a file of another run is refused.
    again = fracture.grow(slit(0.5), 1.0, **options, checkpoint=path)
    np.testing.assert_array_equal(again.breaks, whole.breaks)
    with pytest.raises(SceneError, match="another scene"):
        fracture.grow(slit(0.5), 1.01, **options, checkpoint=path)
    path.write_bytes(b"no archive")
    with pytest.raises(SceneError, match="no checkpoint"):
        fracture.grow(slit(0.5), 1.0, **options, checkpoint=path)


def test_a_killed_writer_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "run.npz"
    fracture.grow(slit(0.5), 1.0, max_solves=3, checkpoint=path)
    old = path.read_bytes()

    def killed(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(np, "savez", killed)
    with pytest.raises(KeyboardInterrupt):
        fracture.grow(slit(0.5), 1.0, max_solves=6, checkpoint=path)
    assert path.read_bytes() == old
    assert [p.name for p in tmp_path.iterdir()] == ["run.npz"]


@few
@given(st.integers(0, 10**6), st.sampled_from(["none", "volume", "extrapolated"]))
def test_bonds_that_break_later_are_bonds_that_were_broken(seed, surface):
    rng = np.random.default_rng(seed)
    parts = plate(surface=surface).discretise()
    lattice, family = parts.lattice, parts.family
    exists = np.stack([parts.bonds.strength(o) > 0 for o in range(family.size // 2)])
    bonds, broken = parts.bonds, np.zeros_like(exists)
    for _ in range(3):
        chosen = rng.permutation(np.flatnonzero(exists & ~broken))[:5]
        broken.ravel()[chosen] = True
        bonds = bonds.breaking(*np.divmod(chosen, lattice.count))
    anew = Bonds(lattice, family, parts.scene.cracks, surface, parts.held, broken)
    np.testing.assert_array_equal(bonds.special, anew.special)
    np.testing.assert_array_equal(bonds.strengths, anew.strengths)
    np.testing.assert_array_equal(bonds.column, anew.column)


def test_increments_are_multiples_and_nothing_is_stepped_through():
    run = fracture.grow(slit(0.0), 1.0, Programme(increment=0.05), max_solves=20)
    k = run.history.load_factor / 0.05
    np.testing.assert_allclose(k, k.round(), atol=1e-9)
    first = np.flatnonzero(run.history.load_factor > 0)[0]
    assert first == 1
    assert k[first] > 2
    exact = fracture.grow(slit(0.0), 1.0, max_solves=2)
    event = exact.history.load_factor[1]
    assert event <= run.history.load_factor[1] < event + 0.05


def test_unloading_breaks_nothing_and_gives_back_the_stored_energy():
    levels = (2.0, 0.0, 1.9)
    run = fracture.grow(slit(0.0), 1.0, Programme(levels=levels))
    h = run.history
    assert len(run.broken_bonds)
    down = np.flatnonzero(h.load_factor == 0.0)[-1]
    assert h.stored[down] == pytest.approx(0.0, abs=1e-12)
    assert h.work[down] == pytest.approx(h.dissipated[down] + h.excess[down], rel=1e-6)
    # Back to less than before: nothing new breaks.
    assert h.broken[-1] == h.broken[down]
    assert h.load_factor[-1] == 1.9


def test_a_load_that_follows_the_crack_leaves_little_excess():
    fixed, following = (
        fracture.grow(slit(0.0), 1.0, Programme(control=c), until=lambda run: run.advance >= 6,
                      batch=1)
        for c in ("fixed", "following")
    )  # fmt: skip
    assert following.tip == pytest.approx(fixed.tip)
    assert following.history.excess[-1] < fixed.history.excess[-1]
    assert (np.diff(following.history.load_factor) < 0).any()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"programme": Programme()}, "no end"),
        ({"batch": 0, "max_solves": 3}, "batch"),
        ({"monitors": {"work": lambda run: 0.0}, "max_solves": 3}, "names of their own"),
    ],
)
def test_runs_that_make_no_sense(options, message):
    with pytest.raises(ValueError, match=message):
        fracture.grow(plate(), 1.0, **options)


@pytest.mark.parametrize(
    "options",
    [
        {"start": -1.0},
        {"start": 2.0, "stop": 1.0},
        {"increment": 0.0},
        {"overload": -0.1},
        {"levels": ()},
        {"levels": (1.0,), "control": "following"},
        {"increment": 0.1, "control": "following"},
        {"control": "free"},
    ],
)
def test_programmes_that_make_no_sense(options):
    with pytest.raises(SceneError):
        Programme(**options)


def test_adaptive_increments_keep_the_overload():
    programme = Programme(increment=1.0, overload=0.1)
    # 1.3 lies under 2; half a step gives 1.5, (1.5/1.3)² > 1.1; a quarter 1.5; an eighth 1.375.
    assert programme.reach(1.3, 9.0) == 1.3125 or programme.reach(1.3, 9.0) == 1.375
    assert (programme.reach(1.3, 9.0) / 1.3) ** 2 <= 1.1
    assert Programme(overload=0.21).reach(1.0, 9.0) == pytest.approx(1.1)
    assert Programme(increment=1.0).reach(1.3, 9.0) == 2.0
    assert Programme(increment=1.0).reach(1.3, 1.6) == 1.6


@pytest.mark.parametrize("control", ["fixed", "following"])
def test_a_part_that_both_its_ligaments_leave_is_set_aside(control):
    """A bar with two equal notches: the piece between them comes loose."""
    supports = [
        Support.where(lambda x, y: x < 2, displacement=(-1.0, 0.0), rotation=0.0),
        Support.where(lambda x, y: x > 12, displacement=(1.0, 0.0), rotation=0.0),
    ]
    cracks = [Crack((x, y), (x, y + side * 3)) for x in (4, 10) for y, side in ((1, -1), (3, 1))]
    scene = Scene(block(14, 4), 1.0, SOFT, m=2, supports=supports, cracks=cracks, surface="none")
    run = fracture.grow(scene, 1.0, Programme(control=control, stop=1e3), tolerance=1e-11)
    x = run.solution.points[:, 0]
    np.testing.assert_array_equal(run.loose, (x > 4) & (x < 10))
    assert np.isnan(run.solution.displacement[run.loose]).all()
    assert np.isfinite(run.solution.displacement[~run.loose]).all()
    # What came loose is whole in itself: only its bonds to the rest have broken (Eq. 105).
    assert (run.damage[(x > 4 + 2) & (x < 10 - 2)] == 0).all()
    assert (run.damage < 1).all()
    h = run.history
    assert h.stored[-1] == pytest.approx(0.0, abs=1e-6 * h.work.max())
    assert np.abs(h.imbalance).max() <= 1e-8 * h.work.max()


def test_a_killed_run_goes_on(tmp_path):
    """Killed for good in the middle of a solve's aftermath, between two checkpoints."""
    path = tmp_path / "run.npz"
    script = f"""
import os, signal
from solver import fracture
from tests.solver.fracture.test_quasistatic import slit

def until(run):
    if len(run.steps) == 17:
        os.kill(os.getpid(), signal.SIGKILL)

fracture.grow(slit(0.5), 1.0, max_solves=24, until=until, checkpoint={str(path)!r}, every=5)
"""
    killed = subprocess.run([sys.executable, "-c", script], check=False, cwd=os.getcwd())
    assert killed.returncode == -signal.SIGKILL
    with np.load(path) as file:
        assert 10 <= len(file["steps"]) < 17
    later = fracture.grow(slit(0.5), 1.0, max_solves=24, checkpoint=path)
    whole = fracture.grow(slit(0.5), 1.0, max_solves=24)
    np.testing.assert_array_equal(later.body.x, whole.body.x)
    np.testing.assert_array_equal(later.breaks, whole.breaks)
    np.testing.assert_array_equal(later.history.array, whole.history.array)


def test_indefinite_bodies_break_by_the_energy_of_stretch():
    soft = ElasticTensor.isotropic(1.0, 0.45).voigt
    with pytest.raises(SceneError, match="negative shear stiffness"):
        fracture.grow(plate(soft), 1.0, max_solves=3)
    run = fracture.grow(plate(soft), 1.0, criterion="axial", max_solves=8, tolerance=1e-10)
    h = run.history
    assert run.body.kind == "indefinite"
    assert len(run.broken_bonds) >= 3
    assert np.abs(h.imbalance).max() <= 1e-8 * h.work.max()


def test_a_run_that_parts_edges_goes_on_from_its_checkpoint_to_the_last_bit(tmp_path):
    scene = pulled(0.3, "extrapolated")
    whole, path = fracture.grow(scene, 1.0, batch=6, max_solves=400), tmp_path / "run.npz"
    solves = len(whole.steps)
    count = len(whole.body.bonds.ended)
    parted = len(whole.body.bonds.ended.outline.nodes)
    fracture.grow(scene, 1.0, batch=6, max_solves=solves - 4, checkpoint=path)
    later = fracture.grow(scene, 1.0, batch=6, max_solves=400, checkpoint=path)
    assert count < len(whole.body.sound.bonds.ended)
    assert parted > len(whole.body.sound.bonds.ended.outline.nodes)
    np.testing.assert_array_equal(later.body.x, whole.body.x)
    np.testing.assert_array_equal(later.history.array, whole.history.array)


def test_a_run_ends_when_the_force_has_fallen():
    scene = pulled(0.0, "volume")
    run = fracture.grow(scene, 1.0, Programme(control="following", least_force=0.3), batch=2,
                        max_solves=500)  # fmt: skip
    assert "below 0.3 of its peak" in run.reason
    force = run.history.force
    assert force[-1] < 0.3 * force.max() <= force[-2] + 0.7 * force.max()
    assert run.history.stored[-1] > 0
    with pytest.raises(SceneError, match="share"):
        Programme(least_force=1.5)
