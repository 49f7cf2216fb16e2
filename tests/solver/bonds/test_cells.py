"""Cells to look at: one a particle, together where bonds are whole, parted where they are not."""

import meshio
import numpy as np
import pytest

from solver import (
    ConductivityTensor,
    Crack,
    ElasticTensor,
    Inclusion,
    Scene,
    Support,
    disc,
    rectangle,
    transient,
)
from solver.bonds import Cells
from solver.problem import Discretisation

SOLID = ElasticTensor.isotropic(1.0, 0.3)


def cells_of(region, spacing, cracks=(), surface="volume"):
    scene = Scene(region, spacing, SOLID, m=2, cracks=cracks, surface=surface)
    bonds = Discretisation.of(scene, free=True).bonds
    return Cells.of(bonds), bonds


def area(points, quads):
    x, y = points[quads][..., 0], points[quads][..., 1]
    return 0.5 * (x * np.roll(y, -1, 1) - np.roll(x, -1, 1) * y).sum(axis=1)


@pytest.mark.parametrize("region", [rectangle(1.0, 0.6), disc(0.5), disc(0.5) - disc(0.2)])
def test_every_particle_has_its_square(region):
    cells, bonds = cells_of(region, 0.1)
    np.testing.assert_allclose(area(cells.corners, cells.quads), 0.01, rtol=1e-12)
    centres = cells.corners[cells.quads].mean(axis=1)
    np.testing.assert_allclose(centres, bonds.lattice.points, atol=1e-12)


def test_cells_lie_where_the_body_lies(tmp_path):
    """Bonds know the lattice centred; files show the body in its place."""
    region = rectangle(0.5, 0.3, (5.0, -3.0))
    held = Support.where(lambda x, y: x == x, temperature=0.0)
    scene = Scene(region, 0.1, ConductivityTensor.isotropic(1.0), [held], m=2, heat_capacity=1.0)
    solution = scene.solve()
    cells = solution.cells
    centres = cells.corners[cells.quads].mean(axis=1)
    np.testing.assert_allclose(centres, solution.points, atol=1e-12)
    transient.run(scene, 0.0, [0.1], series=str(tmp_path / "warm"))
    (frame, *_) = sorted(tmp_path.glob("warm_*.vtu"))
    found = meshio.read(frame)
    np.testing.assert_allclose(found.points[:, :2].mean(axis=0), (5.0, -3.0), atol=1e-12)


def test_a_whole_body_has_each_corner_once():
    cells, _ = cells_of(rectangle(0.5, 0.3), 0.1)
    assert len(cells.corners) == 6 * 4
    assert len(np.unique(np.round(cells.corners, 9), axis=0)) == 6 * 4


@pytest.mark.parametrize("surface", ["none", "volume", "extrapolated"])
def test_a_crack_parts_them_and_its_tip_does_not(surface):
    crack = Crack((-1.0, 0.0), (0.0, 0.0))
    cells, _ = cells_of(rectangle(1.0, 0.4), 0.1, [crack], surface)
    # Eleven corners on the crack's line; those behind the tip twice.
    twice = cells.corners[np.abs(cells.corners[:, 1]) < 1e-9]
    assert len(twice) == 11 + 5
    jump = np.where(cells.corners[cells.quads].mean(axis=1)[:, 1] > 0, 1.0, 0.0)
    there = cells.at_corners(jump)
    behind = cells.corners[:, 0] < -1e-9
    assert set(np.round(there[behind & (np.abs(cells.corners[:, 1]) < 1e-9)], 12)) == {0.0, 1.0}


def test_bodies_a_cell_apart_share_nothing():
    region = rectangle(0.6, 0.4) - rectangle(0.1, 1.0)
    cells, bonds = cells_of(region, 0.05)
    left = bonds.lattice.points[:, 0] < 0
    assert not set(cells.quads[left].ravel()) & set(cells.quads[~left].ravel())


@pytest.mark.parametrize("seed", range(6))
def test_linear_fields_are_carried_exactly(seed):
    rng = np.random.default_rng(seed)
    region = rectangle(1.0, 0.7, angle=rng.uniform(0, 1)) - disc(
        0.15, tuple(rng.uniform(-0.1, 0.1, 2))
    )
    ends = rng.uniform(-0.4, 0.4, (2, 2))
    cells, bonds = cells_of(region, 0.05, [Crack(tuple(ends[0]), tuple(ends[1]))])
    slopes, level = rng.normal(size=(2, 3)), rng.normal(size=3)
    found = cells.at_corners(bonds.lattice.points @ slopes + level)
    # Where a cell has no bonded neighbour in one direction, its slope there is not known.
    lonely = (cells.towards[:, :2] < 0) & (cells.towards[:, 2:] < 0)
    told = np.ones(len(cells.corners), dtype=bool)
    told[cells.quads[lonely.any(axis=1)]] = False
    assert told.mean() > 0.9
    np.testing.assert_allclose(found[told], (cells.corners @ slopes + level)[told], atol=1e-12)


def test_what_is_not_known_stays_unknown_there_only():
    cells, bonds = cells_of(rectangle(0.5, 0.3), 0.1)
    values = np.ones(bonds.lattice.count)
    values[0] = np.nan
    found = cells.at_corners(values)
    assert np.isnan(found).any()
    assert np.isfinite(found).sum() > len(found) // 2


def test_cells_of_an_inclusion_share_corners_with_those_around():
    """No bond joins two solids, and nothing parts them."""
    solid = ElasticTensor.isotropic(1.0, 0.2)
    held = [Support.where(lambda x, y: x < -0.4, displacement=0.0)]
    one, other = (
        Cells.of(
            Scene(rectangle(1, 1), 0.1, solid, held, m=2, inclusions=inclusions).discretise().bonds
        )
        for inclusions in ([], [Inclusion(disc(0.3), solid)])
    )
    np.testing.assert_array_equal(one.quads, other.quads)
    np.testing.assert_array_equal(one.towards, other.towards)
