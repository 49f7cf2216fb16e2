from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from references.fem.conduction import steady_conduction
from references.fem.mesh import crack_tip_disc, disc, rectangle

D = np.array([[5.0, 2.0], [2.0, 1.0]])


def harmonic(x: NDArray, y: NDArray) -> NDArray:
    """div(D ∇T) = 0: 5·1 + 4·(−2) + (4 − 1) = 0 for the cosine part, (−4 + 4) for the sine's."""
    return np.exp(x - 2 * y) * np.cos(y)


def points(number: int = 3000) -> NDArray:
    rng = np.random.default_rng(1)
    r, t = np.sqrt(rng.random(number)), 2 * np.pi * rng.random(number)
    return np.column_stack([r * np.cos(t), r * np.sin(t)])


def relative(found: NDArray, exact: NDArray) -> float:
    return float(np.linalg.norm(found - exact) / np.linalg.norm(exact))


@pytest.mark.parametrize(("order", "expected"), [(1, 2.0), (2, 3.0)])
def test_observed_order_on_the_disc(order: int, expected: float) -> None:
    p = points()
    errors = [
        relative(steady_conduction(disc(h), D, harmonic, order=order).at(p), harmonic(*p.T))
        for h in (0.2, 0.1, 0.05, 0.025)
    ]
    slope = np.polyfit(np.log([0.2, 0.1, 0.05, 0.025]), np.log(errors), 1)[0]
    assert expected - 0.25 < slope < expected + 0.4, errors


def test_points_between_chord_and_circle_are_served() -> None:
    s = steady_conduction(disc(0.2), D, lambda x, y: x * x - 5 * y * y, order=2)
    t = np.linspace(0, 2 * np.pi, 1000)
    rim = np.column_stack([np.cos(t), np.sin(t)])
    # an exact quadratic solution, so that P2 extrapolates it without error
    assert np.abs(s.at(rim) - (rim[:, 0] ** 2 - 5 * rim[:, 1] ** 2)).max() < 1e-11


def test_corrected_cubic_needs_no_source_and_printed_one_does() -> None:
    p = points()

    def printed(x: NDArray, y: NDArray) -> NDArray:
        return x**3 / 5 - x**2 * y + x * y**2 + y**3 / 5

    with_source = steady_conduction(disc(0.1), D, printed, source=lambda x, y: 0.8 * y)
    without = steady_conduction(disc(0.1), D, printed)
    assert relative(with_source.at(p), printed(*p.T)) < 1e-4
    assert relative(without.at(p), printed(*p.T)) > 1e-2


def test_flux_of_a_linear_field() -> None:
    s = steady_conduction(disc(0.3), D, lambda x, y: 2 * x - y)
    assert np.allclose(s.flux_at([[0.1, 0.3], [-0.5, 0.2]]), -D @ [2, -1])


def test_insulated_edges_and_a_slit() -> None:
    s = steady_conduction(rectangle(2, 1, 0.2), np.eye(2), {"left": 0.0, "right": 1.0})
    assert s.at([[0.0, 0.2]])[0] == pytest.approx(0.5, abs=1e-12)

    # √r sin(θ/2): harmonic, insulated where θ = ±π, and two-valued on the slit
    def exact(x: NDArray, y: NDArray) -> NDArray:
        return np.sqrt(np.hypot(x, y)) * np.sin(np.arctan2(y, x) / 2)

    s = steady_conduction(crack_tip_disc(0.1, tip_size=1e-3), np.eye(2), exact)
    near = np.array([[-0.5, 1e-9], [-0.5, -1e-9], [-0.99, 1e-6], [-0.99, -1e-6]])
    assert np.allclose(s.at(near), exact(*near.T), rtol=1e-3)


def test_a_reference_that_is_one_per_cent_off_is_seen() -> None:
    p = points()
    s = steady_conduction(disc(0.1), D * [[1.01, 1], [1, 1]], harmonic)
    assert relative(s.at(p), harmonic(*p.T)) > 1e-4


def test_bad_input_is_refused() -> None:
    mesh = disc(0.5)
    with pytest.raises(ValueError, match="positive definite"):
        steady_conduction(mesh, [[1, 2], [2, 1]], 0.0)
    with pytest.raises(ValueError, match="symmetric"):
        steady_conduction(mesh, [[2, 1], [0, 2]], 0.0)
    with pytest.raises(ValueError, match="no boundary 'rim'"):
        steady_conduction(mesh, D, {"rim": 0.0})
    with pytest.raises(ValueError, match="up to a constant"):
        steady_conduction(mesh, D, {})
    with pytest.raises(ValueError, match="order"):
        steady_conduction(mesh, D, 0.0, order=3)
    with pytest.raises(ValueError, match="a mesh of triangles is needed"):
        steady_conduction(None, D, {"circle": 0.0})  # type: ignore[arg-type]
    flat = replace(mesh, points=mesh.points * [1, 0])
    with pytest.raises(ValueError, match="without area"):
        steady_conduction(flat, D, 0.0)
    with pytest.raises(ValueError, match="finite coordinates"):
        steady_conduction(mesh, D, 0.0).at([[np.nan, 0]])
