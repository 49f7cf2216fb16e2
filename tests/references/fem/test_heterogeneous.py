from itertools import pairwise

import numpy as np
import pytest

from references.fem.heterogeneous import (
    condensed_interface,
    full_frequencies,
    heterogeneous_frequencies,
    interface_grid,
)
from references.lattice.blocks import BlockLattice, paper_cell, spring_interface

CELL = paper_cell()


def test_condensation_against_every_interface_meshed() -> None:
    lattice = BlockLattice(CELL, 3, 2)
    full = full_frequencies(lattice, 6, across=2)
    condensed = heterogeneous_frequencies(lattice, 6, across=2)
    assert np.allclose(full, condensed, rtol=1e-6)


def test_interface_approaches_the_spring_bed_as_it_thins() -> None:
    """What is left is the layer's free ends, of the order of its thickness over its length."""
    springs = spring_interface(CELL)
    error = np.abs(condensed_interface(CELL).stiffness - springs).max() / springs.max()
    assert error < 2e-3
    thick = type(CELL)(CELL.side, CELL.angle, 4 * CELL.thickness, CELL.young, 0.5, CELL.density)
    springs = spring_interface(thick)
    four = np.abs(condensed_interface(thick).stiffness - springs).max() / springs.max()
    assert 3 < four / error < 5


def test_interface_converges_with_its_mesh() -> None:
    stiffness = [condensed_interface(CELL, n).stiffness for n in (2, 4, 6, 8)]
    steps = [np.abs(b - a).max() / stiffness[-1].max() for a, b in pairwise(stiffness)]
    assert steps[0] > 2 * steps[1] > 4 * steps[2]
    assert steps[2] < 1e-5


def test_interface_mass_and_rigid_motions() -> None:
    interface = condensed_interface(CELL, 4)
    both = np.tile(np.eye(3)[:, :2], (2, 1))
    total = both.T @ interface.mass @ both
    area = CELL.contact * CELL.thickness
    assert np.allclose(total, CELL.density * area * np.eye(2), atol=1e-9 * CELL.density * area)
    assert np.abs(interface.stiffness @ both).max() < 1e-9 * interface.stiffness.max()
    assert interface_grid(CELL, 4).nelements == interface.elements


def test_heterogeneous_lattice_within_three_per_mille_of_the_spring_beds() -> None:
    lattice = BlockLattice(CELL, 25, 25)
    found = heterogeneous_frequencies(lattice, 6, across=6)
    assert np.abs(found / lattice.frequencies(6) - 1).max() < 3e-3
    held = heterogeneous_frequencies(lattice, 6, lattice.ring, across=6)
    assert np.abs(held / lattice.frequencies(6, lattice.ring) - 1).max() < 3e-3


def test_odd_numbers_of_layers_are_refused() -> None:
    with pytest.raises(ValueError, match="even number"):
        condensed_interface(CELL, 3)
