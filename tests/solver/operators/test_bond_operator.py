"""Bond operators against the Hessian of the energy, and against themselves in every disguise."""

import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import Crack, Family
from solver.bonds import Bonds
from solver.geometry import Lattice
from solver.material import ConductiveModuli, ElasticModuli
from solver.operators import BondOperator
from solver.operators.assembled import to_csr
from tests.solver.bodies import (
    Cells,
    Sites,
    block,
    dense_stiffness,
    few,
    masks,
    mirrored,
    random_moduli,
)
from tests.solver.bonds.test_bonds import pair_factors

KINDS = ["elastic", "central", "conductive", "polar"]
COMPONENTS = {"elastic": 3, "central": 2, "conductive": 1, "polar": 3}


def free(kind, bonds):
    return np.zeros((COMPONENTS[kind], bonds.lattice.count), dtype=bool)


def body(mask, kind, seed=0, m=2.0, spacing=0.5, cracks=(), surface="none", fixed=None):
    family = Family(m, spacing)
    bonds = Bonds(Lattice(Cells(mask, spacing), spacing, family.reach), family, cracks, surface)
    moduli = random_moduli(family, kind, seed)
    return BondOperator(bonds, moduli, free(kind, bonds) if fixed is None else fixed(bonds))


# ---- one bond by hand ---------------------------------------------------------------------------


def two_particles(offset, normal, shear, spacing):
    """Operator of a body of two particles whose bond has the moduli given."""
    family = Family(1, spacing, "full") if 0 in offset else Family(2, spacing, "full")
    i, j = offset
    mask = np.zeros((3, 3), dtype=bool)
    mask[1, 1] = mask[1 + j, 1 + i] = True
    bonds = Bonds(Lattice(Sites(mask, spacing), spacing, family.reach), family)
    moduli = ElasticModuli(np.full(family.size, normal), np.full(family.size, shear))
    return BondOperator(bonds, moduli, np.zeros((3, 2), dtype=bool))


@pytest.mark.parametrize("offset", [(1, 0), (0, 1), (1, 1), (-1, 1)])
def test_force_moment_and_energy_of_a_single_bond(offset):
    dx, kn, kt = 0.5, 3.0, 0.7
    operator = two_particles(offset, kn, kt, dx)
    p, q = operator.bonds.lattice.points
    xi = q - p
    size = np.hypot(*xi)
    n = xi / size
    t = np.array([-n[1], n[0]])
    rng = np.random.default_rng(5)
    u, theta = rng.normal(size=(2, 2)), rng.normal(size=2)
    eta = u[1] - u[0]
    s, gamma = eta @ n / size, eta @ t / size - 0.5 * theta.sum()
    dv = dx**2
    # An unordered pair carries |ξ|: ½ |ξ| (k_n s² + k_t γ²) Δv².
    energy = 0.5 * size * (kn * s**2 + kt * gamma**2) * dv**2
    x = np.concatenate([u.T, [theta * dx]]).ravel()
    rows = operator.matvec(x).reshape(3, 2)
    assert 0.5 * x @ operator.matvec(x) * dv == pytest.approx(energy, rel=1e-13)
    # Rows are what the bond asks of a load: minus its force f = f_n n + f_t t (Eq. 21) per volume.
    force = (kn * s * n + kt * gamma * t) * dv
    np.testing.assert_allclose(rows[:2, 0], -force, rtol=1e-12)
    np.testing.assert_allclose(rows[:2, 1], force, rtol=1e-12)
    # Each end turns against the shear force with the arm |ξ|/2.
    moment = -0.5 * size * kt * gamma * dv
    np.testing.assert_allclose(rows[2] * dx, [moment, moment], rtol=1e-12)


