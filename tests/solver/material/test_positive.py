"""The nearest non-negative point with given moments: feasibility and optimality conditions."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.optimize import linprog

from solver import ConductivityTensor, ElasticTensor, Family
from solver.errors import CalibrationError
from solver.material import ConductiveModuli, calibrate, effective_tensor, positive
from solver.material.positive import closest, feasible
from tests.solver.bodies import exact


def problem(seed, rows, size, signed):
    rng = np.random.default_rng(seed)
    moments = rng.uniform(-1 if signed else 0, 1, (rows, size))
    wanted = np.maximum(rng.normal(0.3, 1.0, size), 0.0)
    return rng, moments, wanted


@exact
@given(st.integers(0, 10**6), st.integers(1, 6), st.integers(8, 30), st.booleans())
def test_satisfies_the_optimality_conditions(seed, rows, size, signed):
    rng, moments, wanted = problem(seed, rows, size, signed)
    target = moments @ np.where(rng.random(size) < 0.6, rng.random(size), 0.0)
    x = closest(moments, target, wanted)
    assert x is not None
    assert x.min() >= 0
    np.testing.assert_allclose(moments @ x, target, atol=1e-12 * np.abs(target).max())
    # Stationarity: x − wanted − momentsᵀ λ is zero where x > 0 and not negative elsewhere.
    support = x > 0
    lam = np.linalg.lstsq(moments[:, support].T, (x - wanted)[support], rcond=None)[0]
    slack = x - wanted - moments.T @ lam
    scale = max(np.abs(wanted).max(), x.max())
    assert np.abs(slack[support]).max() < 1e-9 * scale
    assert slack[~support].min(initial=0.0) > -1e-9 * scale


@exact
@given(st.integers(0, 10**6), st.integers(2, 6), st.integers(3, 12))
def test_feasibility_agrees_with_linear_programming(seed, rows, size):
    rng, moments, wanted = problem(seed, rows, size, signed=True)
    target = rng.normal(size=rows)
    program = linprog(np.zeros(size), A_eq=moments, b_eq=target, bounds=(0, None))
    assert feasible(moments, target) == (program.status == 0)
    assert (closest(moments, target, wanted) is not None) == (program.status == 0)


def test_projection_by_hand():
    # Nearest to (1, 0) on x + y = 3, then with the bound active on x + y = 1 from (2, 0).
    np.testing.assert_allclose(
        closest(np.ones((1, 2)), np.array([3.0]), np.array([1.0, 0.0])), [2.0, 1.0]
    )
    np.testing.assert_array_equal(
        closest(np.ones((1, 2)), np.array([1.0]), np.array([2.0, 0.0])), [1.0, 0.0]
    )


def test_empty_sets():
    moments = np.array([[1.0, 2.0], [0.0, 1.0]])
    assert closest(moments, np.array([-1.0, 0.0]), np.zeros(2)) is None
    assert closest(moments, np.array([1.0, 1.0]), np.zeros(2)) is None


def test_rows_without_entries_are_no_condition():
    moments = np.array([[1.0, 1.0], [0.0, 0.0]])
    assert closest(moments, np.array([1.0, 0.0]), np.zeros(2)) == pytest.approx([0.5, 0.5])


def test_a_point_that_already_fits_stays():
    _, moments, wanted = problem(3, 4, 20, signed=False)
    np.testing.assert_allclose(closest(moments, moments @ wanted, wanted), wanted, atol=1e-12)


@exact
@given(st.integers(0, 10**6), st.sampled_from([2, 3, 4, 5]))
def test_moments_on_the_edge_of_the_possible(seed, m):
    # Tensors made of two or three bonds have hardly another representation.
    rng, family = np.random.default_rng(seed), Family(m)
    half = family.size // 2
    k = np.zeros(half)
    k[rng.choice(half, 3, replace=False)] = rng.uniform(0.1, 1, 3)
    matrix = effective_tensor(family, ConductiveModuli(np.tile(k, 2)))
    assume(np.linalg.eigvalsh(matrix)[0] > 1e-6 * matrix.max())
    found = calibrate(family, ConductivityTensor(matrix), "positive")
    np.testing.assert_allclose(effective_tensor(family, found), matrix, atol=1e-10 * matrix.max())


@exact
@given(st.integers(0, 10**6), st.integers(1, 6), st.integers(8, 30), st.booleans())
def test_where_the_search_starts_makes_no_difference(seed, rows, size, signed):
    rng, moments, wanted = problem(seed, rows, size, signed)
    target = moments @ np.where(rng.random(size) < 0.6, rng.random(size), 0.0)
    found = closest(moments, target, wanted)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(positive, "_by_multipliers", lambda *_: None)
        other = closest(moments, target, wanted)
    assert found is not None
    assert other is not None
    np.testing.assert_allclose(found, other, rtol=0, atol=1e-10 * other.max())


@pytest.mark.parametrize("nu", [0.0, 0.3, 1 / 3])
def test_long_horizons_are_searched_for_multipliers_only(monkeypatch, nu):
    """Least squares in all moduli of twenty cells (656 of each kind) would take far too long."""
    shapes, plain = [], positive.nnls

    def watched(matrix, *args, **options):
        shapes.append(matrix.shape)
        return plain(matrix, *args, **options)

    monkeypatch.setattr(positive, "nnls", watched)
    family, material = Family(20), ElasticTensor.isotropic(1.0, nu)
    found = calibrate(family, material, "positive")
    assert max(rows for rows, _ in shapes) <= 8
    np.testing.assert_allclose(effective_tensor(family, found), material.voigt, atol=1e-12)


def test_a_search_that_does_not_end_is_refused_by_name(monkeypatch):
    def endless(*args, **options):
        raise RuntimeError("Maximum number of iterations reached.")

    monkeypatch.setattr(positive, "nnls", endless)
    with pytest.raises(CalibrationError, match="does not end"):
        positive.feasible(np.eye(3), np.ones(3))
