import numpy as np
import pytest
from numpy.typing import NDArray

from references.fem.mesh import disc, rectangle
from references.fem.transient import transient_conduction

D = np.array([[5.0, 2.0], [2.0, 1.0]])
START = 0.05


def spreading(x: NDArray, y: NDArray, t: float) -> NDArray:
    """Instantaneous point source at the origin, seen from START on (capacity 2)."""
    later = t + START
    q = np.einsum("i...,ij,j...->...", np.stack([x, y]), np.linalg.inv(D), np.stack([x, y]))
    strength = 2 / (4 * np.pi * later * np.sqrt(np.linalg.det(D)))
    return strength * np.exp(-2 * q / (4 * later))


def error(size: float, steps: int) -> float:
    rng = np.random.default_rng(0)
    p = rng.uniform(-0.6, 0.6, (800, 2))
    s = transient_conduction(
        disc(size), D, 2.0, lambda x, y: spreading(x, y, 0), 0.1, steps, spreading
    )
    exact = spreading(*p.T, 0.1)
    return float(np.linalg.norm(s.at(p)[0] - exact) / np.linalg.norm(exact))


def test_point_source_at_second_order_in_time() -> None:
    errors = [error(0.05, n) for n in (4, 8, 16)]
    assert 1.7 < np.log2(errors[0] / errors[1]) < 2.6, errors
    assert 1.7 < np.log2(errors[1] / errors[2]) < 2.6, errors
    assert error(0.05, 64) < 3e-4


def test_it_settles_to_the_steady_state() -> None:
    s = transient_conduction(
        disc(0.2), D, 1.0, 0.0, 20.0, 400, lambda x, y, t: 2 * x - y, outputs=2
    )
    p = np.array([[0.1, 0.2], [-0.5, 0.3]])
    assert np.allclose(s.times, [10, 20])
    assert np.allclose(s.at(p)[1], 2 * p[:, 0] - p[:, 1], atol=1e-7)


def test_an_insulated_body_keeps_its_heat() -> None:
    mesh = rectangle(2, 1, 0.2)
    s = transient_conduction(
        mesh, D, 3.0, lambda x, y: 1 + x, 100.0, 50, source=lambda x, y, t: 0.06 + 0 * x
    )
    # mean 1, then 100 s of 0.06 W/m³ on 3 J/(m³ K)
    assert np.allclose(s.at([[0.3, 0.1], [-0.9, -0.4]]), 3.0, atol=1e-6)


def test_bad_input_is_refused() -> None:
    with pytest.raises(ValueError, match="capacity"):
        transient_conduction(disc(0.5), D, 0.0, 0.0, 1.0, 1)
    with pytest.raises(ValueError, match="outputs divide"):
        transient_conduction(disc(0.5), D, 1.0, 0.0, 1.0, 3, outputs=2)
