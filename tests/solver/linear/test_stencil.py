"""The stencil of hats in the bulk against the whole product, and who is in the bulk."""

import numpy as np
import pytest

from solver import Family
from solver.bonds import Bonds
from solver.geometry import Lattice
from solver.linear import Hats, stencil
from solver.linear.coarse_grid import CoarseGrid
from solver.operators import BondOperator
from solver.operators.assembled import to_csr
from tests.solver.bodies import Cells, random_moduli

COMPONENTS = {"elastic": 3, "central": 2, "conductive": 1}


def _operator(kind: str, mask: np.ndarray) -> BondOperator:
    family = Family(2, 0.5)
    bonds = Bonds(Lattice(Cells(mask, 0.5), 0.5, family.reach), family)
    held = np.zeros((COMPONENTS[kind], bonds.lattice.count), dtype=bool)
    return BondOperator(bonds, random_moduli(family, kind, 1), held)


@pytest.mark.parametrize(
    "vectors", [((3, 0), (0, 3)), ((5, 0), (0, 2)), ((4, 2), (0, 2)), ((-1, 4), (-2, 0))]
)
@pytest.mark.parametrize("kind", COMPONENTS)
def test_entries_are_those_of_the_product(kind, vectors):
    operator, window = _operator(kind, np.ones((26, 29), dtype=bool)), 3
    grid = CoarseGrid(*vectors, operator.bonds.lattice.shape)
    hats = Hats(operator, 3, grid)
    p, c = hats.prolongation.toarray(), operator.components
    whole = np.kron(np.eye(c), p).T @ to_csr(operator).toarray() @ np.kron(np.eye(c), p)
    found = stencil.entries(operator, 0, grid, (window, window))
    row, column = np.divmod(hats.node, hats.width)
    inner = np.nonzero(stencil.phases(operator, grid, hats.prolongation) == 0)[0]
    assert len(inner) > 8
    for i in inner:
        for j in inner:
            up, right = row[j] - row[i], column[j] - column[i]
            if max(abs(up), abs(right)) > window:
                continue
            expected = whole[i :: hats.count, j :: hats.count]
            entry = found[up + window, right + window]
            np.testing.assert_allclose(entry, expected, atol=1e-12 * np.abs(whole).max())


def test_hats_in_the_bulk():
    mask = np.ones((30, 30), dtype=bool)
    mask[13, 14] = False
    operator, h = _operator("conductive", mask), 3
    hats = Hats(operator, h, CoarseGrid((h, 0), (0, h), operator.bonds.lattice.shape))
    found = stencil.phases(operator, hats.grid, hats.prolongation)
    bulk = np.ones(len(operator.active), dtype=bool)
    bulk[operator.own] = False
    for hat in range(hats.count):
        support = hats.prolongation[:, [hat]].nonzero()[0]
        whole = len(support) == (2 * h - 1) ** 2 and bulk[support].all()
        assert (found[hat] == 0) == whole
    assert 0 < (found == 0).sum() < hats.count / 2
