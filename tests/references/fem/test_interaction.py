import numpy as np
import pytest
from numpy.typing import NDArray

from references.analytic.compact_tension import shape_factor
from references.analytic.lekhnitskii import crack_tip_displacement, energy_release_rate
from references.analytic.voigt import turned_axes
from references.fem.cracked_plates import (
    centre_crack,
    compact_tension,
    edge_crack,
    plate_under_tension,
)
from references.fem.elasticity import ElasticSolution, solve_elasticity
from references.fem.interaction import stress_intensity
from references.fem.mesh import crack_tip_disc, disc, rectangle

C = np.array([[1, 1 / 5, 1 / 10], [1 / 5, 4 / 5, 1 / 6], [1 / 10, 1 / 6, 1 / 3]])
ISOTROPIC = np.array([[1, 0.3, 0], [0.3, 1, 0], [0, 0, 0.35]]) / 0.91


def tip_problem(KI: float, KII: float, size: float = 0.1) -> ElasticSolution:
    def field(x: NDArray, y: NDArray) -> NDArray:
        return crack_tip_displacement(C, x, y, KI, KII)

    return solve_elasticity(crack_tip_disc(size, tip_size=size**3, growth=1.5 * size), C, field)


def check_factors(solution: ElasticSolution) -> None:
    found = stress_intensity(solution, (0, 0), 0.0, 0.6)
    assert pytest.approx(1.0, abs=3e-4) == found.KI
    assert pytest.approx(-0.6, abs=3e-4) == found.KII
    assert pytest.approx(energy_release_rate(C, 1.0, -0.6), rel=1e-3) == found.G


def test_prescribed_factors_come_back() -> None:
    check_factors(tip_problem(1.0, -0.6))


def test_they_converge_with_the_mesh() -> None:
    errors = []
    for size in (0.2, 0.1, 0.05):
        found = stress_intensity(tip_problem(1.0, 0.5, size), (0, 0), 0.0, 0.6)
        errors.append(abs(found.KI - 1) + abs(found.KII - 0.5))
    assert errors[0] > 4 * errors[1] > 16 * errors[2], errors


def test_the_integral_does_not_depend_on_its_domain() -> None:
    solution = tip_problem(1.0, 0.5)
    found = [stress_intensity(solution, (0, 0), 0.0, r, i) for r, i in ((0.3, 0.2), (0.9, 0.6))]
    assert pytest.approx(found[1].KI, rel=1e-4) == found[0].KI
    assert pytest.approx(found[1].KII, rel=2e-4) == found[0].KII


def test_the_crack_may_point_anywhere() -> None:
    """The same problem, turned as a whole."""
    angle = 0.7
    turned = turned_axes(C, -angle)
    c, s = np.cos(angle), np.sin(angle)

    def field(x: NDArray, y: NDArray) -> NDArray:
        u = crack_tip_displacement(C, c * x + s * y, c * y - s * x, 1.0, 0.5)
        return np.stack([c * u[..., 0] - s * u[..., 1], s * u[..., 0] + c * u[..., 1]], axis=-1)

    mesh = disc(0.1, cracks=[((-c, -s), (0.0, 0.0))], tip_size=1e-3)
    found = stress_intensity(solve_elasticity(mesh, turned, field), (0, 0), angle, 0.6)
    assert pytest.approx(1.0, abs=3e-4) == found.KI
    assert pytest.approx(0.5, abs=3e-4) == found.KII


def test_edge_crack_against_the_strip() -> None:
    # Kaya and Erdogan, Q. Appl. Math. 45 (1987) 105: 2.8246 for a long strip at a/W = 1/2
    found = edge_crack(ISOTROPIC, 1.0, 4.0, 0.5)
    assert found.KI / np.sqrt(np.pi / 2) == pytest.approx(2.8246, rel=1e-3)
    assert abs(found.KII) < 1e-3 * found.KI


def test_centre_crack_against_the_strip() -> None:
    # Isida, Int. J. Fract. Mech. 7 (1971) 301: 1.1867 for a long strip at a/b = 1/2
    found = centre_crack(ISOTROPIC, 2.0, 6.0, 0.5)
    assert found.KI / np.sqrt(np.pi / 2) == pytest.approx(1.1867, rel=1e-3)


def test_compact_tension_against_the_standard() -> None:
    # ASTM E399 quotes its polynomial to 0.5 %
    found = compact_tension(ISOTROPIC, 1.0, 0.5)
    assert pytest.approx(float(shape_factor(0.5)), rel=6e-3) == found.KI
    assert abs(found.KII) < 2e-3 * found.KI