def test_flow_through_a_single_bond():
    dx, k = 0.5, 3.0
    family = Family(1, dx, "full")
    bonds = Bonds(Lattice(block(2, 1, dx), dx, 1), family)
    operator = BondOperator(bonds, ConductiveModuli(np.full(4, k)), np.zeros((1, 2), bool))
    temperature = np.array([1.0, 4.0])
    g = (temperature[1] - temperature[0]) / dx
    # No |ξ| in Eq. 112: the pair carries ½ k g² Δv², a particle loses k g/|ξ| Δv.
    rows = operator.matvec(temperature)
    assert 0.5 * temperature @ rows * dx**2 == pytest.approx(0.5 * k * g**2 * dx**4)
    np.testing.assert_allclose(rows, [-k * g / dx * dx**2, k * g / dx * dx**2])


def test_a_bond_wrong_by_one_per_cent_is_seen():
    right, off = (two_particles((1, 0), kn, 0.7, 0.5) for kn in (3.0, 3.03))
    x = np.random.default_rng(0).normal(size=6)
    assert abs(x @ off.matvec(x) / (x @ right.matvec(x)) - 1) > 1e-3


# ---- whole bodies against the Hessian -----------------------------------------------------------


@few
@given(masks(), st.integers(0, 10**6), st.sampled_from(KINDS), st.sampled_from([1.0, 2.0, 2.5]))
def test_operator_is_the_hessian_of_the_energy(mask, seed, kind, m):
    operator = body(mask, kind, seed, m)
    bonds = operator.bonds
    factors = pair_factors(bonds)
    wanted = dense_stiffness(
        bonds.lattice, bonds.family, operator.moduli, lambda p, q: factors[p, q]
    )
    scale = np.abs(operator.block_diagonal).max() + np.abs(wanted).max()
    found = to_csr(operator).toarray()
    np.testing.assert_allclose(found, wanted, atol=1e-13 * scale)
    x = np.random.default_rng(seed).normal(size=operator.shape[0])
    np.testing.assert_allclose(operator.matvec(x), wanted @ x, atol=1e-12 * scale)


@few
@given(st.integers(0, 10**6), st.sampled_from(KINDS), st.sampled_from(["none", "volume"]))
def test_operator_with_cracks_surface_factors_and_prescribed_particles(seed, kind, surface):
    rng = np.random.default_rng(seed)
    mask = rng.random((7, 8)) < 0.85
    mask[3:5, 2:6] = True
    cracks = [Crack((0.4, 2.0), tuple(rng.uniform(1.5, 3.5, 2)))]

    def fixed(bonds):
        prescribed = rng.random((COMPONENTS[kind], bonds.lattice.count)) < 0.2
        prescribed[:, rng.random(bonds.lattice.count) < 0.2] = True
        return prescribed

    operator = body(mask, kind, seed, cracks=cracks, surface=surface, fixed=fixed)
    bonds, active = operator.bonds, operator.active
    factors = pair_factors(bonds)
    whole = dense_stiffness(
        bonds.lattice, bonds.family, operator.moduli, lambda p, q: factors.get((p, q), 0.0)
    )
    count, c = bonds.lattice.count, COMPONENTS[kind]
    index = (np.arange(c)[:, None] * count + active).ravel()
    wanted = whole[np.ix_(index, index)]
    scale = np.abs(wanted).max() + operator.identity_scale
    partly = (
        np.zeros(len(index), bool)
        if operator.identity_rows is None
        else operator.identity_rows.ravel()
    )
    wanted[partly, :] = wanted[:, partly] = 0.0
    wanted[partly, partly] = operator.identity_scale
    found = to_csr(operator).toarray()
    np.testing.assert_allclose(found, wanted, atol=1e-13 * scale)
    np.testing.assert_array_equal(found, found.T)
    x = rng.normal(size=len(index))
    np.testing.assert_allclose(operator.matvec(x), wanted @ x, atol=1e-12 * scale)
    # Prescribed values act on the free rows through the same bonds.
    values = np.zeros((c, count))
    gone = np.setdiff1d(np.arange(count), active)
    values[:, gone] = rng.normal(size=(c, len(gone)))
    right = (whole @ values.ravel())[index]
    right[partly] = 0.0
    np.testing.assert_allclose(operator.coupling(values).ravel(), right, atol=1e-12 * scale)
    # Diagonal blocks are those of the matrix.
    blocks = operator.block_diagonal
    n = len(active)
    for a in range(c):
        for b in range(c):
            diagonal = wanted[a * n + np.arange(n), b * n + np.arange(n)]
            np.testing.assert_allclose(blocks[:, a, b], diagonal, atol=1e-13 * scale)


