"""Closed forms against a second code: the same boundary data, solved by finite elements."""

import numpy as np
import pytest

from references.analytic import hole, potential_drop
from references.fem import conduction, elasticity, mesh


@pytest.fixture(scope="module", autouse=True)
def _gmsh():
    missing = mesh.missing_libraries()
    if missing:
        pytest.skip(f"gmsh cannot be loaded: {missing}")


def relative(a, b):
    return np.linalg.norm(a - b) / np.linalg.norm(b)


def test_hole_in_a_fully_anisotropic_plate():
    voigt = np.array([[1.0, 0.2, 0.1], [0.2, 0.8, 1 / 6], [0.1, 1 / 6, 1 / 3]])
    remote = (0.7, -0.3, 0.4)

    def exact(x, y):
        return hole.hole_displacement(voigt, x, y, 1.0, 1.0, remote)

    errors = []
    for size in (0.3, 0.15):
        body = mesh.rectangle(6.0, 6.0, 2 * size, holes=[(0.0, 0.0, 1.0)], hole_size=size)
        solution = elasticity.solve_elasticity(
            body, voigt, dict.fromkeys(("left", "right", "top", "bottom"), exact)
        )
        w = np.linspace(0.0, 2 * np.pi, 40, endpoint=False)
        points = np.stack([1.3 * np.cos(w), 1.3 * np.sin(w)], axis=-1)
        got = solution.at(points)
        errors.append(relative(got, exact(*points.T)))
    # The hole is a polygon: second order in its element size.
    assert errors[1] < 2e-3
    assert errors[1] < 0.4 * errors[0]


@pytest.mark.parametrize("conductivity", [(1.0, 1.0), (4.0, 1.0), (1.0, 3.0)])
def test_johnson_in_a_strip(conductivity):
    kx, ky = conductivity
    width, crack, height = 1.0, 0.4, 1.2

    def exact(x, y):
        x = np.clip(x + width / 2, 0.0, width)
        half = potential_drop.strip_potential(x, np.abs(y), crack, width, kx, ky)
        return np.sign(y) * half

    start = (-width / 2, 0.0)
    body = mesh.rectangle(
        width, height, 0.08, cracks=[(start, (crack - width / 2, 0.0))], tip_size=1e-3
    )
    solution = conduction.steady_conduction(
        body, np.diag([kx, ky]), {"top": exact, "bottom": exact}
    )
    x, y = np.meshgrid(np.linspace(-0.45, 0.45, 7), [-0.4, -0.25, -0.1, 0.1, 0.25, 0.4])
    points = np.stack([x.ravel(), y.ravel()], axis=-1)
    assert relative(solution.at(points), exact(*points.T)) < 1e-3
    # The drop over two probes at the cracked edge against the formula itself.
    probe = 0.3
    ends = solution.at(np.array([[-width / 2, probe], [-width / 2, -probe]]))
    ratio = (ends[0] - ends[1]) / (2 * probe)
    assert ratio == pytest.approx(float(potential_drop.johnson(crack, probe, kx, ky)), rel=1e-3)
