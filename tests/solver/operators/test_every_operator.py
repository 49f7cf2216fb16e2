"""What every operator has to be: symmetric, its own matrix, definite, zero on rigid motions.

One table of operators, one check for all; a new operator is a new line.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.sparse.linalg import LinearOperator

from solver import (
    ConductivityTensor,
    Crack,
    ElasticTensor,
    PolarTensor,
    Scene,
    Support,
    disc,
    rectangle,
)
from solver.linear.condensed import Condensed, RotationBlock
from solver.linear.two_level import BlockJacobi, TwoLevel
from solver.operators import BondOperator
from solver.operators.assembled import to_csr
from tests.solver.bodies import FIG_7

ISOTROPIC = ElasticTensor.isotropic(1.0, 0.2)
CENTRAL = ElasticTensor.isotropic(1.0, 1 / 3)
INDEFINITE = ElasticTensor.isotropic(1.0, 0.45)
POLAR = PolarTensor(ISOTROPIC, [[0.03, 0.01], [0.01, 0.05]])
CONDUCTOR = ConductivityTensor([[5.0, 2.0], [2.0, 1.0]])


def bonds(material, held=(), **scene) -> BondOperator:
    """Operator of a small body; without supports it is free."""
    settings = {"region": rectangle(1.0, 0.8), "spacing": 0.1, "m": 2, **scene}
    described = Scene(material=material, **settings)
    if held:
        return Scene(material=material, supports=list(held), **settings).discretise().operator
    family = described.family()
    from solver.bonds import Bonds
    from solver.geometry import Lattice
    from solver.material import calibrate

    lattice = Lattice(described.region, 0.1, family.reach)
    moduli = calibrate(family, material, "lattice")
    found = Bonds(lattice, family, described.cracks, described.surface)
    return BondOperator(found, moduli, np.zeros((moduli.components, lattice.count), dtype=bool))


CLAMPED = [Support.where(lambda x, y: x < -0.35, displacement=(0.0, 0.0), rotation=0.0)]
ROLLER = [
    Support.where(lambda x, y: x < -0.4, u1=0.0),
    Support.where(lambda x, y: (x < -0.4) & (y < -0.3), u2=0.0),
]
COLD = [Support.where(lambda x, y: x < -0.35, temperature=0.0)]


@dataclass(frozen=True)
class Line:
    """An operator, whether it is positive definite, whether rigid motions are free, roundings."""

    make: Callable[[], LinearOperator]
    positive: bool = True
    free: bool = False
    roundings: float = 1e-10


def two_levels(operator: BondOperator) -> LinearOperator:
    """The V-cycle without the roundings of single precision."""
    return TwoLevel(operator, precision=np.float64)


TABLE = {
    "elastic, free": Line(lambda: bonds(ISOTROPIC), False, True),
    "anisotropic, free, no treatment": Line(
        lambda: bonds(ElasticTensor(FIG_7), surface="none"), False, True
    ),
    "central, free": Line(lambda: bonds(CENTRAL), False, True),
    "conductive, free": Line(lambda: bonds(CONDUCTOR), False, True),
    "cracked, free": Line(
        lambda: bonds(ISOTROPIC, cracks=[Crack((-0.6, 0.0), (0.0, 0.0))]), False, True
    ),
    "elastic, ended bonds, free": Line(
        lambda: bonds(ISOTROPIC, surface="extrapolated"), False, True
    ),
    "polar, free": Line(lambda: bonds(POLAR), False, True),
    "polar, ended bonds, free": Line(lambda: bonds(POLAR, surface="extrapolated"), False, True),
    "polar, clamped, ended bonds": Line(lambda: bonds(POLAR, CLAMPED, surface="extrapolated")),
    "polar, two levels": Line(lambda: two_levels(bonds(POLAR, CLAMPED, surface="extrapolated"))),
    "elastic, clamped": Line(lambda: bonds(ISOTROPIC, CLAMPED)),
    "elastic, on rollers": Line(lambda: bonds(ISOTROPIC, ROLLER)),
    "elastic, ended bonds": Line(lambda: bonds(ISOTROPIC, CLAMPED, surface="extrapolated")),
    "elastic, ended bonds, on rollers": Line(
        lambda: bonds(ISOTROPIC, ROLLER, surface="extrapolated")
    ),
    "central, clamped": Line(lambda: bonds(CENTRAL, CLAMPED)),
    "conductive, cold": Line(lambda: bonds(CONDUCTOR, COLD)),
    "conductive, ended bonds": Line(lambda: bonds(CONDUCTOR, COLD, surface="extrapolated")),
    "disc, clamped": Line(lambda: bonds(ISOTROPIC, CLAMPED, region=disc(0.45))),
    "indefinite, clamped": Line(lambda: bonds(INDEFINITE, CLAMPED), False),
    "positive companion": Line(lambda: bonds(INDEFINITE, CLAMPED).companion()),
    "rotations of negative stiffness": Line(lambda: RotationBlock(bonds(INDEFINITE, CLAMPED))),
    "condensed displacements": Line(lambda: Condensed(bonds(INDEFINITE, CLAMPED))),
    "block Jacobi": Line(lambda: BlockJacobi(bonds(ISOTROPIC, CLAMPED))),
    "two levels": Line(lambda: two_levels(bonds(ISOTROPIC, CLAMPED))),
    "two levels, single precision": Line(
        lambda: TwoLevel(bonds(ISOTROPIC, CLAMPED)), roundings=1e-6
    ),
    "two levels, ended bonds": Line(
        lambda: two_levels(bonds(ISOTROPIC, CLAMPED, surface="extrapolated"))
    ),
}
every = pytest.mark.parametrize("line", TABLE.values(), ids=TABLE)


def dense(operator: LinearOperator) -> np.ndarray:
    """Column by column."""
    return np.stack([operator.matvec(e) for e in np.eye(operator.shape[0])], axis=1)


@every
def test_operator(line):
    operator = line.make()
    matrix = dense(operator)
    size = np.abs(matrix).max()
    # Symmetric: the adjoint is the operator.
    np.testing.assert_allclose(matrix, matrix.T, atol=line.roundings * size)
    x, y = np.random.default_rng(1).normal(size=(2, operator.shape[0]))
    assert x @ operator.matvec(y) == pytest.approx(y @ operator.rmatvec(x), rel=10 * line.roundings)
    # Linear, and the same twice.
    np.testing.assert_allclose(
        operator.matvec(2 * x - y), matrix @ (2 * x - y), atol=10 * line.roundings * size
    )
    np.testing.assert_array_equal(operator.matvec(x), operator.matvec(x))
    lowest = np.linalg.eigvalsh(0.5 * (matrix + matrix.T))[0]
    if line.positive:
        assert lowest > 0
    if isinstance(operator, BondOperator):
        np.testing.assert_allclose(matrix, to_csr(operator).toarray(), atol=1e-12 * size)
    if line.free:
        assert lowest > -1e-10 * size
        assert isinstance(operator, BondOperator)
        for motion in rigid(operator):
            assert np.abs(operator.matvec(motion)).max() < 1e-10 * size * np.abs(motion).max()


def rigid(operator: BondOperator) -> list[np.ndarray]:
    """Motions that strain nothing, as vectors of the active unknowns."""
    lattice = operator.bonds.lattice
    x, y = lattice.points[operator.active].T
    one, zero = np.ones_like(x), np.zeros_like(x)
    if operator.components == 1:
        return [one]
    turn = [-y, x, operator.bonds.family.spacing * one]
    motions = [[one, zero, zero], [zero, one, zero], turn]
    return [np.concatenate(m[: operator.components]) for m in motions]


def test_an_operator_that_is_wrong_is_seen():
    operator = bonds(ISOTROPIC)
    operator.half_blocks[0, 0] *= 1.01

    class Wrong(LinearOperator):
        def _matvec(self, x):
            y = operator.matvec(x)
            y[0] += 0.01 * x[1]
            return y

    with pytest.raises(AssertionError):
        test_operator(Line(lambda: Wrong(operator.dtype, operator.shape)))
    with pytest.raises(AssertionError):
        test_operator(Line(lambda: operator, False, True))
