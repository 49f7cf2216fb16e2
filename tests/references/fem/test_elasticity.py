from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from references.fem.elasticity import solve_elasticity
from references.fem.mesh import crack_tip_disc, disc, rectangle

# The paper's fully anisotropic body (Fig. 7): C, 4C/5, C/5, C/3, C/10, C/6.
C = np.array([[1, 1 / 5, 1 / 10], [1 / 5, 4 / 5, 1 / 6], [1 / 10, 1 / 6, 1 / 3]])


def k_field(voigt: NDArray, KI: float, KII: float) -> Callable[[NDArray, NDArray], NDArray]:
    """Crack-tip displacement, written down here again so that no code is shared."""
    S = np.linalg.inv(voigt)
    mu = np.roots([S[0, 0], -2 * S[0, 2], 2 * S[0, 1] + S[2, 2], -2 * S[1, 2], S[1, 1]])
    a, b = mu[mu.imag > 0]

    def u(x: NDArray, y: NDArray) -> NDArray:
        root = {m: np.sqrt(x + m * y) for m in (a, b)}
        p = {m: S[0, 0] * m**2 + S[0, 1] - S[0, 2] * m for m in (a, b)}
        q = {m: S[0, 1] * m + S[1, 1] / m - S[1, 2] for m in (a, b)}
        parts = [
            KI * (a * c[b] * root[b] - b * c[a] * root[a]) + KII * (c[b] * root[b] - c[a] * root[a])
            for c in (p, q)
        ]
        return np.sqrt(2 / np.pi) * np.stack([np.real(f / (a - b)) for f in parts], axis=-1)

    return u


def points(number: int = 3000) -> NDArray:
    rng = np.random.default_rng(2)
    r, t = np.sqrt(rng.random(number)), 2 * np.pi * rng.random(number)
    return np.column_stack([r * np.cos(t), r * np.sin(t)])


def relative(found: NDArray, exact: NDArray) -> float:
    return float(np.linalg.norm(found - exact) / np.linalg.norm(exact))


@pytest.mark.parametrize(("order", "expected"), [(1, 2.0), (2, 3.0)])
def test_observed_order_on_a_smooth_field(order: int, expected: float) -> None:
    p = points()

    def smooth(x: NDArray, y: NDArray) -> NDArray:
        return np.stack([np.sin(1.3 * x + 0.7 * y), np.cos(x - 1.1 * y)], axis=-1)

    def force(x: NDArray, y: NDArray) -> NDArray:
        # −div σ by hand: f_i = −Σ C_ijkl u_k,lj with the second derivatives of the two waves
        second = np.zeros((*np.shape(x), 2, 2, 2))
        for k, (wave, n) in enumerate(
            [(-np.sin(1.3 * x + 0.7 * y), (1.3, 0.7)), (-np.cos(x - 1.1 * y), (1.0, -1.1))]
        ):
            second[..., k, :, :] = wave[..., None, None] * np.outer(n, n)
        index = np.array([[0, 2], [2, 1]])
        full = C[index[:, :, None, None], index[None, None]]
        return -np.einsum("ijkl,...klj->...i", full, second)

    sizes = (0.2, 0.1, 0.05)
    errors = [
        relative(
            solve_elasticity(disc(h), C, smooth, body_force=force, order=order).at(p), smooth(*p.T)
        )
        for h in sizes
    ]
    slope = np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    assert expected - 0.3 < slope < expected + 0.5, errors


@pytest.mark.parametrize("mode", [(1.0, 0.0), (0.0, 1.0)])
def test_crack_tip_uniform_mesh_converges_at_first_order(mode: tuple[float, float]) -> None:
    p, exact = points(), k_field(C, *mode)
    sizes = (0.16, 0.08, 0.04)
    errors = [
        relative(solve_elasticity(crack_tip_disc(h), C, exact).at(p), exact(*p.T)) for h in sizes
    ]
    slope = np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    # u ~ √r: the energy error is O(√h) and its square bounds the L2 error, whatever the order
    assert 0.75 < slope < 1.5, errors


@pytest.mark.parametrize("mode", [(1.0, 0.0), (0.0, 1.0)])
def test_crack_tip_graded_mesh_is_a_thousand_times_better(mode: tuple[float, float]) -> None:
    p, exact = points(), k_field(C, *mode)
    s = solve_elasticity(crack_tip_disc(0.05, tip_size=1e-4), C, exact)
    assert relative(s.at(p), exact(*p.T)) < 2e-5
    near = np.array([[-0.5, 1e-9], [-0.5, -1e-9], [-0.998, 1e-7], [-0.998, -1e-7]])
    assert relative(s.at(near), exact(*near.T)) < 1e-4


