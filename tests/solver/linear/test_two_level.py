"""The two-level method: symmetric, positive, flat in the spacing, reusable."""

import dataclasses

import numpy as np
import pytest
from scipy.sparse.linalg import aslinearoperator

from references.analytic import lekhnitskii
from solver import ConductivityTensor, Crack, ElasticTensor, Scene, Support, disc
from solver.analyses.statics import solve
from solver.linear import BlockJacobi, Task, TwoLevel, method, two_level
from solver.operators.assembled import to_csr

VOIGT = np.array([[1, 0.2, 0.1], [0.2, 0.8, 1 / 6], [0.1, 1 / 6, 1 / 3]])


def _crack_tip(resolution: int) -> Scene:
    return Scene(
        region=disc(1.0),
        spacing=1 / resolution,
        material=ElasticTensor(VOIGT),
        cracks=[Crack((-1.5, 0.0), (0.0, 0.0))],
        supports=[
            Support.layer(
                cells=5.5,
                displacement=lambda x, y: lekhnitskii.crack_tip_displacement(VOIGT, x, y, 1.0, 0.0),
                rotation=lambda x, y: lekhnitskii.crack_tip_rotation(VOIGT, x, y, 1.0, 0.0),
            )
        ],
    )


def _dense(operator: object, size: int) -> np.ndarray:
    return np.column_stack([operator.matvec(e) for e in np.eye(size)])  # type: ignore[attr-defined]


@pytest.mark.parametrize("partly", [False, True])
def test_symmetric_positive_and_within_the_smoother_s_bound(partly: bool) -> None:
    supports = [Support.layer(cells=3.5, displacement=(0.0, 0.0), rotation=0.0)]
    if partly:
        supports = [
            Support.where(lambda x, y: y < -0.6, u2=0.0),
            Support.where(lambda x, y: x < -0.6, u1=0.0),
        ]
    scene = Scene(
        region=disc(1.0), spacing=1 / 10, m=3, material=ElasticTensor(VOIGT), supports=supports,
        cracks=[Crack((-1.5, 0.0), (0.0, 0.0))],
    )  # fmt: skip
    operator = scene.discretise().operator
    size = operator.shape[0]
    m = _dense(TwoLevel(operator, coarsening=4, precision=np.float64), size)
    assert np.abs(m - m.T).max() <= 1e-10 * np.abs(m).max()
    stiffness = to_csr(operator).toarray()
    spectrum = np.linalg.eigvals(m @ stiffness)
    assert np.abs(spectrum.imag).max() < 1e-8
    # A V-cycle with a smoother that never amplifies has its spectrum in (0, 1].
    assert spectrum.real.min() > 0.0
    assert spectrum.real.max() <= 1.0 + 1e-8
    # The rigorous bound on which the smoother rests.
    jacobi = _dense(BlockJacobi(operator), size)
    assert np.linalg.eigvals(jacobi @ stiffness).real.max() <= 2.0 + 1e-10


@pytest.mark.parametrize("size", [1, 2, 3])
def test_inverses_of_blocks_and_those_that_are_left(size: int) -> None:
    rng = np.random.default_rng(size)
    half = rng.normal(size=(200, size, size))
    blocks = half @ half.transpose(0, 2, 1)
    blocks[:4], blocks[4:8], blocks[8:12] = -blocks[:4], 0.0, np.ones((size, size))
    blocks[8:12] += 1e-9 * np.eye(size)
    found = np.empty((size, size, 200))
    left = two_level._invert(np.ascontiguousarray(np.moveaxis(blocks, 0, 2)), found)
    values = np.linalg.eigvalsh(blocks)
    assert set(left) >= set(range(8 if size == 1 else 12))
    sound = np.setdiff1d(np.arange(200), left)
    assert len(sound) > 100
    assert (values[sound, 0] > 1e-7 * values[sound, -1]).all()
    product = np.einsum("pij,jkp->pik", blocks[sound], found[:, :, sound])
    np.testing.assert_allclose(product, np.broadcast_to(np.eye(size), product.shape), atol=1e-7)


