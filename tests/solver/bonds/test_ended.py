"""Bonds that end at the surface: their energy by hand, exact balance, and what it buys."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import solver.operators.surface_pieces
from solver import (
    ConductivityTensor,
    Crack,
    ElasticTensor,
    Family,
    Load,
    Scene,
    Support,
    disc,
    rectangle,
)
from solver.bonds import Bonds
from solver.geometry import Lattice
from solver.material import calibrate
from solver.operators import BondOperator
from solver.operators.assembled import to_csr
from tests.solver.bodies import DISC, block, few, voigts
from tests.solver.bonds.ending import NOTCHED, SOLID, body, homogeneous_error, linear_fields

# ---- by hand ------------------------------------------------------------------------------------


def test_one_particle_and_its_four_bonds_in_one_dimension():
    # A single cell, m = 1: each of four bonds of length 1 ends after half of it. In conduction
    # ½ (ℓ/|ξ|) k g² = ½ · ½ · k ((T_s − T_p) / ½)² = k (T_s − T_p)² for each.
    family = Family(1, 1.0, "full")
    bonds = Bonds(Lattice(block(1, 1), 1.0, 1), family, (), "extrapolated")
    assert len(bonds.ended) == 4
    np.testing.assert_allclose(bonds.ended.length, 0.5)
    moduli = calibrate(family, ConductivityTensor.isotropic(1.0))
    operator = BondOperator(bonds, moduli, np.zeros((1, 1), dtype=bool))
    k = moduli.conductivity
    np.testing.assert_allclose(operator.ended_stiffness.own[0], 2 * k.sum())
    # The surface follows the particle wherever it goes.
    np.testing.assert_allclose(operator.matvec(np.ones(1)), 0.0, atol=1e-14)


def dense_reference(operator):
    """K of particles and nodes from the energies of single bonds, written out."""
    bonds, moduli, c = operator.bonds, operator.moduli, operator.components
    lattice, family, ended = bonds.lattice, bonds.family, bonds.ended
    count, size = lattice.count, len(ended.outline.nodes)
    matrix = np.zeros((c * (count + size), c * (count + size)))

    def place(entity, component):
        kind, number = entity
        return c * count + component * size + number if kind else component * count + number

    def point(edge, position):
        a, b = ended.outline.edges[edge]
        return [((1, a), 1 - position), ((1, b), position)]

    def add(o, length, start, end, arms, weight):
        """Energy ½ weight (k_n s² + k_t γ²), both strains as vectors over all values.

        Bonds of less than a tenth of the spacing are as stiff as those of that length.
        """
        weight = weight * max(length, 0.1 * lattice.spacing) / length
        length = max(length, 0.1 * lattice.spacing)
        s, gamma = np.zeros(len(matrix)), np.zeros(len(matrix))
        for sign, ends, arm in ((-1, start, arms[0]), (1, end, arms[1])):
            for entity, share in ends:
                if c == 1:
                    s[place(entity, 0)] += sign * share / length
                    continue
                for axis in (0, 1):
                    s[place(entity, axis)] += sign * share * family.normal[o, axis] / length
                    gamma[place(entity, axis)] += sign * share * family.tangent[o, axis] / length
                if c == 3:
                    gamma[place(entity, 2)] -= share * arm / length / lattice.spacing
        k = (moduli.conductivity[o],) if c == 1 else (moduli.normal[o], moduli.shear[o])
        for modulus, strain in zip(k, (s, gamma), strict=False):
            matrix[:] += weight * modulus * np.outer(strain, strain)

    number = lattice.number()
    rows, columns = lattice.rows_columns
    for o in range(family.size):
        w, whole = family.weight[o] * family.cell_area, family.length[o]
        scale = 1 / whole**2 * whole if c == 1 else whole
        for p in range(count):
            q = number[rows[p] + family.offsets[o, 1], columns[p] + family.offsets[o, 0]]
            if q >= 0 and bonds.strength(o)[p] > 0:
                # Half of it to either end.
                weight = 0.5 * w * (1 if c == 1 else scale)
                add(o, whole, [((0, p), 1)], [((0, q), 1)], (0.5 * whole,) * 2, weight)
    for p, o, edge, position, length in zip(
        ended.particle, ended.offset, ended.edge, ended.position, ended.length, strict=True
    ):
        w, whole = family.weight[o] * family.cell_area, family.length[o]
        arms = 0.5 * whole, length - 0.5 * whole
        weight = w * length / (whole if c == 1 else 1)
        add(o, length, [((0, p), 1)], point(edge, position), arms, weight)
    if ended.chords is not None:
        chords = ended.chords
        for o, edge, position, length, arm in zip(
            chords.offset, chords.edge, chords.position, chords.length, chords.arm, strict=True
        ):
            weight = family.weight[o] * family.cell_area * length
            weight /= family.length[o] if c == 1 else 1
            start, end = (point(edge[k], position[k]) for k in (0, 1))
            add(o, length, start, end, arm, weight)
    nodes = np.concatenate(
        [c * count + a * size + operator.ended_stiffness.nodes for a in range(c)]
    )
    inner = np.arange(c * count)
    coupling = matrix[np.ix_(inner, nodes)]
    return matrix[np.ix_(inner, inner)] - coupling @ np.linalg.solve(
        matrix[np.ix_(nodes, nodes)], coupling.T
    )


@pytest.mark.parametrize("material", [SOLID, ElasticTensor.isotropic(1.0, 1 / 3), DISC])
def test_the_condensed_operator_is_that_of_the_single_bonds(material, monkeypatch):
    # The membrane along the edge has tests of its own.
    monkeypatch.setattr(
        solver.operators.surface_pieces,
        "thickness",
        lambda *a: np.zeros(len(a[3])),
    )
    if isinstance(material, np.ndarray):
        material = ConductivityTensor(material)
    crack = Crack((-0.1, 0.32), (0.41, 0.38))
    operator = body(NOTCHED, 0.13, 2, material, [crack])
    expected = dense_reference(operator)
    found = to_csr(operator).toarray()
    np.testing.assert_allclose(found, expected, atol=1e-11 * np.abs(expected).max())
    product = operator.matmat(np.eye(operator.shape[0]))
    np.testing.assert_allclose(product, expected, atol=1e-11 * np.abs(expected).max())


# ---- exact balance ------------------------------------------------------------------------------


@few
@given(voigts(), st.floats(0.06, 0.09), st.sampled_from([2, 3]))
def test_every_particle_balances_in_a_homogeneous_state(voigt, spacing, m):
    operator = body(
        NOTCHED - disc(0.15, (0.3, 0.4)),
        spacing,
        m,
        ElasticTensor(voigt),
        [Crack((0.5, 0.1), (0.7, 0.4))],
    )
    surface = operator.ended_stiffness
    points = operator.bonds.lattice.points
    nodes = surface.ended.outline.nodes[surface.nodes]
    long = operator.bonds.ended.length > 0.1 * spacing
    clear = np.ones(len(points), dtype=bool)
    clear[operator.bonds.ended.particle[~long]] = False
    # Nor those with a bond that grazes the hole.
    bonds = operator.bonds
    whole = bonds.strengths_of(np.arange(len(points))).sum(axis=0)
    whole += np.bincount(bonds.ended.particle, minlength=len(points))
    clear &= whole == bonds.family.size
    assert clear.mean() > 0.8
    scale = np.abs(operator.bulk).max()
    for u, us in zip(
        linear_fields(points, operator.components, spacing),
        linear_fields(nodes, operator.components, spacing),
        strict=True,
    ):
        # Before the nodes find their own equilibrium.
        force = operator.matvec(u.ravel()).reshape(u.shape)
        force[:, operator.at_surface] -= operator.reaction(u[:, operator.at_surface])
        force[:, surface.particles] += (surface.transposed @ us.ravel()).reshape(
            operator.components, -1
        )
        np.testing.assert_allclose(force[:, clear], 0, atol=1e-11 * scale)


@few
@given(voigts(), st.floats(0.06, 0.11))
def test_rigid_motions_cost_nothing_and_the_rest_is_not_negative(voigt, spacing):
    region = NOTCHED - disc(0.15, (0.3, 0.4))
    operator = body(region, spacing, 2, ElasticTensor(voigt), [Crack((0.5, 0.1), (0.7, 0.4))])
    matrix = to_csr(operator).toarray()
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-12 * np.abs(matrix).max())
    fields = linear_fields(operator.bonds.lattice.points, operator.components, spacing)
    rigid = [fields[0], fields[1], fields[5] - fields[4]]
    for u in rigid:
        np.testing.assert_allclose(matrix @ u.ravel(), 0, atol=1e-11 * np.abs(matrix).max())
    if operator.moduli.non_negative:
        assert np.linalg.eigvalsh(matrix).min() > -1e-11 * np.abs(matrix).max()


# ---- a scene pays for what it uses --------------------------------------------------------------


def test_a_body_prescribed_at_its_edge_has_no_surface():
    held = [Support.layer(3.5, displacement=0.0, rotation=0.0)]
    parts = Scene(disc(1.0), 0.05, SOLID, held, m=3, surface="extrapolated").discretise()
    assert parts.bonds.ended is None
    assert parts.operator.ended_stiffness is None


def test_only_surfaces_that_free_particles_feel_have_nodes():
    held = [Support.layer(3.5, displacement=0.0, rotation=0.0)]
    crack = [Crack((-1.5, 0.0), (0.0, 0.0))]
    parts = Scene(disc(1.0), 0.05, SOLID, held, m=3, surface="extrapolated", cracks=crack)
    surface = parts.discretise().operator.ended_stiffness
    nodes = surface.ended.outline.nodes[surface.nodes]
    assert np.abs(nodes[:, 1]).max() < 1e-12


def test_iterations_with_a_surface_are_those_without():
    region = rectangle(1.0, 0.7, angle=0.3)
    ours, plain = (homogeneous_error(region, 60, s)[1].statistics for s in ("extrapolated", "none"))
    assert ours.method == "CG, two-level"
    assert ours.iterations <= 1.5 * plain.iterations


def test_negative_shear_stiffness_has_surfaces_too():
    # ν = 0.4 in plane stress: C66 < C12, rotations are condensed.
    material = ElasticTensor.isotropic(1.0, 0.4)
    operator = body(rectangle(1.0, 1.0), 0.1, 3, material)
    assert operator.moduli.shear.max() < 0

    def solve(surface):
        held = [
            Support.where(
                lambda x, y: x < -0.4, displacement=lambda x, y: np.stack([x, -0.4 * y], -1)
            )
        ]
        pull = [Load.stress((1.0, 0.0, 0.0), where=lambda x, y: x > 0.499)]
        solution = Scene(
            rectangle(1.0, 1.0), 1 / 24, material, held, pull, m=3, surface=surface
        ).solve()
        expected = solution.points * [1.0, -0.4]
        return np.linalg.norm(solution.displacement - expected) / np.linalg.norm(expected)

    assert solve("extrapolated") < 0.2 * solve("volume")
