"""The same lattice as a matrix for SciPy: the same answers, beside finite elements' own."""

import numpy as np
import pytest

from cmverify.cases import registry
from cmverify.studies import assembled, precision


@pytest.mark.parametrize(("name", "finer"), [("bimaterial-disc", "fem/P2 graded"),
                                             ("hole-tractions-anisotropic", "fem/P2 graded"),
                                             ("free-plates", "fem/P2, mild 30°")])  # fmt: skip
def test_rivals_and_the_assembled_matrix_solve_the_same_problem(name, finer):
    case = registry.get(name)
    methods = {m.name: m for m in precision.methods_of(case)}
    own = case.poses[0].method
    n = case.method(own).coarsest
    error = case.method(own).run(n).quantities[case.primary]
    usual = methods[f"{own}, assembled"].run(n)
    assert usual.quantities[case.primary] == pytest.approx(error, rel=1e-4)
    rough = methods[finer.replace("P2 graded", "P1").replace("P2", "P1")].run(n)
    fine = methods[finer].run(n)
    assert fine.quantities[case.primary] < 0.3 * rough.quantities[case.primary] < 0.02
    assert fine.total_seconds > 0
    larger = [m for m in methods if m.endswith(("m = 3", "m = 4"))]
    assert len(larger) == (2 if name.startswith("hole") else 0)  # the others have m = 3


def test_what_the_assembled_matrix_cannot_solve_is_no_method():
    assert assembled.method(*_posed("lamb")) is None
    with pytest.raises(ValueError, match="other particles"):
        assembled.at(np.zeros((1, 2)), np.ones((1, 2)), 0.1, np.zeros(1))


def _posed(name):
    case = registry.get(name)
    return case, case.poses[0]
