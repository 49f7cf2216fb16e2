"""Moments of bonds, and the tensor that a family's moduli make."""

import dataclasses

import numpy as np
import pytest

from solver import ConductivityTensor, ElasticTensor, Family
from solver.material import ConductiveModuli, ElasticModuli, calibrate
from solver.material.mixture import Mixture
from solver.material.moduli import (
    PAIRS3,
    Moduli,
    bond_weights,
    conductive_moments,
    effective_tensor,
    elastic_moments,
    stretch_rows,
)
from tests.solver.bodies import DISC, FIG_7

PSI = np.linspace(0.0, np.pi, 7)


def test_stretch_and_shear_of_a_strain():
    strain = np.array([[0.3, 0.1], [0.1, -0.2]])
    stretch, shear = stretch_rows(PSI)
    vector = [0.3, -0.2, 0.2]
    n = np.array([np.cos(PSI), np.sin(PSI)])
    t = np.array([-n[1], n[0]])
    np.testing.assert_allclose(vector @ stretch, np.einsum("ik,ij,jk->k", n, strain, n), atol=1e-15)
    np.testing.assert_allclose(vector @ shear, np.einsum("ik,ij,jk->k", t, strain, n), atol=1e-15)


def test_moments_are_products_of_them():
    """In the order 11, 22, 12, 66, 16, 26 of the tensor's entries."""
    stretch, shear = stretch_rows(PSI)
    normal, tangential = elastic_moments(PSI)
    order = list(zip(*PAIRS3, strict=True))
    assert sorted(order) == [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]
    for row, other, (a, b) in zip(normal, tangential, order, strict=True):
        np.testing.assert_array_equal(row, stretch[a] * stretch[b])
        np.testing.assert_array_equal(other, shear[a] * shear[b])
    c, s = np.cos(PSI), np.sin(PSI)
    assert any(np.allclose(row, c * s) for row in conductive_moments(PSI))


@pytest.mark.parametrize("calibration", ["lattice", "positive"])
def test_lattice_sums_make_the_tensor_back(calibration):
    family = Family(3, 0.5)
    solid, conductor = ElasticTensor(FIG_7), ConductivityTensor(DISC)
    made = effective_tensor(family, calibrate(family, solid, calibration))
    np.testing.assert_allclose(made, FIG_7, atol=1e-12)
    made = effective_tensor(family, calibrate(family, conductor, calibration))
    np.testing.assert_allclose(made, DISC, atol=1e-12)


def test_rotations_give_way_in_the_effective_tensor():
    """Shear bonds of one direction: the rotation takes what it can."""
    family = Family(1, 1.0, "full")
    shear = np.where(np.abs(family.normal[:, 0]) > 0.5, 1.0, 0.0)
    tensor = effective_tensor(family, ElasticModuli(np.ones(4), shear))
    # One direction of shear springs cannot resist a shear that turns with it.
    assert tensor[2, 2] == pytest.approx(0.0, abs=1e-15)


def test_weights_carry_the_length_in_elasticity_only():
    family = Family(2, 0.5)
    elastic = bond_weights(family, ElasticTensor(FIG_7))
    thermal = bond_weights(family, ConductivityTensor(DISC))
    np.testing.assert_allclose(elastic, thermal * family.length)


def test_what_moduli_say_of_themselves():
    assert ElasticModuli(np.ones(4), np.ones(4)).has_shear
    assert not ElasticModuli(np.ones(4), np.zeros(4)).has_shear
    assert not ElasticModuli(np.ones(4), -np.ones(4)).non_negative
    assert not ConductiveModuli(np.array([1.0, -1.0])).non_negative


def test_a_factor_scales_every_modulus():
    """Whatever a kind of bond has: none of its moduli is forgotten."""
    factor = np.array([2.0, 0.5])
    for kind in subclasses(Moduli):
        if kind is Mixture:
            solids = ElasticModuli(*np.ones((2, 2))), ElasticModuli(*np.full((2, 2), 3.0))
            moduli = Mixture(solids, np.array([0, 1]))
        else:
            size = len(dataclasses.fields(kind))
            moduli = kind(*(np.array([1.0, 3.0]) for _ in range(size)))
        found = moduli.scaled(factor)
        assert type(found) is kind
        for one, before in zip(found.each, moduli.each, strict=True):
            np.testing.assert_array_equal(one.stiffness, before.stiffness * factor)


def subclasses(kind):
    return [k for one in kind.__subclasses__() for k in (one, *subclasses(one))]