@pytest.mark.parametrize("kind", KINDS)
def test_wide_bodies_with_every_kind_of_particle(kind):
    # 40 × 30 cells, a hole, a crack, surface factors: product and matrix, m of the paper.
    mask = np.ones((30, 40), dtype=bool)
    mask[8:13, 25:33] = False
    operator = body(mask, kind, 1, m=5.0, cracks=[Crack((-1, 7.5), (9.2, 7.5))], surface="volume")
    x = np.random.default_rng(0).normal(size=operator.shape[0])
    found, wanted = operator.matvec(x), to_csr(operator) @ x
    np.testing.assert_allclose(found, wanted, atol=1e-12 * np.abs(wanted).max())


# ---- invariance ---------------------------------------------------------------------------------


def rigid_motions(operator):
    """Translations and the rotation with its θ, or the constant."""
    lattice, c = operator.bonds.lattice, operator.components
    x, y = lattice.points[operator.active].T
    if c == 1:
        return [np.ones_like(x)]
    zero, one = np.zeros_like(x), np.ones_like(x)
    motions = [[one, zero], [zero, one], [-y, x]]
    if c == 3:
        motions = [[*motions[0], zero], [*motions[1], zero], [*motions[2], one * lattice.spacing]]
    return [np.concatenate(motion) for motion in motions]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("surface", ["none", "volume"])
def test_rigid_motions_cost_nothing(kind, surface):
    mask = np.random.default_rng(3).random((12, 14)) < 0.9
    cracks = [Crack((0.0, 3.0), (4.3, 3.1))]
    operator = body(mask, kind, 4, m=3.0, cracks=cracks, surface=surface)
    for motion in rigid_motions(operator):
        size = np.abs(motion).max() * np.abs(operator.block_diagonal).max()
        assert np.abs(operator.matvec(motion)).max() < 1e-13 * size


def test_a_rotation_without_its_theta_is_not_rigid():
    operator = body(np.ones((6, 6), bool), "elastic", 4)
    motion = rigid_motions(operator)[2]
    motion[-36:] *= 1.01
    size = np.abs(motion).max() * np.abs(operator.block_diagonal).max()
    assert np.abs(operator.matvec(motion)).max() > 1e-5 * size


@pytest.mark.parametrize("kind", KINDS)
def test_the_product_is_linear_symmetric_and_repeatable(kind):
    operator = body(np.ones((9, 11), bool), kind, 2, cracks=[Crack((-1, 2), (2, 2))])
    rng = np.random.default_rng(1)
    x, y = rng.normal(size=(2, operator.shape[0]))
    kx, ky = operator.matvec(x), operator.matvec(y)
    scale = np.abs(kx).max() * len(x)
    assert x @ ky == pytest.approx(y @ kx, abs=1e-13 * scale)
    np.testing.assert_allclose(operator.matvec(2 * x - 3 * y), 2 * kx - 3 * ky, atol=1e-13 * scale)
    # The grid is reused between products; nothing of one may be left for the next.
    np.testing.assert_array_equal(operator.matvec(x), kx)
    np.testing.assert_array_equal(operator.rmatvec(x), kx)


@pytest.fixture
def threads():
    before = numba.get_num_threads()
    yield
    numba.set_num_threads(before)


