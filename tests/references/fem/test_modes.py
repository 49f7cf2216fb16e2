from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from references.fem.mesh import rectangle
from references.fem.modes import Modes, in_plane_frequencies, in_plane_modes

ANISOTROPIC = np.array([[1, 1 / 5, 1 / 10], [1 / 5, 4 / 5, 1 / 6], [1 / 10, 1 / 6, 1 / 3]])


def lame_shape(nodes: NDArray, side: float) -> NDArray:
    """u = (cos kx sin ky, −sin kx cos ky), k = π/L, x and y from the square's corner."""
    x, y = np.pi * (nodes / side + 0.5).T
    return np.column_stack([np.cos(x) * np.sin(y), -np.sin(x) * np.cos(y)])


def lame_frequency(modes: Modes, side: float, about: float) -> tuple[float, float]:
    """Rayleigh frequency of Lamé's shape in the modes within 5 %, and what of it is not in them.

    Modes of nearly the same frequency (C12 = 0 has one) mix on an unsymmetric mesh, which the
    space of them does not feel; modes of another shape have no part in it.
    """
    near = np.abs(modes.frequencies / about - 1) < 0.05
    wanted = lame_shape(modes.nodes, side).ravel()
    if not near.any():
        return 0.0, 1.0
    space = modes.shapes[near].reshape(int(near.sum()), -1).T
    parts = np.linalg.lstsq(space, wanted, rcond=None)[0]
    rest = np.linalg.norm(wanted - space @ parts) / np.linalg.norm(wanted)
    # the shapes are mass-normalised
    square = np.sum(parts**2 * modes.frequencies[near] ** 2) / np.sum(parts**2)
    return float(np.sqrt(square)), float(rest)


def check_lame(modes: Modes, side: float, exact: float) -> None:
    found, rest = lame_frequency(modes, side, exact)
    assert rest < 1e-2
    assert found == pytest.approx(exact, rel=2e-4)


@settings(max_examples=10, deadline=None, derandomize=True)
@given(st.floats(0.5, 5), st.floats(-0.4, 0.9), st.floats(0.3, 2), st.floats(0.3, 3))
def test_lame_mode_of_any_free_square_of_cubic_symmetry(
    c11: float, ratio: float, c66: float, density: float
) -> None:
    """u = (cos kx sin ky, −sin kx cos ky), k = π/L: no shear strain, no normal stress on the edge.

    Hence ρ ω² = (C11 − C12) k² exactly, whatever C66.
    """
    c12 = ratio * c11
    side = 2.0
    exact = np.sqrt((c11 - c12) / density) * np.pi / side
    voigt = [[c11, c12, 0], [c12, c11, 0], [0, 0, c66]]
    # soft in shear there are many modes below it
    check_lame(in_plane_modes(rectangle(side, side, side / 10), voigt, density, 60), side, exact)


@pytest.mark.parametrize("entry", ["c11", "c12", "density"])
def test_one_per_cent_is_seen_in_lames_mode(entry: str) -> None:
    material = {"c11": 2.0, "c12": -0.5, "c66": 0.8, "density": 1.3}

    def modes(m: dict[str, float]) -> Modes:
        voigt = [[m["c11"], m["c12"], 0], [m["c12"], m["c11"], 0], [0, 0, m["c66"]]]
        return in_plane_modes(rectangle(1, 1, 0.1), voigt, m["density"], 20)

    exact = np.sqrt(2.5 / 1.3) * np.pi
    check_lame(modes(material), 1.0, exact)
    with pytest.raises(AssertionError):
        check_lame(modes({**material, entry: 1.01 * material[entry]}), 1.0, exact)


def test_another_mode_at_lames_frequency_does_not_pass() -> None:
    """The frequency alone is not enough: the shape of a neighbour is refused."""
    modes = in_plane_modes(
        rectangle(1, 1, 0.1), [[1.2, 0.2, 0], [0.2, 1.2, 0], [0, 0, 0.5]], 1.0, 12
    )
    check_lame(modes, 1.0, np.pi)
    own = int(np.abs(modes.frequencies - np.pi).argmin())
    other = replace(modes, shapes=np.roll(modes.shapes, 3, axis=0))
    assert modes.frequencies[own] == pytest.approx(np.pi, rel=2e-4)
    with pytest.raises(AssertionError):
        check_lame(other, 1.0, np.pi)


