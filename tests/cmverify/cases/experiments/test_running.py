"""A killed experiment goes on where it stood, with the same moments and bits."""

from types import SimpleNamespace

import numpy as np
import pytest

from cmverify.cases.experiments import inclusion, running
from cmverify.run import unfinished
from solver import ElasticTensor, Scene, Support, Toughness, rectangle
from solver.fracture.breaking import Breakable
from solver.fracture.crack_path import CrackPath


def test_bonds_that_bridge_a_crack_are_those_that_its_path_crosses_once():
    """Half a cut's bonds are broken: the other half bridges it, and both cost G × its length."""
    body = Scene(
        rectangle(24.0, 24.0), 1.0, ElasticTensor.isotropic(1.0, 0.2), m=3,
        supports=[Support.where(lambda x, y: abs(y) > 11, displacement=(0.0, 0.0))],
    )  # fmt: skip
    bonds = Breakable(body.discretise(sharp_tips=False, constrained=True), Toughness(10.0))
    every = np.flatnonzero(bonds.whole.ravel() > 0)
    _, p, q = bonds.ends(every)
    (x0, y0), (x1, y1) = bonds.lattice.points[p].T, bonds.lattice.points[q].T
    at = x0 - y0 * (x1 - x0) / np.where(y1 == y0, 1.0, y1 - y0)
    across = every[(y0 * y1 < 0) & (np.abs(at) < 5.1)]
    bonds.broken.add(across[::2], 0, 1.0, False)
    # In pieces.
    path = CrackPath(np.array([(-5.1, 0.0), (-2.47, 0.0), (0.1, 0.0), (5.1, 0.0)]))
    # There and back parts nothing but what ends between.
    hook = CrackPath(np.array([(8.1, 0.0), (9.2, 0.0), (9.2, 0.01), (8.1, 0.01)]))
    run = SimpleNamespace(bonds=bonds, scene=body, paths=[path, hook])
    bridge = running.bridging(run)
    np.testing.assert_array_equal(np.sort(bridge), np.setdiff1d(across, across[::2]))
    paid = bonds.cost_of(across[::2]).sum() + bonds.cost_of(bridge).sum()
    assert paid == pytest.approx(10.0 * 10.2, rel=0.02)


class Killed(BaseException):
    """As a signal would."""


def test_a_killed_run_goes_on_with_the_same_bits(tmp_path, monkeypatch):
    monkeypatch.setattr(running, "_EVERY", 7)
    plate = inclusion.Plate(m=3)
    whole = plate.led(18, max_solves=40)
    kill = [33]
    from solver.fracture.growth import Growth

    proceed = Growth.proceed

    def dying(self):
        if kill and len(self.solves) >= kill[0]:
            raise Killed
        proceed(self)

    monkeypatch.setattr(Growth, "proceed", dying)
    place = unfinished.folder(tmp_path / "0018", "0" * 20)
    with pytest.raises(Killed), unfinished.kept_in(place):
        plate.led(18, max_solves=40)
    kill.clear()
    with unfinished.kept_in(place):
        again = plate.led(18, max_solves=40)
    assert 0 < again.statistics["taken up at solve"] < 33
    assert "taken up at solve" not in whole.statistics
    np.testing.assert_array_equal(again.run.breaks, whole.run.breaks)
    np.testing.assert_array_equal(again.run.history.array, whole.run.history.array)
    assert len(again.moments) == len(whole.moments)
    for one, other in zip(again.moments, whole.moments, strict=True):
        assert (one.load_factor, one.force, one.solves) == (
            other.load_factor, other.force, other.solves,
        )  # fmt: skip
        np.testing.assert_array_equal(one.damage, other.damage)