@pytest.mark.usefixtures("threads")
@pytest.mark.skipif(numba.config.NUMBA_NUM_THREADS < 2, reason="one thread only")
@pytest.mark.parametrize("kind", KINDS)
def test_products_are_the_same_to_the_last_bit_for_any_number_of_threads(kind):
    mask = np.ones((50, 60), dtype=bool)
    mask[20:25, 10:20] = False
    operator = body(mask, kind, 3, m=3.0, cracks=[Crack((-1, 5), (12, 5.5))], surface="volume")
    x = np.random.default_rng(2).normal(size=operator.shape[0])
    numba.set_num_threads(1)
    one = operator.matvec(x)
    for count in range(2, min(numba.config.NUMBA_NUM_THREADS, 4) + 1):
        numba.set_num_threads(count)
        np.testing.assert_array_equal(operator.matvec(x), one)


# ---- shape and cost -----------------------------------------------------------------------------


def test_prescribed_particles_are_no_unknowns():
    mask = np.ones((6, 6), bool)

    def fixed(bonds):
        prescribed = np.zeros((3, 36), bool)
        prescribed[:, :12] = True
        prescribed[1, 20] = True
        return prescribed

    operator = body(mask, "elastic", fixed=fixed)
    assert operator.shape == (72, 72)
    np.testing.assert_array_equal(operator.active, np.arange(12, 36))
    assert operator.identity_rows.sum() == 1
    assert operator.directed_bonds == 24 * operator.bonds.family.size


@pytest.mark.parametrize("surface", ["none", "volume"])
@pytest.mark.parametrize("kind", KINDS)
def test_an_operator_made_from_the_one_before_has_the_bits_of_a_fresh_one(kind, surface):
    """Bonds break in turns, particles get prescribed whole: what is shared must be the same."""
    rng = np.random.default_rng(3)
    mask = np.ones((13, 17), dtype=bool)
    mask[5:7, 3:9] = False
    now = body(mask, kind, surface=surface)
    prescribed = free(kind, now.bonds)
    # The first row in one component only: identity rows.
    prescribed[0, :17] = True
    now = BondOperator(now.bonds, now.moduli, prescribed)
    bonds = now.bonds
    half = bonds.family.size // 2
    for turn in range(4):
        there = np.argwhere(np.stack([bonds.strength(o) for o in range(half)]) > 0)
        offsets, origins = there[rng.permutation(len(there))[:30]].T
        bonds = bonds.breaking(offsets, origins)
        if turn == 2:
            prescribed[:, rng.permutation(bonds.lattice.count)[:9]] = True
        now = BondOperator(bonds, now.moduli, prescribed, now)
        fresh = BondOperator(bonds, now.moduli, prescribed)
        np.testing.assert_array_equal(now.diagonal, fresh.diagonal)
        np.testing.assert_array_equal(now.segments, fresh.segments)
        x = rng.standard_normal(now.shape[0])
        np.testing.assert_array_equal(now @ x, fresh @ x)


def test_wrong_mask():
    bonds = body(np.ones((3, 3), bool), "elastic").bonds
    moduli = random_moduli(bonds.family, "conductive", 0)
    with pytest.raises(ValueError, match="prescribed must have shape"):
        BondOperator(bonds, moduli, np.zeros((3, 9), bool))


def test_memory_does_not_grow_with_the_bulk():
    family = Family(3, 1.0)
    half = family.size // 2
    moduli = ElasticModuli(mirrored(np.ones(half)), mirrored(np.ones(half)))
    sizes = []
    for cells in (40, 80):
        bonds = Bonds(Lattice(block(cells, cells), 1.0, family.reach), family)
        operator = BondOperator(bonds, moduli, np.zeros((3, cells**2), bool))
        sizes.append(operator.nbytes)
    # Four times the particles, twice the edge.
    assert sizes[1] < 2.5 * sizes[0]
    assert sizes[1] < 0.1 * 80**2 * family.size * 8
