"""Functions are made wrong wherever they are known, and put back; caches forget."""

import numpy as np
import pytest

from cmverify.faults.changes import field, one_nan, result, scaled, swapped, times
from cmverify.faults.fault import applied, find, forget


def double(right):
    return lambda *args, **kwargs: 2 * right(*args, **kwargs)


def test_a_function_is_wrong_where_it_was_imported_and_right_afterwards():
    import solver
    from references.analytic import hole, voigt

    tensor = [[2.0, 0.5, 0.0], [0.5, 1.0, 0.0], [0.0, 0.0, 0.4]]
    right = hole.checked_voigt(tensor)
    with applied({"references.analytic.voigt.checked_voigt": double}) as calls:
        np.testing.assert_array_equal(hole.checked_voigt(tensor), 2 * right)
        np.testing.assert_array_equal(voigt.checked_voigt(tensor), 2 * right)
        assert calls.of == {"references.analytic.voigt.checked_voigt": 2}
    np.testing.assert_array_equal(hole.checked_voigt(tensor), right)
    with applied({"solver.recovery.stress": double}):
        assert solver.recovery.stress is not None


def test_methods_properties_and_class_methods_of_classes_are_reached():
    from solver import ElasticTensor, Family

    solid, length = ElasticTensor.isotropic(1.0, 0.2), Family(3).length
    compliance = solid.compliance
    targets = {
        "solver.material.tensors.ElasticTensor.compliance": scaled(2.0),
        "solver.material.family.Family.length": scaled(3.0),
        "solver.material.tensors.ElasticTensor.isotropic": (
            lambda right: lambda cls, E, nu: right(cls, 5 * E, nu)
        ),
    }
    with applied(targets) as calls:
        np.testing.assert_allclose(solid.compliance, 2 * compliance)
        np.testing.assert_allclose(Family(3).length, 3 * length)
        np.testing.assert_allclose(ElasticTensor.isotropic(1.0, 0.2).voigt, 5 * solid.voigt)
        assert set(calls.of.values()) == {1}
    np.testing.assert_array_equal(solid.compliance, compliance)
    np.testing.assert_array_equal(Family(3).length, length)
    np.testing.assert_array_equal(ElasticTensor.isotropic(1.0, 0.2).voigt, solid.voigt)


def test_an_error_inside_puts_everything_back():
    target = "references.analytic.compact_tension.shape_factor"
    owner, name = find(target)
    right = vars(owner)[name]
    with pytest.raises(ZeroDivisionError), applied({target: double}):
        raise ZeroDivisionError
    assert vars(owner)[name] is right


def test_what_is_cached_is_forgotten():
    from cmverify.cases.kinking import angles

    angle = angles.energy_angle("silicon", 45.0)
    turned = result(lambda value: value + 1.0)
    with applied({"references.fem.kinks.KinkTable.kink_angle": turned}):
        assert angles.energy_angle("silicon", 45.0) == pytest.approx(angle + np.degrees(1.0))
    assert angles.energy_angle("silicon", 45.0) == angle
    forget()
    assert angles.energy_angle.cache_info().currsize == 0


@pytest.mark.parametrize("target", ["solver.nothing.at_all", "solver.recovery.nothing", "nobody.x"])
def test_a_target_that_does_not_exist_is_named(target):
    with pytest.raises(LookupError, match="does not exist"), applied({target: None}):
        pass


def test_changes_change_what_they_say():
    pair = (1.0, np.array([2.0]))
    assert scaled(2.0)(lambda: pair)()[1] == [4.0]
    assert np.isnan(one_nan(np.ones((3, 2)))).sum() == 1
    assert np.isnan(one_nan(np.moveaxis(np.ones((3, 2, 4)), 2, 0))).sum() == 1
    assert np.isnan(one_nan(1.0))
    np.testing.assert_array_equal(swapped()(np.array([[1.0, 2.0]])), [[2.0, 1.0]])
    from cmverify.case import Curve

    curve = Curve("c", np.ones(2), np.ones(2), np.ones(2))
    assert field("computed", times(2.0))(lambda: curve)().computed[0] == 2.0
    assert field("absent", times(2.0))(lambda: curve)() is curve