def test_inclined_crack_in_a_large_anisotropic_plate() -> None:
    """Loads that balance on the faces make K independent of the tensor: σ √(πa) cos², cos sin."""
    angle, a = 0.3, 0.5
    found = centre_crack(C, 24.0, 24.0, a, angle)
    scale = np.sqrt(np.pi * a)
    # a plate 48 crack half-lengths wide raises K by some 0.2 %
    assert found.KI / (scale * np.cos(angle) ** 2) == pytest.approx(1.0, abs=4e-3)
    assert found.KII / (scale * np.cos(angle) * np.sin(angle)) == pytest.approx(1.0, abs=4e-3)


def test_energy_balance_of_an_anisotropic_plate() -> None:
    """Dead loads: G is the growth of the strain energy with the crack, however K is found."""
    a = 0.4

    def energy(length: float) -> float:
        crack = ((-0.5, 0.0), (length - 0.5, 0.0))
        return plate_under_tension(C, 1.0, 2.0, [crack], 1.0, 16).strain_energy

    wide, narrow = ((energy(a + h) - energy(a - h)) / (2 * h) for h in (0.04, 0.02))
    # Richardson: the central differences err with the square of the step
    slope = (4 * narrow - wide) / 3
    assert pytest.approx(slope, rel=5e-4) == edge_crack(C, 1.0, 2.0, a).G


@pytest.mark.parametrize("factors", [(1.01, -0.6), (1.0, -0.606)])
def test_one_per_cent_is_seen(factors: tuple[float, float]) -> None:
    with pytest.raises(AssertionError):
        check_factors(tip_problem(*factors))


def test_a_ring_that_leaves_the_body_or_meets_another_crack_is_refused() -> None:
    inside, outside = tip_problem(1.0, 0.0), "ring leaves the body"
    stress_intensity(inside, (0, 0), 0.0, 0.98)
    with pytest.raises(ValueError, match=outside):
        stress_intensity(inside, (0, 0), 0.0, 1.02)
    # the outer edge is farther than the radius, a hole's is not
    holed = rectangle(2, 2, 0.1, [(0.5, 0.0, 0.2)], [((-1, 0), (0, 0))], tip_size=0.01)
    pull = {"top": (0, 1), "bottom": (0, -1)}
    solution = solve_elasticity(holed, C, tractions=pull)
    stress_intensity(solution, (0, 0), 0.0, 0.28)
    with pytest.raises(ValueError, match=outside):
        stress_intensity(solution, (0, 0), 0.0, 0.35)
    centre = rectangle(2, 2, 0.1, cracks=[((-0.2, 0), (0.2, 0))], tip_size=0.01)
    solution = solve_elasticity(centre, C, tractions=pull)
    stress_intensity(solution, (0.2, 0), 0.0, 0.38)
    with pytest.raises(ValueError, match="another crack tip"):
        stress_intensity(solution, (0.2, 0), 0.0, 0.45)


@pytest.mark.parametrize("angle", [0.01, np.pi, -np.pi / 2])
def test_a_crack_that_does_not_arrive_along_the_angle_is_refused(angle: float) -> None:
    with pytest.raises(ValueError, match="not a straight line"):
        stress_intensity(tip_problem(1.0, 0.0, 0.2), (0, 0), angle, 0.6)


def test_a_kink_within_the_ring_is_refused() -> None:
    mesh = rectangle(2, 2, 0.1, cracks=[((-1, 0), (0, 0)), ((0, 0), (0.2, 0.2))], tip_size=0.01)
    solution = solve_elasticity(mesh, C, tractions={"top": (0, 1), "bottom": (0, -1)})
    stress_intensity(solution, (0.2, 0.2), np.pi / 4, 0.27)
    with pytest.raises(ValueError, match="not a straight line"):
        stress_intensity(solution, (0.2, 0.2), np.pi / 4, 0.35)


def test_bad_input_is_refused() -> None:
    solution = tip_problem(1.0, 0.0)
    with pytest.raises(ValueError, match="no crack tip"):
        stress_intensity(solution, (0.2, 0), 0.0, 0.5)
    with pytest.raises(ValueError, match="too large for the integration ring"):
        stress_intensity(solution, (0, 0), 0.0, 1e-4)
    with pytest.raises(ValueError, match="shorter than the plate"):
        edge_crack(C, 1.0, 2.0, 1.0)
    with pytest.raises(ValueError, match="does not lie inside"):
        centre_crack(C, 1.0, 2.0, 0.6)
    with pytest.raises(ValueError, match="angle"):
        centre_crack(C, 1.0, 2.0, 0.2, 2.0)
    with pytest.raises(ValueError, match="compact-tension"):
        compact_tension(C, 1.0, 0.1)
