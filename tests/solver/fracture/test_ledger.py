"""The books: loads do work, bonds hold and cost energy, and the sum is zero."""

import numpy as np
import pytest

from solver import Programme
from solver.fracture import grow
from solver.fracture.breaking import Breakable
from solver.fracture.damaged_body import Equilibrium
from solver.fracture.ledger import History, Ledger
from tests.solver.fracture.strip import scene


@pytest.fixture
def books():
    built = scene().discretise()
    bonds = Breakable(built, np.full(built.family.size, 2.0))
    body = Equilibrium(built, bonds, tolerance=1e-11, max_iterations=2000)
    body.solve()
    ledger = Ledger(body, bonds)
    ledger.opened()
    return ledger


def test_a_linear_body_stores_what_the_supports_do(books):
    books.move(0.0, 0.7)
    row = books.row(0.7)
    assert row["work"] == pytest.approx(row["stored"], rel=1e-8)
    assert row["stored"] == pytest.approx(0.49 * books.bonds.stored(books.body.unknowns))
    # dW = force dλ, and W = ½ force λ.
    assert row["work"] == pytest.approx(0.5 * row["force"] * 0.7, rel=1e-8)
    assert row["dissipated"] == row["excess"] == 0.0


def test_breaking_costs_what_the_bonds_cost_and_the_rest_is_excess(books):
    which = np.argsort(books.bonds.utilisation(books.body.unknowns).ravel())[-3:]
    cost = books.bonds.cost_of(which).sum()
    held = 4.0 * books.bonds.energy_of(books.body.unknowns, which).sum()
    books.broken(which, 2.0)
    assert books.dissipated == pytest.approx(cost)
    assert books.excess == pytest.approx(held - cost)
    books.dropped(which, 2.0)
    assert books.dissipated == pytest.approx(cost)
    assert books.excess == pytest.approx(2 * held - cost)


def test_a_run_balances():
    run = grow(scene(), np.full(scene().family().size, 2.0), batch=4, max_solves=8, tolerance=1e-11)
    assert run.history.dissipated[-1] > 0
    assert np.abs(run.history.imbalance).max() < 1e-8 * run.history.work.max()


def test_history_is_columns_by_name():
    history = History(("gauge",))
    row = dict.fromkeys(History.NAMES, 1.0)
    history.add(**row, gauge=3.0)
    history.add(**{**row, "work": 5.0}, gauge=4.0)
    assert len(history) == 2
    np.testing.assert_array_equal(history["gauge"], [3.0, 4.0])
    np.testing.assert_array_equal(history.work, [1.0, 5.0])
    assert history.array.shape == (2, len(History.NAMES) + 1)
    with pytest.raises(AttributeError):
        _ = history.nothing
    with pytest.raises(ValueError, match="names of their own"):
        History(("work",))


def test_a_load_that_follows_leaves_next_to_no_excess():
    programme = Programme(control="following")
    toughness = np.full(scene().family().size, 2.0)
    run = grow(scene(), toughness, programme, batch=1, max_solves=8, tolerance=1e-11)
    assert abs(run.history.excess[-1]) < 0.5 * run.history.dissipated[-1]
