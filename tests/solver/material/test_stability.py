"""The bulk symbol: a row of the operator in Fourier space, its invariants and its verdicts."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import (
    ConductivityTensor,
    ElasticTensor,
    Family,
    InadmissibleMaterialError,
    Scene,
    Support,
    TwoHarmonic,
    UniformShear,
    disc,
)
from solver.bonds import Bonds
from solver.geometry import Lattice
from solver.material import (
    ConductiveModuli,
    ElasticModuli,
    acoustic_tensor,
    assess,
    bond_weights,
    brillouin_zone,
    calibrate,
    condensed_symbol,
    margins,
    require_admissible,
)
from solver.material.symbol import symbol
from solver.operators import BondOperator
from solver.operators.assembled import to_csr
from tests.solver.bodies import (
    DISC,
    FIG_7,
    block,
    conductivities,
    exact,
    few,
    random_moduli,
    voigts,
)

# C11, C22, C12, C66 of a carbon/epoxy ply, GPa (measured).
PLY = ElasticTensor([[140, 3, 0], [3, 10, 0], [0, 0, 5]])


def operator_of(family, moduli, cells):
    bonds = Bonds(
        Lattice(block(cells, cells, family.spacing), family.spacing, family.reach), family
    )
    components = 1 if not isinstance(moduli, ElasticModuli) else 3 if moduli.has_shear else 2
    return BondOperator(bonds, moduli, np.zeros((components, cells**2), dtype=bool))


@few
@given(
    st.sampled_from(["elastic", "central", "conductive", "polar"]),
    st.integers(0, 10**6),
    st.tuples(st.floats(-3.1, 3.1), st.floats(-3.1, 3.1)),
    st.sampled_from([1, 2, 2.5]),
)
def test_symbol_is_the_bloch_transform_of_a_row_of_the_operator(kind, seed, k, m):
    family = Family(m, 0.5)
    moduli = random_moduli(family, kind, seed)
    cells = 2 * family.reach + 1
    operator = operator_of(family, moduli, cells)
    c, count = operator.components, cells**2
    middle = count // 2
    offset = (operator.bonds.lattice.points - operator.bonds.lattice.points[middle]) / 0.5
    wave = np.exp(1j * (offset @ np.array(k)))
    rows = to_csr(operator)[middle + count * np.arange(c), :].toarray().reshape(c, c, count)
    bloch = rows @ wave
    # The operator turns θ Δx, the symbol θ.
    scale = np.array([1.0, 1.0, 0.5])[:c]
    bloch = bloch * np.outer(scale, scale)
    found = symbol(family, moduli, np.array(k))
    tolerance = 1e-12 * np.abs(rows).max()
    np.testing.assert_allclose(found, bloch, atol=tolerance)


@exact
@given(voigts(), st.sampled_from([3, 4.5, 5]), st.sampled_from([None, UniformShear()]))
def test_invariants_of_the_sums(voigt, m, law):
    # w = ½ α Λ |ξ| Δx².
    family = Family(m, 0.1)
    moduli = calibrate(family, ElasticTensor(voigt), "lattice", law)
    weight = bond_weights(family, ElasticTensor(voigt))
    invariant = voigt[0, 0] + voigt[1, 1] + 2 * voigt[0, 1]
    assert weight @ moduli.normal == pytest.approx(invariant, rel=1e-11)
    assert weight @ moduli.shear == pytest.approx(
        4 * (voigt[2, 2] - voigt[0, 1]), abs=1e-11 * np.abs(voigt).max()
    )


@exact
@given(voigts(), st.floats(0, 6.3))
def test_long_waves_see_the_elastic_solid(voigt, angle):
    family = Family(4, 0.1)
    moduli = calibrate(family, ElasticTensor(voigt), "lattice", UniformShear())
    direction = np.array([np.cos(angle), np.sin(angle)])
    k = 1e-4 * direction
    if abs(voigt[2, 2] - voigt[0, 1]) < 1e-3:
        return
    wanted = acoustic_tensor(voigt, direction)
    found = condensed_symbol(family, moduli, k) * family.spacing**2 / 1e-8
    np.testing.assert_allclose(found, wanted, atol=1e-4 * np.abs(voigt).max())
    assert margins(family, moduli, k) == pytest.approx(1.0, abs=1e-3)


@exact
@given(conductivities(), st.floats(0, 6.3))
def test_long_waves_see_the_conductor(matrix, angle):
    family = Family(4, 0.1)
    moduli = calibrate(family, ConductivityTensor(matrix), "lattice")
    k = 1e-4 * np.array([np.cos(angle), np.sin(angle)])
    found = symbol(family, moduli, k) * family.spacing**2
    assert found == pytest.approx(k @ matrix @ k, rel=1e-6)
    assert margins(family, moduli, k) == pytest.approx(1.0, abs=1e-6)


def test_acoustic_tensor_of_an_isotropic_solid():
    E, nu = 2.0, 0.3
    c = ElasticTensor.isotropic(E, nu).voigt
    angle = 0.7
    n = np.array([np.cos(angle), np.sin(angle)])
    wanted = c[2, 2] * np.eye(2) + (c[0, 0] - c[2, 2]) * np.outer(n, n)
    np.testing.assert_allclose(acoustic_tensor(c, n), wanted, rtol=1e-12)


def test_the_zone_holds_one_of_each_pair_and_not_the_origin():
    k = brillouin_zone(8)
    assert np.linalg.norm(k, axis=1).min() > 0
    assert np.abs(k).max() == pytest.approx(np.pi)
    assert (k[:, 1] >= 0).all()


# ---- verdicts -----------------------------------------------------------------------------------


@pytest.mark.parametrize("m", [3, 5])
@pytest.mark.parametrize(
    ("nu", "plane", "sign"),
    [
        (0.2, "stress", "positive"),
        (1 / 3, "stress", "central"),
        (0.34, "stress", "indefinite"),
        (0.49, "stress", "indefinite"),
        (0.499, "stress", "indefinite"),
        # Plane strain reaches C66 = C12 at ν = 1/4 and its limit between 0.36 and 0.40.
        (0.24, "strain", "positive"),
        (0.25, "strain", "central"),
        (0.36, "strain", "indefinite"),
        (0.40, "strain", "inadmissible"),
        (0.45, "strain", "inadmissible"),
    ],
)
def test_isotropic_solids(nu, plane, sign, m):
    family = Family(m)
    found = assess(family, calibrate(family, ElasticTensor.isotropic(1.0, nu, plane)))
    assert found.kind == sign
    assert (found.margin > 0) == (sign != "inadmissible")
    low, high = found.rotation_range
    assert {"positive": low > 0, "central": low == high == 0}.get(sign, high < 0)


@pytest.mark.parametrize("m", [3, 5])
def test_carbon_epoxy(m):
    family = Family(m)
    harmonic = assess(family, calibrate(family, PLY, "lattice", TwoHarmonic()))
    assert harmonic.kind == "inadmissible"
    low, high = harmonic.rotation_range
    assert low < 0 < high
    assert assess(family, calibrate(family, PLY, "positive")).kind == "positive"


def test_refusals_name_the_wave_vector():
    family = Family(3)
    moduli = calibrate(family, ElasticTensor.isotropic(1.0, 0.4, "strain"))
    with pytest.raises(
        InadmissibleMaterialError, match="condensed symbol is not positive"
    ) as caught:
        require_admissible(family, moduli)
    k = [float(v) for v in re.search(r"\((-?[\d.]+), (-?[\d.]+)\)", str(caught.value)).groups()]
    assert np.linalg.eigvalsh(condensed_symbol(family, moduli, np.array(k)))[0] < 0
    with pytest.raises(InadmissibleMaterialError, match="passes through zero at the wave vector"):
        require_admissible(family, calibrate(family, PLY, "lattice", TwoHarmonic()))


def test_scenes_refuse_what_is_unstable_before_they_look_at_the_rest():
    scene = Scene(
        disc(1.0),
        0.001,
        ElasticTensor.isotropic(1.0, 0.4, "strain"),
        supports=[Support.layer(5, displacement=np.zeros((3, 7)))],
    )
    with pytest.raises(InadmissibleMaterialError, match="unstable in bulk at m = 5"):
        scene.discretise()


def test_a_negative_bond_can_sink_a_conductor():
    family = Family(3)
    moduli = calibrate(family, ConductivityTensor(DISC))
    assert assess(family, moduli).kind == "positive"
    # The paper's two-harmonic law goes negative across the fibres; here far too much so.
    axis = ConductivityTensor.orthotropic(200.0, 1.0, 0.2)
    assert not calibrate(family, axis, "continuum", TwoHarmonic()).non_negative
    assert (
        assess(family, calibrate(family, axis, "continuum", TwoHarmonic())).kind == "inadmissible"
    )


@few
@given(st.integers(0, 10**6))
def test_the_margin_is_a_lower_bound_of_every_wave(seed):
    family = Family(3)
    for material in (ElasticTensor(FIG_7), ElasticTensor.isotropic(1.0, 0.45)):
        moduli = calibrate(family, material)
        found = assess(family, moduli)
        k = np.random.default_rng(seed).uniform(-np.pi, np.pi, (200, 2))
        assert margins(family, moduli, k).min() > found.margin - 1e-6


@pytest.mark.parametrize(
    ("nu", "plane", "admissible"),
    [
        (0.2, "stress", True),
        (0.45, "stress", True),
        (0.36, "strain", True),
        (0.42, "strain", False),
    ],
)
def test_verdict_agrees_with_the_inertia_of_a_clamped_body(nu, plane, admissible):
    # K has as many negative eigenvalues as rotations with negative stiffness, and no more where
    # the operator condensed onto displacements is positive.
    family = Family(2)
    moduli = calibrate(family, ElasticTensor.isotropic(1.0, nu, plane))
    cells, reach = 15, family.reach
    bonds = Bonds(Lattice(block(cells, cells), 1.0, reach), family)
    x, y = bonds.lattice.points.T
    edge = np.minimum(np.minimum(x, cells - x), np.minimum(y, cells - y)) < reach
    operator = BondOperator(bonds, moduli, np.tile(edge, (3, 1)))
    negative = int((np.linalg.eigvalsh(to_csr(operator).toarray()) < 0).sum())
    rotations = len(operator.active) if moduli.shear.max() < 0 else 0
    assert (negative == rotations) == admissible
    assert negative >= rotations
    assert (assess(family, moduli).kind != "inadmissible") == admissible


@pytest.mark.parametrize(
    ("material", "law"),
    [
        (ConductivityTensor(DISC), None),
        (ConductivityTensor(DISC), TwoHarmonic()),
        (ElasticTensor(FIG_7), None),
        (ElasticTensor.isotropic(1.0, 0.45), None),
        (ElasticTensor.isotropic(1.0, 0.36, "strain"), None),
    ],
)
def test_the_margin_is_taken_at_the_wave_vector_that_is_named(material, law):
    family = Family(5)
    moduli = calibrate(family, material, "lattice", law)
    found = assess(family, moduli)
    k = np.array(found.wave_vector)
    assert np.abs(k).max() <= np.pi
    assert margins(family, moduli, k) == pytest.approx(found.margin, rel=1e-9)


def test_sums_that_are_not_positive_definite_are_inadmissible():
    # A ratio of two negatives must not pass for positive.
    family = Family(3)
    for moduli in (
        ConductiveModuli(-np.ones(family.size)),
        ElasticModuli(-np.ones(family.size), np.zeros(family.size)),
    ):
        found = assess(family, moduli)
        assert found.kind == "inadmissible"
        assert found.margin < 0
        with pytest.raises(InadmissibleMaterialError, match="releases energy"):
            require_admissible(family, moduli)


SOME = {"E1": 10.0, "E2": 5.0, "G12": 2.0, "nu12": 0.2}


def test_what_is_known_of_a_solid_is_found_by_its_numbers():
    def found(spacing=1.0, **numbers):
        family = Family(3, spacing)
        return assess(family, calibrate(family, ElasticTensor.orthotropic(**{**SOME, **numbers})))

    first = found()
    assert found() is first  # other objects, the same numbers
    for other in (found(E1=11.0), found(spacing=0.5)):
        assert other is not first
    moduli = calibrate(Family(3), ElasticTensor.isotropic(1.0, 0.2))
    before = assess(Family(3), moduli)
    moduli.shear[:] = 0.0  # nobody should, and nobody is told what was true before
    assert assess(Family(3), moduli).kind == "central" != before.kind
