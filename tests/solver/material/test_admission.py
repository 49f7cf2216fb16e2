"""What refusals recommend is stable; where they recommend nothing, nothing is."""

import re

import numpy as np
import pytest

import solver
from solver import CalibrationError, ConductivityTensor, ElasticTensor, Family
from solver.errors import NotRepresentableError
from solver.material import (
    assess,
    calibrate,
    calibrated,
    remedy,
    representable,
    representable_by_directions,
    require_admissible,
)

PLY = ElasticTensor([[140, 3, 0], [3, 10, 0], [0, 0, 5]])
#: C66 > C12, and yet not a sum of non-negative bonds (see test_micromoduli).
UNREACHABLE = ElasticTensor([[2.25, -1.05, 0.87], [-1.05, 0.96, -0.28], [0.87, -0.28, 1.45]])


def followed(message: str, m: float, material) -> solver.material.stability.Stability:
    """Stability of what a message recommends."""
    found = re.search(r"Use calibration='(\w+)'(?:, law=(\w+)\(\))?(?: at m = (\d+))? ", message)
    assert found, message
    law = getattr(solver, found[2])() if found[2] else None
    family = Family(int(found[3]) if found[3] else m)
    return assess(family, calibrate(family, material, found[1], law))


@pytest.mark.parametrize("m", [3, 5])
@pytest.mark.parametrize(
    "material",
    [
        PLY,
        PLY.rotated(0.5),
        UNREACHABLE,
        ElasticTensor.orthotropic(40.0, 1.0, 0.5, 0.25),
        ElasticTensor.isotropic(1.0, 0.45),
        ConductivityTensor.orthotropic(1000.0, 1.0, np.pi / 8),
        ConductivityTensor.orthotropic(464.0, 1.0, np.radians(15)),
    ],
)
def test_what_is_recommended_is_stable(material, m):
    assert followed(remedy(Family(m), material), m, material).kind != "inadmissible"


def test_nothing_is_recommended_beyond_the_limit():
    message = remedy(Family(5), ElasticTensor.isotropic(1.0, 0.4, "strain"))
    assert "C66 < C12" in message
    assert "Use finite elements" in message


def test_an_hourglass_of_rotations_is_named():
    # Only few of the bonds that these non-negative moduli leave resist shear, all of odd length:
    # rotations of alternating sign strain none of them.
    material = ElasticTensor.orthotropic(40.0, 1.0, 0.5, 0.25)
    family = Family(3)
    moduli = calibrate(family, material, "positive")
    with pytest.raises(solver.InadmissibleMaterialError, match="a pattern of rotations") as caught:
        require_admissible(family, moduli)
    assert followed(str(caught.value), 3, material).kind == "positive"


def test_directions_decide_what_no_lattice_can_do():
    assert not representable_by_directions(UNREACHABLE)
    assert not any(representable(Family(m), UNREACHABLE) for m in range(2, 9))
    assert representable_by_directions(PLY)
    steep = ConductivityTensor.orthotropic(1000.0, 1.0, np.pi / 8)
    assert representable_by_directions(steep)
    assert not representable(Family(3), steep)


def test_calibration_itself_refuses_without_advice():
    with pytest.raises(NotRepresentableError) as caught:
        calibrate(Family(3), UNREACHABLE, "positive")
    assert "Use" not in str(caught.value)
    with pytest.raises(NotRepresentableError, match="Use"):
        calibrated(Family(3), UNREACHABLE, "positive")


def test_laws_that_cannot_be_calibrated_say_what_can():
    # At m = 3 hardly a bond lies near 15°, and the narrow cosine law that the ratio asks for
    # falls between them.
    material = ConductivityTensor.orthotropic(1000.0, 1.0, np.radians(15))
    with pytest.raises(CalibrationError, match="has the moments of this tensor") as caught:
        calibrated(Family(3), material)
    assert followed(str(caught.value), 3, material).kind == "positive"
