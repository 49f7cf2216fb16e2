import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from references.fem.mesh import rectangle
from references.fem.modes import in_plane_frequencies, in_plane_modes

ANISOTROPIC = np.array([[1, 1 / 5, 1 / 10], [1 / 5, 4 / 5, 1 / 6], [1 / 10, 1 / 6, 1 / 3]])


@settings(max_examples=12, deadline=None, derandomize=True)
@given(st.floats(0.5, 5), st.floats(-0.4, 0.9), st.floats(0.1, 2), st.floats(0.3, 3))
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
    found = in_plane_frequencies(voigt, side, side, density, 14, elements=10)
    assert np.abs(found / exact - 1).min() < 2e-4


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
    for n in (8, 16, 32):
        found = in_plane_frequencies(voigt, 1, 1, 1.0, 8, elements=n, order=1)
        errors.append(np.abs(found / exact - 1).min())
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


def test_a_tensor_that_is_one_per_cent_off_is_seen() -> None:
    one = in_plane_frequencies(ANISOTROPIC, 1, 1, 1.0, 6, elements=8)
    other = in_plane_frequencies(1.01 * ANISOTROPIC, 1, 1, 1.0, 6, elements=8)
    assert np.allclose(other / one, np.sqrt(1.01), rtol=1e-9)


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
