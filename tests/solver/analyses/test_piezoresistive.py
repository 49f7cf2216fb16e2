"""A strain gauge: its resistance follows its strain, and it writes what it found."""

import numpy as np
import pytest

from solver import ConductivityTensor, ElasticTensor, Load, Scene, SceneError, Support, rectangle
from solver.analyses import piezoresistive


def left(x, y):
    return x < -0.7


def right(x, y):
    return x > 0.7


def bar(**options):
    """A bar pulled by its ends, free to contract."""
    settings = {"m": 3, "surface": "extrapolated", **options}
    return Scene(
        rectangle(2.0, 0.5), 0.05, ElasticTensor.isotropic(1.0, 0.3),
        [Support.where(lambda x, y: (x < -0.9) & (abs(y) < 0.03), displacement=(0.0, 0.0)),
         Support.where(lambda x, y: (x > 0.9) & (abs(y) < 0.03), u2=0.0)],
        [Load.stress((1e-3, 0.0, 0.0), where=lambda x, y: abs(x) > 0.999)], **settings,
    )  # fmt: skip


def test_a_pulled_bar_conducts_by_its_two_strains():
    found = piezoresistive.run(bar(), 8.0, right, left, (2.0, 2.0))
    # 3/4 of the gauge along ε, 1/4 across −ν ε; electrodes at both ends are strained, too.
    wanted = -8.0 * 1e-3 * (0.75 - 0.25 * 0.3)
    assert found.change == pytest.approx(wanted, rel=0.02)
    other = piezoresistive.run(bar(), 8.0, right, left, (2.0, 2.0), law="resistivity")
    assert other.change == pytest.approx(-wanted, rel=0.03)
    assert found.resistances[0] == pytest.approx(other.resistances[0])


def test_it_writes_both_fields(tmp_path):
    found = piezoresistive.run(bar(), 8.0, right, left, (2.0, 3.0), angle_degrees=20.0)
    assert {"displacement", "potential", "current_density"} <= set(found.fields())
    assert found.summary()["relative change"] == found.change
    written = found.write(tmp_path / "gauge")
    assert np.load(written[1])["potential"].shape == (len(found.points),)


def test_what_is_no_gauge_is_refused():
    scene = Scene(rectangle(1, 1), 0.1, ConductivityTensor.isotropic(1.0))
    with pytest.raises(SceneError, match="strain makes a piezoresistance"):
        piezoresistive.run(scene, 1.0, right, left, (1.0, 1.0))
    with pytest.raises(SceneError, match="its thickness a number"):
        piezoresistive.run(bar(thickness=lambda x, y: 1 + 0 * x), 1.0, right, left, (1.0, 1.0))
    with pytest.raises(SceneError, match="holds no particle"):
        piezoresistive.run(bar(), 1.0, lambda x, y: x > 9, left, (1.0, 1.0))
