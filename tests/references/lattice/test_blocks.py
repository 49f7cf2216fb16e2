from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import eigh

from references.analytic.tetrachiral import effective_voigt
from references.fem.modes import in_plane_frequencies
from references.lattice.blocks import (
    BlockLattice,
    TetrachiralCell,
    cell_voigt,
    paper_cell,
    relative_motion,
    spring_interface,
)

CELL = paper_cell()


def homogenised(cell: TetrachiralCell, n: float, count: int, free: bool = True) -> np.ndarray:
    side = n * cell.pitch
    return in_plane_frequencies(cell_voigt(cell), side, side, cell.effective_density, count, free)


@settings(max_examples=30, deadline=None, derandomize=True)
@given(st.floats(0, 0.78), st.floats(-2, 2), st.floats(-2, 2), st.floats(-2, 2))
def test_a_rigid_motion_strains_no_interface(angle: float, x: float, y: float, t: float) -> None:
    start, end = np.array([0.3, -0.2]), np.array([x, y]) + 3
    motion = np.r_[1 - t * start[1], 2 + t * start[0], t, 1 - t * end[1], 2 + t * end[0], t]
    assert np.abs(relative_motion(start, end, angle) @ motion).max() < 1e-12


@settings(max_examples=30, deadline=None, derandomize=True)
@given(st.floats(0.01, 0.75), st.floats(-0.9, 0.5))
def test_effective_tensor_against_the_closed_forms(angle: float, poisson: float) -> None:
    """Two derivations: energy of the cell summed over its springs here, by hand there."""
    cell = TetrachiralCell(1.0, angle, 0.01, 3.0, poisson, 1.0)
    check_effective_tensor(cell_voigt(cell), cell)


def check_effective_tensor(found: np.ndarray, cell: TetrachiralCell) -> None:
    kn, kt, _ = cell.springs
    assert np.allclose(found, effective_voigt(kn, kt, cell.angle), rtol=1e-9, atol=1e-9 * kn)


def check_papers_frequencies(found: np.ndarray) -> None:
    # an earlier, separate implementation of the same lattice, printed to five digits
    assert np.allclose(found, [5215.4, 6585.6, 6585.6, 8887.4, 8966.5, 10839.6], rtol=1e-5)


def check_homogenised(exact: np.ndarray) -> None:
    assert np.abs(homogenised(CELL, 25, 6) / exact - 1).max() < 5e-3


def test_free_frequencies_of_the_papers_lattice() -> None:
    lattice = BlockLattice(CELL, 25, 25)
    found = lattice.frequencies(6)
    check_papers_frequencies(found)
    stiffness = lattice.assemble(spring_interface(CELL)).toarray()
    dense = eigh(stiffness, lattice.mass().toarray(), eigvals_only=True, subset_by_index=[0, 8])
    assert np.allclose(found, np.sqrt(dense[3:]), rtol=1e-8)
    assert np.abs(stiffness - stiffness.T).max() < 1e-6 * np.abs(stiffness).max()


def test_homogenised_elements_agree_within_half_a_per_cent() -> None:
    check_homogenised(BlockLattice(CELL, 25, 25).frequencies(6))


def test_homogenisation_error_falls_with_the_square_of_the_cells() -> None:
    errors = []
    for n in (10, 20, 40):
        exact = BlockLattice(CELL, n, n).frequencies(6)
        errors.append(np.abs(homogenised(CELL, n, 6) / exact - 1).max())
    assert errors[0] / errors[1] > 2.8
    assert errors[1] / errors[2] > 2.8


def test_clamped_trend_in_the_number_of_cells() -> None:
    """The outer ring held: the clamped edge of the continuum lies near (n − 1) ℓ, to O(1/n)."""
    errors = []
    for n in (13, 25, 49):
        lattice = BlockLattice(CELL, n, n)
        exact = lattice.frequencies(6, lattice.ring)
        errors.append(np.abs(homogenised(CELL, n - 1, 6, free=False) / exact - 1).max())
    assert errors[1] < 1.5e-2
    ratios = np.array(errors[:-1]) / errors[1:]
    assert (ratios > 1.7).all(), errors
    assert (ratios < 2.3).all(), errors


def test_two_blocks_by_hand() -> None:
    """β = 0: opening ω² = 2 K_n / m; turning against each other ω² = 2 K_φ / J."""
    cell = TetrachiralCell(0.5, 0.0, 0.01, 2.0, 0.2, 3.0)
    kn, _, kr = cell.springs
    m = 3.0 * 0.25
    found = BlockLattice(cell, 2, 1).frequencies(3)
    for exact in (np.sqrt(2 * kn / m), np.sqrt(2 * kr / (m * 0.25 / 6))):
        assert np.abs(found / exact - 1).min() < 1e-12


@pytest.mark.parametrize("name", ["side", "angle", "thickness", "young", "poisson", "density"])
def test_one_per_cent_in_the_cell_is_seen(name: str) -> None:
    # ν = 1/2 is as large as it may be: one per cent less
    off = replace(CELL, **{name: 0.99 * getattr(CELL, name)})
    with pytest.raises(AssertionError):
        check_papers_frequencies(BlockLattice(off, 25, 25).frequencies(6))


def test_one_per_cent_in_the_frequencies_is_seen() -> None:
    exact = BlockLattice(CELL, 25, 25).frequencies(6)
    with pytest.raises(AssertionError):
        check_homogenised(1.01 * exact)
    with pytest.raises(AssertionError):
        check_papers_frequencies(BlockLattice(CELL, 25, 25).frequencies(
            6, interface=1.01 * spring_interface(CELL)))  # fmt: skip


@pytest.mark.parametrize("entry", [(0, 0), (0, 1), (0, 2), (2, 2)])
def test_one_per_cent_in_the_effective_tensor_is_seen(entry: tuple[int, int]) -> None:
    tensor = cell_voigt(CELL)
    tensor[entry] *= 1.01
    with pytest.raises(AssertionError):
        check_effective_tensor(tensor, CELL)


def test_bad_input_is_refused() -> None:
    with pytest.raises(ValueError, match="no longer touch"):
        TetrachiralCell(1, 0.9, 0.01, 1, 0.3, 1)
    with pytest.raises(ValueError, match="positive"):
        TetrachiralCell(1, 0.3, 0.0, 1, 0.3, 1)
    with pytest.raises(ValueError, match="Poisson"):
        TetrachiralCell(1, 0.3, 0.01, 1, 0.6, 1)
    with pytest.raises(ValueError, match="two blocks"):
        BlockLattice(CELL, 1, 1)
    with pytest.raises(ValueError, match="elastic modes"):
        BlockLattice(CELL, 2, 1).frequencies(4)


@pytest.mark.parametrize("clamped", [False, True])
def test_shapes_have_the_frequencies_that_are_told(clamped: bool) -> None:
    """Rayleigh's quotient needs the turning too: here the masses of the shapes, and their order."""
    lattice = BlockLattice(CELL, 9, 9)
    held = lattice.ring if clamped else None
    found, shapes = lattice.modes(6, held)
    assert found == pytest.approx(lattice.frequencies(6, held), rel=1e-9)
    gram = CELL.density * CELL.side**2 * np.einsum("knd,lnd->kl", shapes, shapes)
    # The blocks' turning carries a little of the mass.
    assert 0.95 < np.diag(gram).min() <= np.diag(gram).max() <= 1 + 1e-12
    if clamped:
        assert not shapes[:, lattice.ring].any()
