"""Moduli of several solids: what they share, and what nobody may ask of them."""

import numpy as np
import pytest

from solver import (
    ConductivityTensor,
    ElasticTensor,
    Family,
    InadmissibleMaterialError,
    SceneError,
    material,
)
from solver.material import Mixture, assess, calibrate, together

FAMILY = Family(3, 0.1)
OF = np.array([0, 1, 1, 0])


def moduli(tensor):
    return calibrate(FAMILY, tensor)


SOFT, STIFF = (moduli(ElasticTensor.isotropic(e, 0.2)) for e in (1.0, 5.0))
BOTH = Mixture((SOFT, STIFF), OF)


def test_every_bond_has_the_moduli_of_its_phase():
    for o in (0, 5):
        each = BOTH.of_offset(o)
        np.testing.assert_allclose(each, SOFT.stiffness[:, o, None] * np.where(OF, 5.0, 1.0))
    offset, phase = np.array([3, 4]), np.array([1, 0])
    found = BOTH.of_bonds(offset, phase)
    np.testing.assert_allclose(found[:, 0], STIFF.stiffness[:, 3])
    np.testing.assert_allclose(found[:, 1], SOFT.stiffness[:, 4])
    np.testing.assert_allclose(SOFT.of_bonds(offset, None), SOFT.stiffness[:, offset])
    assert (BOTH.strains, BOTH.components, BOTH.physics) == (("s", "γ"), 3, SOFT.physics)
    assert BOTH.each == (SOFT, STIFF)
    assert SOFT.each == (SOFT,)
    assert BOTH.non_negative
    assert BOTH.absolute().of is OF


def test_who_thinks_of_one_material_is_refused():
    with pytest.raises(SceneError, match="one material only"):
        _ = BOTH.stiffness
    with pytest.raises(SceneError, match="one material only"):
        BOTH.of_bonds(np.array([1]), None)
    with pytest.raises(SceneError, match="one material only"):
        material.effective_tensor(FAMILY, BOTH)


def test_solids_that_do_not_go_together():
    central = moduli(ElasticTensor.isotropic(1.0, 1 / 3))
    with pytest.raises(SceneError, match="different unknowns"):
        Mixture((SOFT, central), OF)
    with pytest.raises(SceneError, match="different unknowns"):
        Mixture((SOFT, moduli(ConductivityTensor.isotropic(1.0))), OF)
    kinds = [assess(FAMILY, m) for m in (SOFT, moduli(ElasticTensor.isotropic(1.0, 0.4)))]
    with pytest.raises(InadmissibleMaterialError, match="of different kinds"):
        together(tuple(kinds))
    assert together((kinds[0], kinds[0])) is kinds[0]
    with pytest.raises(SceneError, match="different unknowns"):
        together((kinds[0], assess(FAMILY, central)))
