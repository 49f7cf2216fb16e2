"""Bond blocks against the Hessian of one bond's energy."""

import numpy as np
import pytest

from solver import Family
from solver.material import ElasticModuli
from solver.operators.blocks import offset_blocks
from tests.solver.bodies import random_moduli

FAMILY = Family(2, 0.5)


def test_elastic_blocks_are_the_hessian_of_a_bond():
    """Of |ξ| (k_n s² + k_t γ²) α Λ Δv in the unknowns (u, θ Δx) of both ends."""
    moduli = random_moduli(FAMILY, "elastic", 3)
    blocks = offset_blocks(FAMILY, moduli)
    for o in range(FAMILY.size):
        length, n = FAMILY.length[o], FAMILY.normal[o]
        t = np.array([-n[1], n[0]])
        stretch = np.array([*(-n), 0.0, *n, 0.0]) / length
        half = 0.5 / FAMILY.spacing
        shear = np.array([*(-t / length), -half, *(t / length), -half])
        weight = FAMILY.weight[o] * FAMILY.cell_area * length
        hessian = weight * (
            moduli.normal[o] * np.outer(stretch, stretch) + moduli.shear[o] * np.outer(shear, shear)
        )
        a11, a12, a22, t1, t2, c = blocks[o]
        # K_pq = [[−A, t̂], [−t̂ᵀ, c]]
        wanted = [[-a11, -a12, t1], [-a12, -a22, t2], [-t1, -t2, c]]
        np.testing.assert_allclose(hessian[:3, 3:], wanted, atol=1e-12)


def test_bending_of_a_bond_turns_its_ends_apart():
    """|ξ| k_b χ² of rotations θ Δx; nothing else of the block knows of it."""
    moduli = random_moduli(FAMILY, "polar", 3)
    plain = ElasticModuli(moduli.normal, moduli.shear)
    more = offset_blocks(FAMILY, moduli) - offset_blocks(FAMILY, plain)
    less = offset_blocks(FAMILY, moduli, coupling=True) - offset_blocks(FAMILY, plain)
    wanted = FAMILY.weight * FAMILY.cell_area * moduli.bending / FAMILY.length / FAMILY.spacing**2
    np.testing.assert_allclose(more[:, 5], wanted, rtol=1e-10)
    np.testing.assert_allclose(less[:, 5], -wanted, rtol=1e-10)
    assert not more[:, :5].any()
    assert not less[:, :5].any()


def test_bonds_without_shear_have_no_rotations():
    central = random_moduli(FAMILY, "central", 3)
    assert offset_blocks(FAMILY, central).shape == (FAMILY.size, 3)


def test_conductive_blocks():
    moduli = random_moduli(FAMILY, "conductive", 3)
    wanted = FAMILY.weight * FAMILY.cell_area * moduli.conductivity / FAMILY.length**2
    np.testing.assert_allclose(offset_blocks(FAMILY, moduli)[:, 0], wanted)
    assert offset_blocks(FAMILY, moduli).shape == (FAMILY.size, 1)


@pytest.mark.parametrize("kind", ["elastic", "central", "conductive", "polar"])
def test_opposite_bonds_have_blocks_of_the_right_parity(kind):
    moduli = random_moduli(FAMILY, kind, 3)
    blocks = offset_blocks(FAMILY, moduli)
    coupling = offset_blocks(FAMILY, moduli, coupling=True)
    if kind != "polar":
        # One set of entries serves the diagonal and the neighbours, to the last bit.
        np.testing.assert_array_equal(coupling, blocks)
    half = FAMILY.size // 2
    sign = np.array([1, 1, 1, -1, -1, 1])[: blocks.shape[1]]
    np.testing.assert_allclose(blocks[half:], sign * blocks[:half], atol=1e-15)
