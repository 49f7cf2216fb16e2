"""The same body gives the same numbers wherever it stands and in whatever unit it is drawn."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import ConductivityTensor, Crack, ElasticTensor, Load, Scene, Support, disc, rectangle
from tests.solver.bodies import few

PLACES = [((0.37, -0.11), 1.0), ((5e5, 5e6), 1.0), ((3e6 + 0.2, -3e6), 2.0), ((0.0, 0.0), 1e-9)]
PLACES += [
    ((7e-9, 1e-9), 1e-9),
    ((1.3, 4.7e3), 1e3),
    ((3e6, 3e6), 1.0),
    ((0.7 - 3e6, 3e6 - 0.4), 1.0),
]


def scene(kind, place, unit, surface, spacing=0.1):
    """A plate with a hole and a crack, a turned one, or one with oblique edges through centres."""

    def at(x, y):
        return place[0] + x * unit, place[1] + y * unit

    if kind == "plate":
        body = rectangle(unit, 0.8 * unit, at(0.3, 0.2)) - disc(0.17 * unit, at(0.35, 0.1))
        cracks = [Crack(at(-0.3, 0.4), at(0.013, 0.4))]
    elif kind == "turned":
        body = rectangle(unit, 0.8 * unit, at(0.0, 0.0), angle=0.5)
        cracks = []
    else:
        root = np.sqrt(2.0) * unit
        body = rectangle(root, 0.8 * root, at(0.0, 0.0), angle=np.pi / 4)
        cracks = [Crack(at(-0.2, -0.2), at(0.2, 0.2))]
    held = rectangle(3 * unit, 0.41 * unit, at(0.0, -0.3))
    loaded = rectangle(0.4 * unit, 3 * unit, at(0.5, 1.55))
    return Scene(
        body,
        spacing * unit,
        ElasticTensor.isotropic(1.0, 0.2),
        [Support.where(held, displacement=0.0)],
        [Load.stress((0.2, 1.0, 0.1), where=loaded)],
        m=3,
        surface=surface,
        cracks=cracks,
    )


@pytest.mark.parametrize("kind", ["plate", "turned", "oblique"])
@pytest.mark.parametrize("surface", ["none", "volume", "extrapolated"])
def test_fields_and_bonds_do_not_depend_on_place_and_unit(kind, surface):
    first = scene(kind, (0.0, 0.0), 1.0, surface).solve(1e-12)
    size = np.abs(first.displacement).max()
    mine = first.discretisation.bonds
    for place, unit in PLACES:
        other = scene(kind, place, unit, surface).solve(1e-12)
        theirs = other.discretisation.bonds
        np.testing.assert_array_equal(theirs.special, mine.special)
        np.testing.assert_array_equal(theirs.strengths != 0, mine.strengths != 0)
        if mine.ended is not None:
            np.testing.assert_array_equal(theirs.ended.particle, mine.ended.particle)
            np.testing.assert_array_equal(theirs.ended.offset, mine.ended.offset)
        # Corners and cells are known from the body's own centre, and what else is drawn on shares
        # of a cell is put back there: no rounding of where it all stands is left.
        rounding = np.finfo(float).eps * np.abs(place).max() / unit
        error = np.abs(other.displacement / unit - first.displacement).max() / size
        assert error < 1e-11, (place, unit)
        there = (other.points - place) / unit
        np.testing.assert_allclose(there, first.points, atol=1e-12 + rounding)
        operator = other.discretisation.operator
        x, y = np.random.default_rng(0).standard_normal((2, operator.shape[0]))
        assert x @ operator.matvec(y) == pytest.approx(y @ operator.matvec(x), rel=1e-11)


@few
@given(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3), st.sampled_from(["none", "extrapolated"]))
def test_a_body_may_stand_anywhere(x, y, surface):
    first, other = (
        scene("plate", place, 1.0, surface).solve(1e-12) for place in ((0.0, 0.0), (x, y))
    )
    size = np.abs(first.displacement).max()
    np.testing.assert_allclose(other.displacement, first.displacement, atol=1e-9 * size)


@few
@given(st.floats(0.2, 0.5), st.floats(-0.2, 0.2), st.sampled_from(["volume", "extrapolated"]))
def test_mirror_images_have_mirrored_fields(radius, shift, surface):
    def temperature(sign):
        body = rectangle(2.0, 1.3, (sign * shift, 0.0)) - disc(radius, (sign * 0.31, 0.12))
        held = Support.where(rectangle(0.4, 2.0, (sign * (shift - 1.0), 0.0)), temperature=0.0)
        load = Load.flux((sign, 0.3), where=rectangle(0.4, 0.9, (sign * (shift + 1), 0.1)))
        conductor = ConductivityTensor.isotropic(1.0)
        solved = Scene(body, 0.1, conductor, [held], [load], m=3, surface=surface).solve(1e-12)
        return solved.discretisation.lattice.to_grid(solved.temperature[None])[0]

    one, other = temperature(1.0), temperature(-1.0)
    np.testing.assert_allclose(other, one[:, ::-1], atol=1e-9 * np.abs(one).max())
