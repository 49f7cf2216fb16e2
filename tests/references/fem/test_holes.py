"""Plates with holes against the closed form for the infinite anisotropic plate."""

import numpy as np
import pytest
from numpy.typing import NDArray

from references.analytic.hole import edge_hoop_stress, hole_displacement, hole_stress
from references.fem.elasticity import ElasticSolution, solve_elasticity
from references.fem.mesh import rectangle

C = np.array([[1, 1 / 5, 1 / 10], [1 / 5, 4 / 5, 1 / 6], [1 / 10, 1 / 6, 1 / 3]])
ORTHOTROPIC = np.array([[14.0, 0.3, 0], [0.3, 1.0, 0], [0, 0, 0.5]])


def infinite_plate(voigt: NDArray, size: float) -> ElasticSolution:
    """Finite cut-out that carries the infinite plate's displacement on its outer edge."""

    def field(x: NDArray, y: NDArray) -> NDArray:
        return hole_displacement(voigt, x, y, 1.0, 1.0, (1.0, 0.0, 0.0))

    mesh = rectangle(6, 6, 0.5, holes=[(0, 0, 1)], hole_size=size, growth=2.5 * size)
    return solve_elasticity(mesh, voigt, field)


def around(radius: float) -> NDArray:
    t = np.linspace(0, 2 * np.pi, 72, endpoint=False)
    return radius * np.column_stack([np.cos(t), np.sin(t)])


@pytest.mark.parametrize("voigt", [C, ORTHOTROPIC])
def test_displacement_and_stress_around_a_hole(voigt: NDArray) -> None:
    s = infinite_plate(voigt, 0.03)
    p = np.vstack([around(1.001), around(1.3), around(2.5)])
    exact = hole_displacement(voigt, *p.T, 1.0, 1.0)
    assert np.linalg.norm(s.at(p) - exact) < 4e-4 * np.linalg.norm(exact)
    p = np.vstack([around(1.3), around(2.5)])
    stress = hole_stress(voigt, *p.T, 1.0, 1.0)
    assert np.linalg.norm(s.stress_at(p) - stress) < 3e-3 * np.linalg.norm(stress)


def test_hoop_stress_on_the_edge() -> None:
    s = infinite_plate(C, 0.03)
    t = np.linspace(0, 2 * np.pi, 72, endpoint=False)
    s11, s22, s12 = s.stress_at(around(1.0)).T
    hoop = s11 * np.sin(t) ** 2 + s22 * np.cos(t) ** 2 - 2 * s12 * np.sin(t) * np.cos(t)
    exact = edge_hoop_stress(C, t)
    assert np.abs(hoop - exact).max() < 0.02 * np.abs(exact).max()


def test_chords_in_place_of_the_circle_cost_second_order() -> None:
    p = np.vstack([around(1.3), around(2.0)])
    exact = hole_displacement(C, *p.T, 1.0, 1.0)
    errors = [np.linalg.norm(infinite_plate(C, h).at(p) - exact) for h in (0.12, 0.06, 0.03)]
    assert 1.6 < np.log2(errors[0] / errors[1]) < 3, errors
    assert 1.6 < np.log2(errors[1] / errors[2]) < 3, errors
