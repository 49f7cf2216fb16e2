"""A part of an operator is the operator with all other particles at zero."""

import numpy as np
import pytest

from solver import ConductivityTensor, Crack, ElasticTensor, Scene, Support, disc
from solver.operators.part import part_of

VOIGT = np.array([[1, 0.2, 0.1], [0.2, 0.8, 1 / 6], [0.1, 1 / 6, 1 / 3]])


@pytest.mark.parametrize("surface", ["none", "volume", "extrapolated"])
@pytest.mark.parametrize(
    "material",
    [ElasticTensor(VOIGT), ElasticTensor.isotropic(1.0, 1 / 3), ConductivityTensor(np.eye(2))],
)
def test_products_of_a_part_are_rows_and_columns_of_the_body_s(material, surface):
    value = {"displacement": (0.0, 0.0)}
    if isinstance(material, ConductivityTensor):
        value = {"temperature": 0.0}
    supports = [Support.where(lambda x, y: y < -0.7, **value)]
    cracks = [Crack((-1.5, 0.0), (0.1, 0.2))]
    scene = Scene(disc(1.0), 0.1, material, supports, m=2, cracks=cracks, surface=surface)
    operator = scene.discretise().operator
    allowed = np.ones(len(operator.active), dtype=bool)
    if operator.identity_rows is not None:
        allowed = ~operator.identity_rows.any(axis=0)
    if operator.ended_stiffness is not None:
        allowed[operator.at_surface] = False
    rng, c = np.random.default_rng(3), operator.components
    # Anything at all, and all of it.
    for share in (0.1, 0.6, 1.0):
        positions = np.nonzero(allowed & (rng.random(len(allowed)) <= share))[0]
        part = part_of(operator, positions)
        x = rng.normal(size=(c, len(positions)))
        whole = np.zeros((c, len(allowed)))
        whole[:, positions] = x
        wanted = operator.matvec(whole.ravel()).reshape(c, -1)[:, positions]
        np.testing.assert_allclose(part.matvec(x.ravel()).reshape(c, -1), wanted, atol=1e-12)
        np.testing.assert_array_equal(part.block_diagonal, operator.block_diagonal[positions])
