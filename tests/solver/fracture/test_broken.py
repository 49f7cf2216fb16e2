"""The one record of broken bonds, and that whatever depends on it catches up."""

import numpy as np

from solver import fracture
from solver.bonds import Bonds
from solver.fracture.broken import BrokenBonds
from tests.solver.fracture.test_quasistatic import plate, slit


def test_records_keep_their_order_and_their_cause():
    broken = BrokenBonds()
    for k in range(40):
        broken.add(np.array([3 * k, 3 * k + 1]), k, 0.1 * k, k % 2 == 1)
    assert len(broken) == 80
    np.testing.assert_array_equal(broken.between(0)[:4], [0, 1, 3, 4])
    np.testing.assert_array_equal(broken.between(78), [117, 118])
    assert (broken.by_load["step"] % 2 == 0).all()
    assert broken.mask((2, 60)).sum() == len(broken.by_load) == 40


def test_everything_that_knows_of_broken_bonds_follows_the_record():
    run = fracture.grow(slit(0.5), 1.0, max_solves=9)
    start, count = run.body.sound, run.bonds.lattice.count
    for _ in range(2):
        gone = run.bonds.strengths == 0
        bonds = run.body.bonds
        mask = run.broken
        anew = Bonds(
            start.lattice, start.family, start.scene.cracks, "volume",
            start.prescribed.all(axis=0), mask,
        )  # fmt: skip
        np.testing.assert_array_equal(bonds.strengths, anew.strengths)
        half = start.family.size // 2
        np.testing.assert_array_equal(gone, np.stack([anew.strength(o) == 0 for o in range(half)]))
        assert run.body.operator.bonds is bonds
        # One more bond in the record, and all of them know.
        bond = np.flatnonzero(run.bonds.strengths.ravel())[count // 2 : count // 2 + 1]
        run.bonds.broken.add(bond, 99, 1.0, False)


def test_the_record_of_a_run_is_that_of_its_breaks():
    run = fracture.grow(plate(), 1.0, max_solves=5)
    flat = run.breaks["offset"] * run.bonds.lattice.count + run.breaks["origin"]
    np.testing.assert_array_equal(flat, run.broken_bonds)
    assert run.broken.sum() == len(flat)
