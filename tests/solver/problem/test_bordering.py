"""The border that masters make: symmetric with the operator, and nothing where bonds are not."""

import numpy as np
import pytest

from solver.operators import BondOperator
from solver.problem.bordering import border
from tests.solver.problem.test_constraints import pinned


@pytest.mark.parametrize("surface", ["none", "volume", "extrapolated"])
def test_the_bordered_system_is_the_whole_one_in_the_masters(surface):
    parts = pinned(surface=surface).discretise(constrained=True)
    found, slaves = border(parts), parts.constraints.slaves
    whole = BondOperator(parts.bonds, parts.moduli, parts.prescribed & ~slaves)
    rng = np.random.default_rng(1)
    z, x = (
        rng.standard_normal(parts.constraints.count),
        rng.standard_normal(parts.operator.shape[0]),
    )
    field = parts.constraints.field(z)
    field[:, parts.operator.active] += np.where(
        slaves[:, parts.operator.active], 0.0, x.reshape(3, -1)
    )
    energy = float((field * whole.product(field)).sum())
    own = float(x @ parts.operator.matvec(x))
    mine = own + 2 * float(x @ found.coupling @ z) + float(z @ found.stiffness @ z)
    assert mine == pytest.approx(energy, rel=1e-10)
    np.testing.assert_allclose(found.stiffness, found.stiffness.T)
