"""Stiffness of bonds that end at the surface: symmetric, condensed, exact for uniform strains."""

import numpy as np
import pytest

from solver import (
    ConductivityTensor,
    ElasticTensor,
    Load,
    PolarTensor,
    Scene,
    Support,
    recovery,
    rectangle,
)
from solver.operators.surface_stiffness import stiffness_of
from tests.solver.bodies import FIG_7

HELD = {
    "elastic": [Support.where(lambda x, y: x < -0.3, displacement=(0.0, 0.0), rotation=0.0)],
    "conductive": [Support.where(lambda x, y: x < -0.3, temperature=0.0)],
}
MATERIAL = {"elastic": ElasticTensor(FIG_7), "conductive": ConductivityTensor([[5, 2], [2, 1]])}


def built(physics: str, surface: str = "extrapolated"):
    return Scene(
        region=rectangle(1.0, 1.0),
        spacing=0.1,
        m=2,
        material=MATERIAL[physics],
        supports=HELD[physics],
        surface=surface,
    ).discretise()


@pytest.mark.parametrize("physics", MATERIAL)
def test_nodes_give_way_symmetrically(physics):
    stiffness = built(physics).operator.ended_stiffness
    components = 3 if physics == "elastic" else 1
    shape = (components, len(stiffness.particles))
    u, v = np.random.default_rng(1).normal(size=(2, *shape))
    assert np.sum(v * stiffness.reaction(u)) == pytest.approx(
        np.sum(u * stiffness.reaction(v)), rel=1e-10
    )
    # What free nodes take off the energy of particles held to them.
    assert np.sum(u * stiffness.reaction(u)) < 0


@pytest.mark.parametrize("physics", MATERIAL)
def test_nodes_move_rigidly_with_the_particles(physics):
    found = built(physics)
    stiffness = found.operator.ended_stiffness
    x, y = found.lattice.points[stiffness.particles].T
    one = np.ones_like(x)
    motion = np.array([-y, x, 0.1 * one]) if physics == "elastic" else one[None]
    moved = stiffness.nodal(motion)
    nx, ny = stiffness.ended.outline.nodes[stiffness.nodes].T
    wanted = np.array([-ny, nx]) if physics == "elastic" else np.ones((1, len(nx)))
    np.testing.assert_allclose(moved[: len(wanted)], wanted, atol=1e-10)


def test_nodes_take_the_load_that_is_condensed():
    """Work of the nodes' loads is that of the condensed ones, up to the nodes' own share."""
    stiffness = built("elastic").operator.ended_stiffness
    rng = np.random.default_rng(2)
    load = np.zeros((3, len(stiffness.ended.outline.nodes)))
    load[:2, stiffness.nodes] = rng.normal(size=(2, len(stiffness.nodes)))
    u = rng.normal(size=(3, len(stiffness.particles)))
    moved = stiffness.nodal(u)
    work = np.sum(load[:2, stiffness.nodes] * moved[:2])
    assert abs(work) == pytest.approx(abs(np.sum(stiffness.condensed_load(load) * u)), rel=1e-9)


def test_no_treatment_has_none():
    assert built("elastic", "none").operator.ended_stiffness is None
    assert callable(stiffness_of)


def test_uniform_strain_under_its_tractions():
    """The displacement of a pulled square is linear, nodes of the surface included."""
    strain = np.linalg.solve(FIG_7, [1.0, 0.0, 0.0])
    slope = np.array([[strain[0], strain[2] / 2], [strain[2] / 2, strain[1]]])
    solution = Scene(
        region=rectangle(1.0, 1.0),
        spacing=0.05,
        m=2,
        material=MATERIAL["elastic"],
        surface="extrapolated",
        supports=[
            Support.where(
                lambda x, y: np.hypot(x, y) < 0.15,
                displacement=lambda x, y: np.stack([x, y], -1) @ slope.T,
                rotation=0.0,
            )
        ],
        loads=[Load.stress((1.0, 0.0, 0.0))],
    ).solve()
    exact = solution.surface_points @ slope.T
    error = np.linalg.norm(solution.surface_displacement - exact) / np.linalg.norm(exact)
    assert error < 0.02


@pytest.mark.parametrize("share", [0.0, 0.4])
def test_a_bent_polar_strip_is_as_thick_as_it_is_drawn(share):
    """Couple stresses alone, E ≫ C H²: M/κ = E H, whole cells or not (by the membrane)."""
    h, thickness, length = 1 / 8, 1 + share / 8, 10 / 8
    supports = [
        Support.edge(
            lambda x, y, side=side: side * x > length / 2 - 1e-9,
            u1=lambda x, y, side=side: -side * length / 2 * y,
            rotation=side * length / 2,
        )
        for side in (-1, 1)
    ]
    solution = Scene(
        region=rectangle(length, thickness),
        spacing=h,
        m=3,
        material=PolarTensor(ElasticTensor.isotropic(1.0, 0.2), 1e4 * np.eye(2)),
        surface="extrapolated",
        supports=[
            *supports,
            Support.where(lambda x, y: np.hypot(x - h / 2, y - h / 2) < 0.01, u2=0),
        ],
    ).solve()
    body = solution.discretisation
    energy = body.operator.ended_stiffness
    stored = (recovery.strain_energy_density(solution) * body.volumes).sum() * h**2
    assert energy is not None
    assert 2 * stored / length == pytest.approx(1e4 * thickness, rel=2e-3)