def test_the_largest_eigenvalue_is_found_from_below() -> None:
    scene = dataclasses.replace(_crack_tip(12), surface="extrapolated", m=3)
    operator = scene.discretise().operator
    jacobi = BlockJacobi(operator)
    size = operator.shape[0]
    largest = np.linalg.eigvals(_dense(jacobi, size) @ to_csr(operator).toarray()).real.max()
    found = two_level.largest_ritz(operator, jacobi, 8)
    assert 0.9 * largest < found <= largest * (1 + 1e-10)
    # The V-cycle's bound is above it, as the estimate alone need not be.
    assert TwoLevel(operator).largest > 1.05 * largest
    # A Krylov space that is the whole one.
    exact = aslinearoperator(np.diag([1.0, 2.0, 5.0])), aslinearoperator(np.eye(3))
    assert two_level.largest_ritz(*exact, 8) == pytest.approx(5.0, rel=1e-12)


@pytest.mark.parametrize("unit", [1e-9, 1.0, 1e12])
def test_single_precision_costs_no_iterations_down_to_1e_12(unit: float) -> None:
    scene = dataclasses.replace(_crack_tip(60), material=ElasticTensor(unit * VOIGT))
    problem = scene.discretise()
    rhs, counts = problem.right_hand_side(), []
    for precision in (np.float32, np.float64):
        inverse = TwoLevel(problem.operator, precision=precision)
        task = Task(rhs, np.zeros_like(rhs), 1e-12, 100)
        found, count = method.iterate(problem.operator, "positive", inverse, task)
        assert method.relative_residual(problem.operator, found, rhs) <= 1e-12
        counts.append(count)
    assert counts[0] <= counts[1]


def test_iterations_stay_flat_on_the_crack_tip() -> None:
    counts = []
    for resolution in (30, 60, 90):
        solution = solve(_crack_tip(resolution).discretise(), 1e-8, preconditioning="two-level")
        counts.append(solution.statistics.iterations)
    # Issue C: at most twelve at every spacing.
    assert max(counts) <= 12
    plain = solve(_crack_tip(60).discretise(), 1e-8, preconditioning="block-jacobi")
    assert plain.statistics.iterations > 10 * counts[1]


@pytest.mark.parametrize(("nu", "most"), [(0.35, 14), (0.49, 22)])
def test_iterations_stay_flat_where_the_operator_is_indefinite(nu: float, most: int) -> None:
    counts = []
    for resolution in (40, 80):
        scene = Scene(
            region=disc(1.0), spacing=1 / resolution, material=ElasticTensor.isotropic(1.0, nu),
            supports=[Support.layer(cells=5.5, displacement=lambda x, y: np.stack(
                [x * x - y, x * y], axis=-1), rotation=lambda x, y: 0.5 * (y + 1))],
        )  # fmt: skip
        statistics = scene.solve(1e-8).statistics
        assert statistics.kind == "indefinite"
        assert statistics.method == "CG on condensed displacements, two-level"
        counts.append(statistics.iterations)
    assert max(counts) <= most
    assert abs(counts[1] - counts[0]) <= 2


def test_reuse_after_bonds_broke_gives_the_same_solution() -> None:
    scene = _crack_tip(60)
    first = scene.solve(1e-10)
    grown = dataclasses.replace(scene, cracks=[Crack((-1.5, 0.0), (0.0, 0.0), (0.1, 0.05))])
    fresh, reused = grown.solve(1e-10), grown.solve(1e-10, previous=first)
    assert np.linalg.norm(fresh.displacement - reused.displacement) <= 1e-8 * np.linalg.norm(
        fresh.displacement
    )
    assert reused.statistics.iterations <= fresh.statistics.iterations + 1


def test_warm_start_from_the_solution_itself_needs_no_iteration() -> None:
    scene = _crack_tip(40)
    solution = scene.solve(1e-9)
    again = scene.solve(1e-8, previous=solution)
    assert again.statistics.iterations == 0
    assert np.array_equal(again.displacement, solution.displacement)