@settings(max_examples=15, deadline=None, derandomize=True)
@given(st.lists(st.floats(-1, 1), min_size=9, max_size=9))
def test_uniform_stress_for_any_tensor(entries: list[float]) -> None:
    a = np.array(entries).reshape(3, 3)
    voigt = a @ a.T + 0.2 * np.eye(3)
    stress = np.array([1.0, -0.5, 0.3])
    tractions = {
        "left": (-stress[0], -stress[2]),
        "right": (stress[0], stress[2]),
        "bottom": (-stress[2], -stress[1]),
        "top": (stress[2], stress[1]),
    }
    s = solve_elasticity(rectangle(2, 1, 0.5), voigt, tractions=tractions)
    assert np.allclose(s.stress_at([[0.1, 0.2], [-0.8, -0.4]]), stress, atol=1e-10)
    assert s.strain_energy == pytest.approx(stress @ np.linalg.solve(voigt, stress), rel=1e-10)


def test_a_component_may_stay_free() -> None:
    s = solve_elasticity(
        rectangle(2, 1, 0.5),
        np.diag([2.0, 1.0, 1.0]),
        {"left": (0.0, np.nan), "right": (0.1, np.nan), "bottom": (np.nan, 0.0)},
    )
    assert np.allclose(s.stress_at([[0.3, 0.1]]), [[0.1, 0, 0]], atol=1e-12)


def test_a_jumping_field_prescribed_on_both_crack_faces() -> None:
    """Mid-side nodes of the faces need the value of their own face as vertices do."""
    exact, p = k_field(C, 1, 0), points()
    for angle in (0.0, 0.7):
        c, s = np.cos(angle), np.sin(angle)

        def turned(x: NDArray, y: NDArray, c: float = c, s: float = s) -> NDArray:
            return exact(c * x + s * y, c * y - s * x)

        mesh = disc(0.1, cracks=[((-c, -s), (0.0, 0.0))], tip_size=1e-3)
        # on every boundary: then the tensor's axes do not matter much, the faces do
        found = solve_elasticity(mesh, C, {"circle": turned, "crack": turned})
        q = p @ [[c, s], [-s, c]]
        away = np.hypot(*q.T) < 0.98
        if angle == 0:
            assert relative(found.at(q[away]), exact(*p[away].T)) < 1.7e-4
        # beside the faces the prescribed values must come back, whatever the tensor
        r = np.linspace(0.1, 0.9, 40)
        for side in (1e-6, -1e-6):
            beside = np.column_stack([-r, np.full_like(r, side)])
            there = found.at(beside @ [[c, s], [-s, c]])
            assert relative(there, exact(*beside.T)) < 1e-3


@pytest.mark.parametrize("order", [1, 2])
def test_rigid_motions_that_supports_leave_are_refused_by_name(order: int) -> None:
    square = rectangle(1, 1, 0.25)
    with pytest.raises(ValueError, match=r"rigid motions free: translation along axis 2$"):
        solve_elasticity(square, C, {"left": (0, np.nan)}, {"right": (1, 1)}, order=order)
    pull = {"top": (0, 1), "bottom": (0, -1)}
    with pytest.raises(ValueError, match=r"translation along axis 2$"):
        solve_elasticity(square, C, {"left": (0, np.nan)}, pull, order=order)
    with pytest.raises(ValueError, match=r"translation along axis 1 and .* axis 2 and rotation$"):
        solve_elasticity(square, C, {"left": (np.nan, np.nan)}, {"right": (1, 0)}, order=order)
    cut = rectangle(1, 1, 0.25, cracks=[((0, -0.5), (0, 0.5))])
    with pytest.raises(ValueError, match=r"the part about \(0\.2.*rotation$"):
        solve_elasticity(cut, C, {"left": (0, 0)}, {"right": (1, 0)}, order=order)
    with pytest.raises(ValueError, match="this one has 6: it is in 2 parts"):
        solve_elasticity(cut, C, tractions={"left": (-1, 0), "right": (1, 0)}, order=order)
    # both parts held: nothing to complain about
    solve_elasticity(cut, C, {"left": (0, 0), "right": (0, 0)}, {"top": (0, 1)}, order=order)


def test_a_tensor_that_is_one_per_cent_off_is_seen() -> None:
    p, exact = points(), k_field(C, 1, 0)
    off = C.copy()
    off[1, 1] *= 1.01
    s = solve_elasticity(crack_tip_disc(0.05, tip_size=1e-4), off, exact)
    assert relative(s.at(p), exact(*p.T)) > 3e-5


def test_bad_input_is_refused() -> None:
    mesh = disc(0.5)
    with pytest.raises(ValueError, match="positive definite"):
        solve_elasticity(mesh, np.diag([1.0, 1.0, -1.0]), (0, 0))
    with pytest.raises(ValueError, match="not in equilibrium"):
        solve_elasticity(mesh, C, tractions={"circle": (1, 0)})
    with pytest.raises(ValueError, match="two components"):
        solve_elasticity(mesh, C, lambda x, y: x)
    with pytest.raises(ValueError, match="no boundary 'rim'"):
        solve_elasticity(mesh, C, {"rim": (0, 0)})
