"""Numbers whose squares are none: refused in one line that says which."""

import numpy as np
import pytest

from solver import (
    ConductivityTensor,
    ElasticTensor,
    Family,
    Inclusion,
    Load,
    Programme,
    Scene,
    SceneError,
    Support,
    disc,
    rectangle,
)
from solver.fracture import grow
from solver.magnitude import MODULI, outside

SOLID = ElasticTensor.isotropic(1.0, 0.2)
HELD = Support.where(lambda x, y: x < -2, displacement=0.0)


def test_in_words():
    assert outside(0.0, MODULI) == outside(1e-50, MODULI) == outside(1e50, MODULI) == ""
    assert "1.0e+51, not between 1e-50 and 1e+50" in outside(1e51, MODULI)
    assert outside(float("inf"), MODULI)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", [1e-300, 1e-200, 1e-60, 1e60, 1e200, 1e300])
def test_moduli_spacings_and_densities(size):
    made = (
        lambda: ElasticTensor.isotropic(size, 0.2),
        lambda: ElasticTensor.isotropic(size, 0.2, "strain"),
        lambda: ElasticTensor(size * SOLID.voigt),
        lambda: ConductivityTensor.isotropic(size),
        lambda: Family(3, size),
        lambda: Scene(rectangle(6, 4), 1.0, SOLID, density=size),
        lambda: Scene(rectangle(6, 4), 1.0, SOLID, thickness=size),
        lambda: Scene(
            rectangle(6, 4), 1.0, SOLID, [HELD], thickness=lambda x, y: size
        ).discretise(),
        lambda: Inclusion(disc(1.0), SOLID, density=size),
        lambda: Scene(
            rectangle(6, 4), 1.0, SOLID, inclusions=[Inclusion(disc(1), SOLID, thickness=size)]
        ),
    )
    for make in made:
        with pytest.raises(ValueError, match="leave the range of numbers") as caught:
            make()
        assert len(str(caught.value).splitlines()) == 1


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", [1e-290, 1e-150, 1e150, 1e290])
def test_loads_and_prescribed_values(size):
    pulled = Support.where(lambda x, y: x > 2, u1=size)
    for supports, loads, said in (
        ([HELD, pulled], [], "what is prescribed|a prescribed value is of the size"),
        ([HELD], [Load.body_force((size, 0.0))], "the load strains|a body force is of the size"),
        ([HELD], [Load.stress((size, 0.0, 0.0))], "the load|a stress at the edge is of the size"),
    ):
        scene = Scene(rectangle(6, 4), 1.0, SOLID, supports, loads, m=2, surface="extrapolated")
        with pytest.raises(SceneError, match=said):
            scene.solve()


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("modulus", [1e-49, 1e-9, 1e12, 1e49])
@pytest.mark.parametrize("unit", [1e-30, 1e-9, 1e6, 1e30])
def test_within_the_bounds_units_make_no_difference(modulus, unit):
    def solve(modulus, unit):
        scene = Scene(
            rectangle(6 * unit, 4 * unit),
            unit,
            ElasticTensor.isotropic(modulus, 0.2),
            [Support.where(lambda x, y: x < -2 * unit, displacement=0.0)],
            [Load.stress((1e-3 * modulus, 0.0, 0.0))],
            m=2,
            surface="extrapolated",
        )
        solution = scene.solve()
        solution.fields()
        return solution.displacement / unit

    np.testing.assert_allclose(solve(modulus, unit), solve(1.0, 1.0), rtol=1e-9, atol=1e-15)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", [1e-300, 1e300])
def test_critical_energies(size):
    scene = Scene(rectangle(6, 4), 1.0, SOLID, [HELD], m=2)
    with pytest.raises(SceneError, match="strain at which bonds break is of the size"):
        grow(scene, np.full(scene.family().size, size), Programme(), max_solves=2)
