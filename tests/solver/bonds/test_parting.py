"""Cracks that grow through the surface: what ends there is cut, and nothing else."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import ElasticTensor, Scene, Support, rectangle
from solver.bonds.parting import Pieces, part
from solver.operators.surface_stiffness import stiffness_of
from tests.solver.bodies import few

NONE = np.zeros((0, 2))


def strip(angle=0.0, shift=0.0):
    held = Support.where(lambda x, y: x > 10, displacement=(0.0, 0.0), rotation=0.0)
    return Scene(
        rectangle(24, 12 + shift, angle=angle), 1.0, ElasticTensor.isotropic(1.0, 0.2), m=3,
        surface="extrapolated", supports=[held],
    ).discretise()  # fmt: skip


def opened(parts, angle=0.0):
    """Pieces of a crack across the whole strip, where bonds between neighbours cross its line."""
    lattice, family = parts.lattice, parts.family
    x, y = lattice.points.T
    side = np.cos(angle) * x + np.sin(angle) * y > 0.0
    rows, columns = lattice.rows_columns
    offsets, origins = [], []
    for o, (dx, dy) in enumerate(family.offsets[: family.size // 2]):
        there = lattice.number()[rows + dy, columns + dx]
        here = np.nonzero((there >= 0) & (side != side[there]))[0]
        offsets.append(np.full(len(here), o))
        origins.append(here)
    offsets, origins = np.concatenate(offsets), np.concatenate(origins)
    return Pieces.of(parts.bonds, parts.bonds.ended.outline, offsets, origins), side


@few
@given(st.floats(-0.7, 0.7), st.floats(0.0, 0.9))
def test_nothing_that_ends_at_the_surface_joins_what_a_crack_parts(angle, shift):
    parts = strip(angle, shift)
    pieces, side = opened(parts, angle)
    ended, origin = part(parts.bonds.ended, parts.lattice, pieces, NONE)
    assert (origin == -1).sum() >= 2
    surface = stiffness_of(ended, parts.family, parts.moduli)
    # One half moves as a rigid body, the other stands: neither feels it.
    x, y = parts.lattice.points[surface.particles].T
    far = side[surface.particles]
    motion = np.stack([1.0 - 0.3 * y, 0.2 + 0.3 * x, np.full(len(x), 0.3)])
    values = np.where(far, motion, 0.0)
    nodal = surface.nodal(values)
    own = 0.5 * sum(
        (entry * values[a] * values[b]).sum() * (1 if a == b else 2)
        for entry, (a, b) in zip(
            surface.own, [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)], strict=True
        )
    )
    # Nodes that too few bonds hold follow their neighbours, with 1e-7 of a node's stiffness; one
    # bond across would hold 1e-3.
    assert surface.energy(values, nodal, values, nodal) <= 1e-7 * own


def test_a_crack_within_the_body_leaves_its_surface_alone():
    parts = strip()
    lattice = parts.lattice
    near = np.nonzero((np.abs(lattice.points) < 1).all(axis=1))[0][:1]
    o = int(np.flatnonzero((parts.family.offsets == [1, 0]).all(axis=1))[0])
    pieces = Pieces.of(parts.bonds, parts.bonds.ended.outline, np.array([o]), near)
    assert len(pieces) == 1
    np.testing.assert_allclose(np.ptp([pieces.start, pieces.end], axis=0)[0], [0, 1], atol=1e-5)
    assert part(parts.bonds.ended, lattice, pieces, NONE) is None


def test_the_outline_keeps_its_length_and_the_mirror_image_is_the_mirror_image():
    parts = strip(shift=0.4)
    pieces, _ = opened(parts)
    ended, _ = part(parts.bonds.ended, parts.lattice, pieces, NONE)
    before, after = parts.bonds.ended.outline, ended.outline
    assert after.length.sum() == pytest.approx(before.length.sum())
    left = parts.lattice.points[ended.particle][:, 0] < 0
    # The held end is not mirrored: near the crack only.
    near = np.abs(parts.lattice.points[ended.particle][:, 0]) < 5
    assert (near & left).sum() == (near & ~left).sum()
    whole = parts.bonds.ended
    assert len(ended) < len(whole)


@few
@given(st.floats(-0.6, 0.6), st.sampled_from([3.0, 4.0, 3.4]))
def test_edges_that_are_split_keep_their_owner_and_nodes_what_they_are(angle, width):
    """The rim of a hole belongs to the hole: the membrane along it depends on that."""
    held = Support.where(lambda x, y: x > 10, displacement=(0.0, 0.0), rotation=0.0)
    parts = Scene(
        rectangle(24, 12) - rectangle(width, width), 1.0, ElasticTensor.isotropic(1.0, 0.2), m=3,
        surface="extrapolated", supports=[held],
    ).discretise()  # fmt: skip
    before = parts.bonds.ended.outline
    pieces, _ = opened(parts, angle)
    ended, _ = part(parts.bonds.ended, parts.lattice, pieces, NONE)
    outline = ended.outline
    assert len(outline.edges) > len(before.edges) or len(outline.nodes) > len(before.nodes)
    assert not before.owned.all()
    middle = outline.nodes[outline.edges].mean(axis=1)
    np.testing.assert_array_equal(outline.owned, parts.lattice.region.contains(*middle.T))
    assert len(outline.joints) == len(outline.nodes)
    np.testing.assert_array_equal(outline.joints[: len(before.nodes)], before.joints)


@few
@given(st.floats(-0.5, 0.5), st.floats(0.0, 0.9))
def test_a_held_edge_that_is_split_stays_held(angle, shift):
    """Values go on between the ends of what was one edge; both sides of a doubled node keep its."""
    top = Support.edge(lambda x, y: y > 5.99, u2=lambda x, y: 0.1 * x)
    base = strip().scene
    scene = Scene(rectangle(24, 12, (shift, 0.0)), 1.0, base.material, [*base.supports, top], m=3,
                  surface="extrapolated")  # fmt: skip
    parts = scene.discretise()
    pieces, _ = opened(parts, angle)
    ended, origin = part(parts.bonds.ended, parts.lattice, pieces, NONE)
    x, y = (ended.outline.nodes + parts.lattice.centred.shift).T
    assert len(origin) == len(x) == ended.held.shape[1]
    upper = y > 5.99
    assert (upper & (origin == -1)).any()
    np.testing.assert_array_equal(ended.held[1], upper)
    assert not ended.held[0].any()
    np.testing.assert_allclose(ended.given[1, upper], 0.1 * x[upper], atol=1e-12)
