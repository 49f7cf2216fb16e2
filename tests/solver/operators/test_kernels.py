"""The compiled kernels against the same loops in Python."""

import numpy as np
import pytest

from solver import Family
from solver.bonds import Bonds
from solver.geometry import Lattice
from solver.operators import BondOperator, kernels
from tests.solver.bodies import Cells, random_moduli

MASK = np.random.default_rng(7).random((5, 6)) < 0.8
COMPONENTS = {"elastic": 3, "central": 2, "conductive": 1}


@pytest.mark.parametrize("kind", COMPONENTS)
def test_compiled_products_are_those_of_python(kind, monkeypatch):
    family = Family(2, 0.5)
    bonds = Bonds(Lattice(Cells(MASK, 0.5), 0.5, family.reach), family)
    held = np.zeros((COMPONENTS[kind], bonds.lattice.count), dtype=bool)
    operator = BondOperator(bonds, random_moduli(family, kind, 1), held)
    product = getattr(kernels, f"{kind}_product")
    values = np.random.default_rng(2).normal(size=(COMPONENTS[kind], len(operator.active)))
    grid = np.zeros((COMPONENTS[kind], int(np.prod(bonds.lattice.shape))))
    kernels.scatter(operator.segments, values, grid)
    rows, columns = bonds.lattice.rows_columns
    np.testing.assert_array_equal(grid[:, rows * bonds.lattice.shape[1] + columns], values)
    arguments = (
        grid, operator.segments, operator.steps, operator.half_blocks, operator.bulk,
        operator.diagonal, bonds.strengths,
    )  # fmt: skip
    compiled, plain = np.empty_like(values), np.empty_like(values)
    product.alone(*arguments, compiled)
    shared = np.empty_like(values)
    product.shared(*arguments, shared)
    np.testing.assert_array_equal(compiled, shared)
    # NumPy warns of unsigned steps that wrap around, as they are meant to in neither.
    if kind == "elastic":
        monkeypatch.setattr(kernels, "_elastic_lanes", kernels._elastic_lanes.py_func)
    with np.errstate(over="ignore"):
        product.py_func(*arguments, plain)
    np.testing.assert_allclose(compiled, plain, rtol=1e-12, atol=1e-12)


def test_weighted_rows_are_a_sparse_product():
    """Only the rows that are asked for are written."""
    rows = np.array([0, 2], dtype=np.int64)
    pointer = np.array([0, 2, 2, 3], dtype=np.int64)
    index = np.array([1, 2, 0], dtype=np.int64)
    weight = np.array([2.0, -1.0, 0.5])
    values = np.random.default_rng(3).normal(size=(3, 3))
    matrix = np.array([[0.0, 2.0, -1.0], [0.0, 0.0, 0.0], [0.5, 0.0, 0.0]])
    for components in (1, 3):
        out = np.full((components, 3), 7.0)
        kernels.weighted_rows(rows, pointer, index, weight, values[:components], out)
        np.testing.assert_allclose(out[:, rows], (values[:components] @ matrix.T)[:, rows])
        assert (out[:, 1] == 7.0).all()