def test_a_preconditioner_of_another_body_is_not_updated_but_replaced() -> None:
    scene = _crack_tip(40)
    other = dataclasses.replace(scene, material=ElasticTensor(2.0 * VOIGT + np.diag([0, 0, 1.0])))
    solution = other.solve(1e-9, previous=scene.solve(1e-9))
    assert solution.statistics.iterations <= 20


def test_conduction_takes_two_levels_too() -> None:
    scene = Scene(
        region=disc(1.0), spacing=1 / 80, material=ConductivityTensor([[5, 2], [2, 1]]),
        calibration="positive",
        supports=[Support.layer(cells=5.5, temperature=lambda x, y: np.exp(x - 2 * y) * np.cos(y))],
    )  # fmt: skip
    statistics = scene.solve(1e-8).statistics
    assert statistics.method == "CG, two-level"
    # Conductivity ratio 34: point smoothing is weak along the well-conducting direction, so the
    # count is higher than in elasticity; the goal is twenty, 17 were measured.
    assert statistics.iterations <= 20


def test_unknown_preconditioner_is_refused() -> None:
    with pytest.raises(ValueError, match="unknown preconditioner"):
        _crack_tip(30).solve(preconditioning="magic")


@pytest.mark.parametrize("surface", ["volume", "extrapolated"])
def test_the_smoother_follows_bonds_that_break(surface: str) -> None:
    """Symmetric, positive, and with fewer iterations than the smoother of the sound body."""
    held = [Support.layer(cells=2.5, displacement=(0.0, 0.0), rotation=0.0)]
    if surface == "extrapolated":
        held = [Support.where(lambda x, y: y < -0.5, displacement=(0.0, 0.0), rotation=0.0)]
    scene = Scene(disc(1.0), 0.1, ElasticTensor(VOIGT), held, m=2, surface=surface)
    sound = scene.discretise()
    family, points = sound.family, sound.lattice.points
    up = (family.offsets[: family.size // 2] == [0, 1]).all(axis=1)
    origins = np.nonzero((np.abs(points[:, 1] + 0.05) < 0.01) & (points[:, 0] < 0.2))[0]
    bonds = sound.bonds.breaking(np.full(len(origins), np.nonzero(up)[0][0]), origins)
    broken = type(sound.operator)(bonds, sound.moduli, sound.prescribed, sound.operator)
    size = broken.shape[0]
    before = TwoLevel(sound.operator, 5, degree=1, precision=np.float64, ratio=4.0)
    m = _dense(before.following(broken), size)
    assert np.abs(m - m.T).max() <= 1e-10 * np.abs(m).max()
    spectrum = np.linalg.eigvals(m @ to_csr(broken).toarray())
    assert spectrum.real.min() > 0.0
    if surface == "volume":
        assert spectrum.real.max() <= 1.0 + 1e-8
    # Brought up to date it keeps its numbers' precision.
    fresh = TwoLevel(broken, 5, degree=1, precision=np.float64, ratio=4.0)
    x = np.sin(np.arange(size))
    updated, wanted = before.updated(broken).matvec(x), fresh.matvec(x)
    np.testing.assert_allclose(updated, wanted, atol=1e-10 * np.abs(wanted).max())
    # Where nothing has broken it is what it was.
    x = np.cos(np.arange(size))
    np.testing.assert_array_equal(before.following(sound.operator).matvec(x), before.matvec(x))
    counts = [
        method.iterate(broken, "positive", inverse, Task(x, np.zeros(size), 1e-10, 200))[1]
        for inverse in (before.following(broken), before)
    ]
    assert counts[0] <= counts[1]


def test_close_nodes_are_for_elastic_bodies_that_are_not_large(monkeypatch) -> None:
    operator = _crack_tip(20).discretise().operator
    often = two_level.for_many(operator)
    assert (often.hats.coarsening, often.degree) == (5, 1)
    again = two_level.for_many(operator, often.hats.coarsening, often.coarse)
    x = np.cos(np.arange(operator.shape[0]))
    np.testing.assert_array_equal(again.matvec(x), often.matvec(x))
    monkeypatch.setattr(two_level, "_CLOSE_MOST", 100)
    assert two_level.for_many(operator).degree == 2
