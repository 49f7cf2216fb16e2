"""Cracks that grow from one field of temperature to the next."""

import numpy as np
import pytest

from solver import (
    Crack,
    ElasticTensor,
    ExpansionTensor,
    Load,
    Programme,
    Scene,
    SceneError,
    Support,
    fracture,
    rectangle,
)
from solver.fracture import Temperatures

SOFT = ElasticTensor.isotropic(1.0, 0.2)
EXPANSION = ExpansionTensor([[1.0, 0.2], [0.2, 0.5]])
#: Both ends held; a body that shrinks tears.
PLATE = Scene(
    rectangle(14, 8, (7, 4)),
    1.0,
    SOFT,
    [Support.where(lambda x, y: (x < 1) | (x > 13), displacement=0.0, rotation=0.0)],
    m=2,
    cracks=[Crack((6.7, -1.0), (6.7, 2.2))],
    loose="drop",
)
X, Y = PLATE.discretise().lattice.points.T
TOUGH = 1.0


def fields(count=4):
    """A front that moves upwards, steeper than any factor on one field."""
    return np.array([-(0.5 + 0.4 * k) * np.exp(-Y / (2.0 + k)) for k in range(count)])


def test_fields_of_one_shape_are_steps_of_a_load_factor():
    shape = -1.0 + 0.05 * Y
    factors = 0.25 * np.arange(1, 9)
    found = fracture.grow(
        PLATE, TOUGH, temperatures=Temperatures(factors, factors[:, None] * shape, EXPANSION),
        tolerance=1e-11,
    )  # fmt: skip
    cold = Scene(**{**vars(PLATE), "loads": [Load.temperature(shape, EXPANSION)]})
    wanted = fracture.grow(
        cold, TOUGH, Programme(stop=float(factors[-1]), increment=0.25), tolerance=1e-11
    )
    assert len(found.broken_bonds) > 20
    np.testing.assert_array_equal(np.sort(found.broken_bonds), np.sort(wanted.broken_bonds))
    for name in ("work", "stored", "dissipated", "excess"):
        assert found.history[name][-1] == pytest.approx(wanted.history[name][-1], rel=1e-6)
    at = found.history["time"]
    assert at[0] == 0.25
    assert at[-1] == 2.0


def test_energies_balance_and_the_solution_is_at_the_last_temperature():
    loaded = Scene(**{**vars(PLATE), "loads": [Load.body_force((0.0, 1e-3))]})
    times = [0.0, 1.0, 2.5, 3.0]
    run = fracture.grow(
        loaded, TOUGH, temperatures=Temperatures(times, fields(), EXPANSION), tolerance=1e-11
    )
    h = run.history
    assert h.dissipated[-1] > 0
    assert np.abs(h.imbalance).max() <= 1e-8 * h.work.max()
    # It would see one per cent of what expansion does between two fields.
    assert 0.01 * np.abs(np.diff(h.work)).max() > 1e-5 * h.work.max()
    np.testing.assert_allclose(run.fields()["temperature"], fields()[-1])
    assert run.reason == "the last temperatures are reached"


def test_linear_temperatures_of_a_free_body_break_nothing():
    corner = [
        Support.where(lambda x, y: (x < 1) & (y < 1), displacement=(0.0, 0.0)),
        Support.where(lambda x, y: (x > 6) & (x < 7) & (y < 1), u2=0.0),
    ]
    free = Scene(PLATE.region, 1.0, SOFT, corner, m=2)
    changes = [1.0 + X - 2 * Y, -3.0 * Y, 0.0 * X]
    run = fracture.grow(free, 1e-6, temperatures=Temperatures([1.0, 2.0, 3.0], changes, EXPANSION))
    assert not len(run.broken_bonds)
    assert run.reason == "the last temperatures are reached"
    assert run.history["time"][-1] == 3.0


@pytest.mark.parametrize("begin", [0.0 * X, 1.0 + 0.0 * X, 1.0 + X - 2 * Y])
def test_what_strains_no_body_yet_may_break_it_later(begin):
    corner = [
        Support.where(lambda x, y: (x < 1) & (y < 1), displacement=(0.0, 0.0)),
        Support.where(lambda x, y: (x > 6) & (x < 7) & (y < 1), u2=0.0),
    ]
    free = Scene(PLATE.region, 1.0, SOFT, corner, m=2)
    changes = [begin, -np.exp(-Y / 2.0)]
    run = fracture.grow(free, 0.01, temperatures=Temperatures([1.0, 2.0], changes, EXPANSION))
    assert run.history["time"][-1] == 2.0
    assert len(run.broken_bonds)
    alone = fracture.grow(free, 0.01, temperatures=Temperatures([2.0], changes[1:], EXPANSION))
    np.testing.assert_array_equal(run.broken_bonds, alone.broken_bonds)


def test_a_run_goes_on_from_its_checkpoint(tmp_path):
    given = Temperatures(range(4), fields(), EXPANSION)
    whole = fracture.grow(PLATE, TOUGH, temperatures=given)
    half = len(whole.steps) * 2 // 3
    file = tmp_path / "run.npz"
    part = fracture.grow(PLATE, TOUGH, temperatures=given, max_solves=half, checkpoint=file)
    assert part.target > 0
    rest = fracture.grow(PLATE, TOUGH, temperatures=given, checkpoint=file)
    np.testing.assert_array_equal(rest.broken_bonds, whole.broken_bonds)
    np.testing.assert_array_equal(rest.unknowns, whole.unknowns)
    # A record where the first part ended comes on top.
    assert rest.history.work[-1] == whole.history.work[-1]
    other = Temperatures(range(4), 1.001 * fields(), EXPANSION)
    with pytest.raises(SceneError, match="another"):
        fracture.grow(PLATE, TOUGH, temperatures=other, checkpoint=file)


@pytest.mark.parametrize(
    ("times", "changes", "says"),
    [
        ([1.0, 1.0], fields(2), "ascend"),
        ([1.0], fields(2), "as many fields"),
        ([1.0], np.full((1, X.size), np.nan), "finite"),
    ],
)
def test_what_is_no_history_is_refused(times, changes, says):
    with pytest.raises(SceneError, match=says):
        Temperatures(times, changes, EXPANSION)


def test_what_does_not_go_together_is_refused():
    given = Temperatures([1.0], fields(1), EXPANSION)
    with pytest.raises(SceneError, match="not both"):
        fracture.grow(PLATE, TOUGH, Programme(stop=1.0), temperatures=given)
    warm = Scene(**{**vars(PLATE), "loads": [Load.temperature(1.0, EXPANSION)]})
    with pytest.raises(SceneError, match="temperature of its own"):
        fracture.grow(warm, TOUGH, temperatures=given)
    ended = Scene(**{**vars(PLATE), "surface": "extrapolated"})
    with pytest.raises(SceneError, match="end at the surface cannot be broken under temperatures"):
        fracture.grow(ended, TOUGH, temperatures=given)
    with pytest.raises(SceneError, match="its own column 'time'"):
        fracture.grow(PLATE, TOUGH, temperatures=given, monitors={"time": lambda run: 0.0})
    short = Temperatures([1.0], fields(1)[:, :-1], EXPANSION)
    with pytest.raises(SceneError, match="temperature"):
        fracture.grow(PLATE, TOUGH, temperatures=short)
