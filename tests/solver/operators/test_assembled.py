"""The assembled matrix against the Hessian of the energy and the product, held rows included."""

import numpy as np
import pytest

from solver import ElasticTensor, Family, Scene, Support, rectangle
from solver.bonds import Bonds
from solver.geometry import Lattice
from solver.operators import BondOperator
from solver.operators.assembled import to_csr
from tests.solver.bodies import block, dense_stiffness, random_moduli


@pytest.mark.parametrize("kind", ["elastic", "central", "conductive", "polar"])
def test_matrix_is_the_hessian(kind):
    family = Family(2, 0.5)
    lattice = Lattice(block(5, 4, 0.5), 0.5, family.reach)
    moduli = random_moduli(family, kind, 4)
    components = {"elastic": 3, "central": 2, "conductive": 1, "polar": 3}[kind]
    held = np.zeros((components, lattice.count), dtype=bool)
    matrix = to_csr(BondOperator(Bonds(lattice, family), moduli, held)).toarray()
    np.testing.assert_allclose(matrix, dense_stiffness(lattice, family, moduli), atol=1e-12)


def test_rows_of_single_prescribed_components_are_those_of_the_identity():
    operator = Scene(
        region=rectangle(1.0, 1.0),
        spacing=0.125,
        m=2,
        material=ElasticTensor.isotropic(1.0, 0.2),
        supports=[
            Support.where(lambda x, y: x < -0.4, u1=0.0),
            Support.where(lambda x, y: (x < -0.4) & (y < -0.4), u2=0.0),
        ],
    ).discretise().operator  # fmt: skip
    matrix = to_csr(operator)
    rows = np.nonzero(operator.identity_rows.ravel())[0]
    assert len(rows)
    for row in rows:
        line = matrix[[row]].toarray()[0]
        assert line[row] == operator.identity_scale
        assert np.count_nonzero(line) == 1
        assert np.count_nonzero(matrix[:, [row]].toarray()) == 1
