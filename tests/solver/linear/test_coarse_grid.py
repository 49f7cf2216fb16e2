"""Turned and stretched coarse grids: where they point, and what their windows hold."""

import numpy as np
import pytest

from solver import ConductivityTensor, ElasticTensor, Scene, Support, disc
from solver.analyses.statics import solve
from solver.linear.coarse_grid import CoarseGrid

SHAPE = (60, 70)


def _turned(ratio: float, angle: float) -> ConductivityTensor:
    axes = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return ConductivityTensor(axes.T @ np.diag([ratio, 1.0]) @ axes)


def _scene(material: ConductivityTensor, cells: int = 24) -> Scene:
    layer = Support.layer(cells=5.5, temperature=lambda x, y: np.cos(3 * x + y))
    return Scene(disc(1.0), 1 / cells, material, [layer], calibration="positive")


@pytest.mark.parametrize("angle", [*np.linspace(-1.5, 1.6, 9), np.pi / 4, -np.pi / 4, 2.355])
def test_nodes_lie_far_apart_along_the_strong_axis_and_close_across(angle):
    operator = _scene(_turned(60.0, angle)).discretise().operator
    grid = CoarseGrid.of(operator, 6)
    strong = np.array([np.cos(angle), np.sin(angle)])
    length = np.hypot(*grid.along) if not grid.rectangular else max(grid.along[0], grid.across[1])
    lead = max(abs(np.dot(vector, strong)) for vector in (grid.along, grid.across))
    assert lead == pytest.approx(length, rel=0.01)
    assert length > 8
    assert 0 < grid.cells / length < 3
    # A grid is its own place: its vectors lead from a node to the next one of a row, or row.
    for vector, number in ((grid.along, (0, 1)), (grid.across, (1, 0))):
        row, column = grid.numerators(np.array(vector[1]), np.array(vector[0]))
        assert (row, column) == tuple(grid.cells * step for step in number)


@pytest.mark.parametrize("degrees", [0, 17, 30, 45, 60, 90, 135, 163])
def test_nodes_of_a_ply_lie_far_apart_along_its_fibres(degrees):
    """Its shear waves along the fibres are as weak as those across: their ties are no matter."""
    ply = ElasticTensor.orthotropic(E1=140.0, E2=10.0, G12=5.0, nu12=0.3)
    held = Support.layer(cells=5.5, displacement=(0.0, 0.0), rotation=0.0)
    turned = ply.rotated(np.radians(degrees))
    scene = Scene(disc(1.0), 1 / 14, turned, [held], m=5, calibration="positive")
    grid = CoarseGrid.of(scene.discretise().operator, 8)
    fibres = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    longest = max(grid.along, grid.across, key=lambda vector: np.hypot(*vector))
    assert abs(np.dot(longest, fibres)) > 0.95 * np.hypot(*longest)


def test_weakly_anisotropic_solids_keep_the_square_grid():
    tensor = ElasticTensor([[1, 0.2, 0.1], [0.2, 0.8, 1 / 6], [0.1, 1 / 6, 1 / 3]])
    held = Support.layer(cells=5.5, displacement=(0.0, 0.0), rotation=0.0)
    elastic = Scene(disc(1.0), 1 / 12, tensor, [held])
    for scene, cells in ((_scene(_turned(2.0, 0.3)), 6), (elastic, 8)):
        grid = CoarseGrid.of(scene.discretise().operator, cells)
        assert (grid.along, grid.across) == ((cells, 0), (0, cells))


@pytest.mark.parametrize("vectors", [((8, 0), (0, 8)), ((9, 0), (0, 1)), ((9, 4), (0, 2)),
                                     ((-3, 8), (-2, 0)), ((7, -6), (0, 3))])  # fmt: skip
def test_boxes_hold_whatever_hats_reach_and_are_disjoint(vectors):
    grid, reach = CoarseGrid(*vectors, SHAPE), 3
    rows, columns = np.divmod(np.arange(SHAPE[0] * SHAPE[1]), SHAPE[1])
    place = grid.places(rows, columns)
    node_rows, node_columns = grid.size
    assert all(axis.min() >= 0 for axis in place)
    assert place[0].max() // grid.cells < node_rows - 1
    assert place[1].max() // grid.cells < node_columns - 1
    # Hats so far apart that no bond joins them, as those of one colour.
    disc_rows, disc_columns = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    far = [axis.max() for axis in grid.numerators(disc_rows, disc_columns)]
    period = [2 * ((2 * grid.cells + axis) // grid.cells) + 1 for axis in far]
    at = np.meshgrid(*(np.arange(1, n, p) for n, p in zip(grid.size, period, strict=True)))
    row, column = (axis.T.ravel() for axis in at)
    boxes = grid.boxes(row, column, reach)
    margin = 200
    times = np.zeros((SHAPE[0] + 2 * margin, SHAPE[1] + 2 * margin), dtype=int)
    for r0, c0, r1, c1 in boxes + margin:
        times[r0 : r1 + 1, c0 : c1 + 1] += 1
    assert times.max() == 1
    for y, x in zip(*grid.cells_of(row, column), strict=True):
        for hat_row, hat_column in np.argwhere(grid.hat > 0) - np.array(grid.hat.shape) // 2:
            cell = times[margin + y + hat_row - reach :, margin + x + hat_column - reach :]
            assert cell[: 2 * reach + 1, : 2 * reach + 1].all()


@pytest.mark.parametrize(("ratio", "angle"), [(1000.0, 0.0), (100.0, np.pi / 8), (100.0, 1.2)])
def test_strongly_anisotropic_conductors_need_few_iterations(ratio, angle):
    scene = _scene(_turned(ratio, angle), 48)
    found = solve(scene.discretise(), 1e-8, preconditioning="two-level").statistics
    assert found.iterations <= 20
