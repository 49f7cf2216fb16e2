"""Pieces of a surface: their strains are those of the field, and of rigid motions none."""

import numpy as np
import pytest

from solver import ConductivityTensor, ElasticTensor, Inclusion, Scene, disc, rectangle
from solver.operators.surface_pieces import (
    BondStrains,
    Layers,
    between,
    chord_strains,
    interface_layers,
    joined,
    membrane,
    mutual,
    of_edges,
    place,
)
from solver.problem import Discretisation
from tests.solver.bodies import DISC, FIG_7

NOTCHED = rectangle(1.0, 1.0) - rectangle(0.4, 0.3, (0.3, 0.0), 0.4)


def built(material, **options):
    scene = Scene(NOTCHED, 0.1, material, m=2, surface="extrapolated", **options)
    body = Discretisation.of(scene, free=True)
    surface = body.operator.ended_stiffness
    places = surface.ended.outline.nodes[surface.nodes]
    return body, surface, places


def rigid(places, spacing, about=(0.0, 0.0)):
    """Values of a rigid rotation at some nodes, θ scaled, flattened."""
    x, y = (places - np.array(about)).T
    return np.concatenate([-y, x, np.full(len(x), spacing)])


def test_a_bond_that_ends_is_stretched_like_a_whole_one():
    body, surface, _ = built(ElasticTensor(FIG_7))
    ended, family = surface.ended, body.family
    rule = BondStrains.of(ended, family, body.moduli)
    slope = np.array([[0.3, -0.2], [0.5, 0.7]])
    n = family.normal[ended.offset]
    rows = rule.rows(1.0, ended.length - 0.5 * family.length[ended.offset])
    # A linear field with its particle at rest: u = slope·n ℓ at the far end.
    far = np.zeros((3, len(ended)))
    far[:2] = (slope @ n.T) * ended.length
    stretch = np.einsum("ck,ck->k", rows[0], far)
    longest = np.maximum(ended.length, 0.1 * family.spacing)
    np.testing.assert_allclose(
        stretch, np.einsum("ki,ij,kj->k", n, slope, n) * ended.length / longest
    )


@pytest.mark.parametrize("material", [ElasticTensor(FIG_7), ConductivityTensor(DISC)])
def test_stiffness_edge_by_edge_is_that_of_the_strains_of_all_bonds(material):
    body, surface, _ = built(material)
    ended, family = surface.ended, body.family
    rule = BondStrains.of(ended, family, body.moduli)
    whole = family.length[ended.offset]
    ends = rule.rows(-1.0, 0.5 * whole), rule.rows(1.0, ended.length - 0.5 * whole)
    nodes = surface.number[ended.outline.edges[ended.edge]]
    here = np.searchsorted(surface.particles, ended.particle)
    count = len(surface.particles), len(surface.nodes)
    at_p = place(ends[0], [(here, np.ones(len(here)))], count[0]).toarray()
    at_s = place(ends[1], between(nodes, ended.position), count[1]).toarray()
    weight = rule.weight.ravel()[:, None]
    found = of_edges(ended, nodes, mutual(rule.weight, ends[1], ends[1]), count[1]).toarray()
    wanted = at_s.T @ (weight * at_s)
    np.testing.assert_allclose(found, wanted, atol=1e-13 * np.abs(wanted).max())
    found = joined(ended, nodes, here, mutual(rule.weight, ends[1], ends[0]), count).toarray()
    wanted = at_s.T @ (weight * at_p)
    np.testing.assert_allclose(found, wanted, atol=1e-13 * np.abs(wanted).max())


@pytest.mark.parametrize("about", [(0.0, 0.0), (0.4, -0.3)])
def test_corners_and_membranes_feel_no_rigid_motion(about):
    body, surface, places = built(ElasticTensor(FIG_7))
    u = rigid(places, body.family.spacing, about)
    given = surface.ended, body.family, body.moduli, surface.number
    weight, normal, strain = chord_strains(*given)
    assert len(weight) == strain.shape[0] == 2 * normal.shape[1]
    assert np.abs(strain @ u).max() < 1e-12
    assert np.abs(membrane(*given).strain @ u).max() < 1e-12


@pytest.mark.parametrize("conductive", [False, True])
def test_a_membrane_is_strained_as_its_edge(conductive):
    body, surface, places = built(ConductivityTensor(DISC) if conductive else ElasticTensor(FIG_7))
    skin = membrane(surface.ended, body.family, body.moduli, surface.number)
    outline, slope = surface.ended.outline, np.array([[0.3, -0.2], [0.5, 0.7]])
    ends = outline.nodes[outline.edges[skin.edges]]
    along = (ends[:, 1] - ends[:, 0]) / outline.length[skin.edges, None]
    if conductive:
        found, wanted = skin.strain @ (places @ slope[0]), along @ slope[0]
    else:
        u = np.concatenate([(places @ slope.T).T.ravel(), np.zeros(len(places))])
        found, wanted = skin.strain @ u, np.einsum("ki,ij,kj->k", along, slope, along)
    np.testing.assert_allclose(found, wanted, atol=1e-12)
    assert (skin.stiffening().weight >= 0).all()


def test_layers_along_an_interface_know_its_other_side():
    stiff = ElasticTensor(3.0 * np.asarray(FIG_7))
    body, surface, _ = built(ElasticTensor(FIG_7), inclusions=[Inclusion(disc(0.23), stiff)])
    found, twin = interface_layers(surface.ended, body.family, body.moduli, surface.number)
    assert (twin[twin] == np.arange(len(twin))).all()
    assert (twin != np.arange(len(twin))).all()
    np.testing.assert_allclose(found.along[:, twin], -found.along, atol=1e-9)


def test_layers_take_no_more_of_a_node_than_their_share():
    stiff = ElasticTensor(3.0 * np.asarray(FIG_7))
    body, surface, _ = built(ElasticTensor(FIG_7), inclusions=[Inclusion(disc(0.23), stiff)])
    found, twin = interface_layers(surface.ended, body.family, body.moduli, surface.number)
    plain, spread = (surface.matrix - surface.layers.stiffness).tocsc(), surface._spread
    softer = Layers(np.full_like(found.weight, -plain.diagonal().max()), *found[1:])
    borne = softer.bearable(plain, spread, twin)
    assert (borne.weight >= softer.weight).all()
    assert (borne.weight <= 0).all()
    diagonal = np.abs((spread.T @ plain @ spread).diagonal())
    count = softer.weight.shape[1]
    for k, weight in enumerate(borne.weight):
        rows = softer.strain[k * count : (k + 1) * count]
        for edge in range(count):
            # One strain of one edge; the same of its twin is among them, and counts with it.
            taken = np.asarray((rows[[edge]] ** 2 @ spread).todense())[0] * -weight[edge]
            assert (taken <= diagonal / 16 * (1 + 1e-9)).all()
    # As they are they leave the nodes held in every direction.
    whole = spread.T @ surface.matrix @ spread
    assert np.linalg.eigvalsh(whole.toarray()).min() > 0
