"""Which preconditioner and which iteration a body gets, and what it is called."""

import numpy as np
import pytest

from solver import ElasticTensor, Scene, Support, rectangle
from solver.linear import BlockJacobi, Task, TwoLevel, method
from solver.operators.assembled import to_csr


def operator(poisson: float = 0.2, n: int = 12):
    scene = Scene(
        region=rectangle(1.0, 1.0),
        spacing=1.0 / n,
        m=2,
        material=ElasticTensor.isotropic(1.0, poisson),
        supports=[Support.where(lambda x, y: x < -0.3, displacement=(0.0, 0.0), rotation=0.0)],
    )
    return scene.discretise().operator


def test_small_bodies_take_one_level_and_large_ones_two():
    small, large = operator(), operator(n=32)
    assert large.shape[0] >= 2000 > small.shape[0]
    assert isinstance(method.preconditioner(small, "positive"), BlockJacobi)
    assert isinstance(method.preconditioner(large, "positive"), TwoLevel)
    assert isinstance(method.preconditioner(small, "positive", "two-level"), TwoLevel)
    assert isinstance(method.preconditioner(large, "positive", "block-jacobi"), BlockJacobi)


def test_an_unknown_preconditioner_is_refused():
    with pytest.raises(ValueError, match="unknown preconditioner 'best'"):
        method.preconditioner(operator(), "positive", "best")  # type: ignore[arg-type]


@pytest.mark.parametrize(("poisson", "kind"), [(0.2, "positive"), (0.45, "indefinite")])
def test_iterate_solves_positive_and_indefinite_bodies(poisson, kind):
    body = operator(poisson)
    rhs = np.random.default_rng(1).normal(size=body.shape[0])
    inverse = method.preconditioner(body, kind)
    x, count = method.iterate(body, kind, inverse, Task(rhs, 0 * rhs, 1e-11, 2000))
    assert count > 0
    assert method.relative_residual(body, x, rhs) <= 1e-11
    direct = np.linalg.solve(to_csr(body).toarray(), rhs)
    np.testing.assert_allclose(x, direct, atol=1e-8 * np.abs(direct).max())


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", [2.0**-900, 2.0**-300, 2.0**300, 2.0**900])
@pytest.mark.parametrize(("poisson", "kind"), [(0.2, "positive"), (0.45, "indefinite")])
def test_the_load_s_size_makes_no_difference(size, poisson, kind):
    body = operator(poisson)
    rhs = np.random.default_rng(1).normal(size=body.shape[0])
    inverse = method.preconditioner(body, kind)
    x, count = method.iterate(body, kind, inverse, Task(rhs, 0 * rhs, 1e-9, 2000))
    rhs *= size
    scaled, again = method.iterate(body, kind, inverse, Task(rhs, 0 * rhs, 1e-9, 2000))
    assert abs(again - count) <= 1
    np.testing.assert_allclose(scaled / size, x, atol=1e-7 * np.abs(x).max())


def test_nothing_to_solve():
    body = operator()
    zero = np.zeros(body.shape[0])
    x, count = method.iterate(
        body, "positive", method.preconditioner(body, "positive"), Task(zero, zero + 1, 1e-8, 10)
    )
    assert count == 0
    assert not x.any()
    assert method.relative_residual(body, zero, zero) == 0.0
    assert method.name("positive", None) == "nothing to solve"


def test_names_say_what_is_done():
    body = operator()
    inverse = method.preconditioner(body, "positive")
    assert method.name("positive", inverse) == "CG, block Jacobi"
    assert method.name("indefinite", inverse) == "CG on condensed displacements, block Jacobi"
