"""A killed experiment goes on where it stood, with the same moments and bits."""

import numpy as np
import pytest

from cmverify.cases.experiments import inclusion, running
from cmverify.run import unfinished


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