def test_frequencies_converge_at_fourth_order_from_above() -> None:
    coarse, medium, fine, finest = (
        in_plane_frequencies(ANISOTROPIC, 1.0, 0.7, 1.0, 4, free=False, elements=n)
        for n in (5, 10, 20, 40)
    )
    assert (coarse > medium).all()
    assert (medium > fine).all()
    assert (fine > finest).all()
    # clamped corners of an anisotropic body have mild singularities; the bulk gives h⁴
    order = np.log2((coarse - medium) / (medium - fine))
    assert (order > 2.5).all(), order
    assert (fine / finest - 1).max() < 1e-4


def test_linear_elements_converge_at_second_order() -> None:
    exact = np.pi  # Lamé mode of the unit square with C11 − C12 = 1
    voigt = [[1.5, 0.5, 0], [0.5, 1.5, 0], [0, 0, 1.0]]
    errors = []
    # with 8 elements the shape itself is 15 % off
    for n in (16, 32, 64):
        modes = in_plane_modes(rectangle(1, 1, 1 / n), voigt, 1.0, 8, order=1)
        found, rest = lame_frequency(modes, 1.0, exact)
        assert rest < 0.05
        errors.append(abs(found / exact - 1))
    assert 1.6 < np.log2(errors[1] / errors[2]) < 2.5, errors


def test_scaling_with_size_stiffness_and_density() -> None:
    one = in_plane_frequencies(ANISOTROPIC, 1, 1, 1.0, 3, elements=6)
    other = in_plane_frequencies(1e10 * ANISOTROPIC, 1 / 64, 1 / 64, 2500.0, 3, elements=6)
    assert np.allclose(other, one * 64 * np.sqrt(1e10 / 2500), rtol=1e-9)


def test_modes_are_mass_normalised_and_hold_where_clamped() -> None:
    mesh = rectangle(1, 1, 0.2)
    modes = in_plane_modes(mesh, ANISOTROPIC, 2.0, 2, clamped=("left",))
    left = np.abs(modes.nodes[:, 0] + 0.5) < 1e-12
    assert np.abs(modes.shapes[:, left]).max() == 0
    assert modes.shapes.shape == (2, len(modes.nodes), 2)


def test_bad_input_is_refused() -> None:
    with pytest.raises(ValueError, match="density"):
        in_plane_frequencies(ANISOTROPIC, 1, 1, 0.0, 3)
    with pytest.raises(ValueError, match="positive definite"):
        in_plane_frequencies(np.diag([1.0, 0, 1]), 1, 1, 1.0, 3)
    with pytest.raises(ValueError, match="too many"):
        in_plane_frequencies(ANISOTROPIC, 1, 1, 1.0, 500, elements=2)
    cut = rectangle(1, 1, 0.25, cracks=[((0, -0.5), (0, 0.5))])
    with pytest.raises(ValueError, match="this one has 6"):
        in_plane_modes(cut, ANISOTROPIC, 1.0, 3)
    with pytest.raises(ValueError, match="rigid motions free"):
        in_plane_modes(cut, ANISOTROPIC, 1.0, 3, ("left",))
    with pytest.raises(ValueError, match="at least one mode"):
        in_plane_frequencies(ANISOTROPIC, 1, 1, 1.0, 0)


def test_shapes_at_points_are_those_at_the_nodes() -> None:
    modes = in_plane_modes(rectangle(1.0, 1.0, 0.2), ANISOTROPIC, 1.0, 4)
    inside = np.abs(modes.nodes).max(axis=1) < 0.499
    there = modes.at(modes.nodes[inside])
    assert there == pytest.approx(modes.shapes[:, inside], abs=1e-9)
