"""The coarse space: partition of unity, splitting, and the Galerkin matrix against P^T K P."""

import dataclasses

import numpy as np
import pytest
from scipy import sparse

from solver import ConductivityTensor, Crack, ElasticTensor, Scene, Support, disc, rectangle
from solver.linear import Hats
from solver.operators.assembled import to_csr

ANISOTROPIC = ElasticTensor([[1, 0.2, 0.1], [0.2, 0.8, 1 / 6], [0.1, 1 / 6, 1 / 3]])


def _scene(**changes: object) -> Scene:
    base = Scene(
        region=disc(1.0),
        spacing=1 / 24,
        m=3,
        material=ANISOTROPIC,
        supports=[Support.layer(cells=3.5, displacement=(0.0, 0.0), rotation=0.0)],
    )
    return dataclasses.replace(base, **changes)  # type: ignore[arg-type]


def _prolongation(hats: Hats, components: int) -> sparse.csr_array:
    rows = hats.prolong
    matrix = sparse.csr_array(
        (rows.weight, rows.index.astype(int), rows.pointer.astype(int)),
        shape=(len(rows.pointer) - 1, hats.count),
    )
    return sparse.block_diag([matrix] * components, format="csr")


def _conductor(ratio: float, angle: float) -> dict[str, object]:
    axes = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return {
        "material": ConductivityTensor(axes.T @ np.diag([ratio, 1.0]) @ axes),
        "calibration": "positive",
        "m": 5,
        "supports": [Support.layer(cells=5.5, temperature=0.0)],
    }


PLY = np.array([[140.0, 3, 0], [3, 10, 0], [0, 0, 5]])


@pytest.mark.parametrize("cells", [3, 4, 8])
@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"cracks": [Crack((-1.5, 0.0), (0.0, 0.0))]},
        {"cracks": [Crack((-1.5, 0.1), (-0.3, 0.1), (0.2, 0.45))]},
        {"region": disc(1.0) - disc(0.4), "m": 2.5},
        {
            "material": ConductivityTensor([[5, 2], [2, 1]]),
            "calibration": "positive",
            "m": 5,
            "supports": [Support.layer(cells=5.5, temperature=0.0)],
        },
        {"material": ElasticTensor.isotropic(1.0, 1 / 3)},
        _conductor(100.0, 0.0),
        _conductor(1000.0, np.pi / 2),
        _conductor(100.0, np.pi / 8) | {"cracks": [Crack((-1.5, 0.1), (-0.3, 0.1), (0.2, 0.45))]},
        {"material": ElasticTensor(PLY), "calibration": "positive", "region": disc(1) - disc(0.4)},
        {"supports": [Support.where(lambda x, y: y < -0.7, u2=0.0),
                      Support.where(lambda x, y: x < -0.7, u1=0.0)]},
    ],
)  # fmt: skip
def test_probed_matrix_is_the_galerkin_product(cells: int, changes: dict[str, object]) -> None:
    operator = _scene(**changes).discretise().operator
    hats = Hats(operator, cells)
    p = _prolongation(hats, operator.components)
    fine = to_csr(operator)
    if operator.identity_rows is not None:
        # The coarse space lives on the free unknowns.
        p = sparse.diags_array((~operator.identity_rows).ravel().astype(float)) @ p
    expected = (p.T @ fine @ p).toarray()
    found = hats.galerkin().toarray()
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()


@pytest.mark.parametrize("changes", [{}, _conductor(40.0, 2.0)])
def test_hats_sum_to_one_with_and_without_cracks(changes: dict[str, object]) -> None:
    for cracks in ([], [Crack((-1.5, 0.0), (0.0, 0.0))]):
        operator = _scene(cracks=cracks, **changes).discretise().operator
        hats = Hats(operator, 6)
        ones = hats.prolong(np.ones((1, hats.count)))
        assert np.allclose(ones, 1.0, atol=1e-14)
        assert (hats.split > 0) == bool(cracks)


def test_no_hat_reaches_across_a_crack_that_cuts_its_support() -> None:
    # A crack right through the body: every hat must live on one side of it.
    scene = _scene(
        region=rectangle(2.0, 2.0), cracks=[Crack((-1.5, 0.0), (1.5, 0.0))],
    )  # fmt: skip
    operator = scene.discretise().operator
    hats = Hats(operator, 8)
    above = operator.bonds.lattice.points[operator.active][:, 1] > 0
    p = _prolongation(hats, 1)
    on_top = abs(p).T @ above.astype(float)
    below = abs(p).T @ (~above).astype(float)
    assert np.all((on_top == 0) | (below == 0))


@pytest.mark.parametrize("changes", [{}, _conductor(100.0, 0.5)])
def test_local_update_equals_a_new_matrix(changes: dict[str, object]) -> None:
    changes = changes | {"spacing": 1 / 40, "cracks": [Crack((-1.5, 0.0), (0.0, 0.0))]}
    scene = _scene(**changes)
    grown = dataclasses.replace(
        scene, cracks=[Crack((-1.5, 0.0), (0.0, 0.0), (0.12, 0.08), (0.2, 0.2))]
    )
    from solver.linear import TwoLevel

    before = TwoLevel(scene.discretise().operator, coarsening=5)
    operator = grown.discretise().operator
    updated, new = before.updated(operator), TwoLevel(operator, coarsening=5)
    scale = abs(new.coarse).max()
    assert abs(updated.coarse - new.coarse).max() <= 1e-13 * scale
    # And the change was not empty.
    assert before.hats.count != new.hats.count or abs(before.coarse - new.coarse).max() > 0
