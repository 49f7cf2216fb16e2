"""Moduli that may be used: calibrated, found stable in bulk, or refused with what would do instead.

What would do is looked for only where something is refused, which takes some tenths of a second.
"""

from __future__ import annotations

from functools import singledispatch

import numpy as np

from ..errors import CalibrationError, InadmissibleMaterialError, NotRepresentableError
from .calibration import Calibration, calibrate, representable, representable_by_directions
from .family import Family
from .laws import AngularLaw, TwoHarmonic, UniformShear
from .moduli import ChiralModuli, Moduli, effective_tensor
from .stability import Stability, assess
from .tensors import ElasticTensor, Material

Remedies = tuple[tuple[Calibration, AngularLaw | None], ...]

# Largest m at which non-negative moduli are looked for.
_LARGEST_M = 14
# Horizons tried, and grid of the zone, when looking for what would be stable instead.
_REMEDY_HORIZONS = range(2, 9)
_REMEDY_GRID = 16
# In order of preference: non-negative bonds keep damaged bodies stable too.
_ELASTIC_REMEDIES: Remedies = (
    ("positive", None),
    ("positive", UniformShear()),
    ("lattice", None),
    ("lattice", UniformShear()),
    ("lattice", TwoHarmonic()),
)
_REMEDIES: Remedies = (
    ("positive", None),
    ("lattice", None),
)


def remedy(family: Family, material: Material) -> str:
    """What to use where a calibration is refused: a sentence for its error message.

    Every calibration and law is tried at the family's own m first, then at larger and at smaller
    ones. What is named has been found stable; that nothing is named means that all of it is
    unstable or does not exist.

    Parameters
    ----------
    family : Family
    material : ElasticTensor or ConductivityTensor
    """
    remedies, cause = _choices(material)
    # Larger families first: what fails for want of directions or of area finds more there.
    larger = [m for m in _REMEDY_HORIZONS if m > family.m]
    smaller = [m for m in _REMEDY_HORIZONS if m < family.m]
    for m in (family.m, *larger, *reversed(smaller)):
        other = Family(m, family.spacing * family.m / m, family.area_rule, family.influence)
        for calibration, law in remedies:
            found = _trial(other, material, calibration, law)
            if found is None or found.kind == "inadmissible":
                continue
            named = "" if law is None else f", law={type(law).__name__}()"
            where = "" if m == family.m else f" at m = {m}"
            choice = f"calibration={calibration!r}{named}{where}"
            return f"Use {choice} (stable, margin {found.margin:.2g})."
    return (
        f"No calibration or law of this package is stable for it at any "
        f"m ≤ {_REMEDY_HORIZONS[-1]}{cause}. Use finite elements for this solid."
    )


@singledispatch
def _choices(material: Material) -> tuple[Remedies, str]:
    """Calibrations and laws to try, in order of preference, and why there are no more."""
    return _REMEDIES, ""


@_choices.register
def _(material: ElasticTensor) -> tuple[Remedies, str]:
    if material.voigt[2, 2] >= material.voigt[0, 1]:
        return _ELASTIC_REMEDIES, ""
    return tuple(r for r in _ELASTIC_REMEDIES if r[0] == "lattice"), (
        ": C66 < C12 asks for shear bonds that are negative on the mean, and here they outweigh "
        "the axial ones"
    )


def _trial(
    family: Family, material: Material, calibration: Calibration, law: AngularLaw | None
) -> Stability | None:
    """Stability of a calibration, None where it has no moduli."""
    try:
        moduli = calibrate(family, material, calibration, law)
    except CalibrationError:
        return None
    coarse = assess(family, moduli, _REMEDY_GRID)
    return coarse if coarse.kind == "inadmissible" else assess(family, moduli)


def require_admissible(family: Family, moduli: Moduli) -> Stability:
    """`assess`, and refuse what is unstable in bulk.

    Raises
    ------
    InadmissibleMaterialError
        With the wave vector at which the condensed symbol is not positive, and with a
        calibration, law or m that is stable for the same tensor if there is one.
    """
    found = assess(family, moduli)
    if found.kind == "inadmissible":
        k1, k2 = found.wave_vector
        low, high = found.rotation_range
        if found.wave_vector == (0.0, 0.0):
            why = "a homogeneous strain releases energy (the sums over bonds are not positive)"
        elif low * high < 0:
            why = "the rotation stiffness of the bonds passes through zero"
        elif found.margin == -np.inf:
            why = "a pattern of rotations strains no shear bond (the rotation stiffness is zero)"
        else:
            why = f"the condensed symbol is not positive (relative value {found.margin:.3g})"
        raise InadmissibleMaterialError(
            f"this material is unstable in bulk at m = {family.m:g}: {why} at the wave vector "
            f"k Δx = ({k1:.4f}, {k2:.4f}). {_instead_of(family, moduli)}"
        )
    return found


def _instead_of(family: Family, moduli: Moduli) -> str:
    """`remedy` for the tensor that these moduli make."""
    if isinstance(moduli, ChiralModuli):
        return (
            "Of a chiral solid other laws (law=UniformShear()) and other m may be stable, and "
            "smaller turns are."
        )
    tensor = effective_tensor(family, moduli)
    try:
        material = moduli.tensor(tensor)
    except ValueError:
        return "The lattice sums make no positive-definite tensor: use calibration='lattice'."
    assert isinstance(material, Material)
    return remedy(family, material)


def calibrated(
    family: Family,
    material: Material,
    calibration: Calibration = "lattice",
    law: AngularLaw | None = None,
) -> Moduli:
    """`calibrate`, with advice where it refuses.

    Raises
    ------
    CalibrationError
        With what to use instead, and for ``positive`` which m would do, or that none will.
    """
    try:
        return calibrate(family, material, calibration, law)
    except NotRepresentableError as error:
        advice = f"{error}{_elsewhere(family, material)} {remedy(family, material)}"
        raise NotRepresentableError(advice) from None
    except CalibrationError as error:
        raise CalibrationError(f"{error}. {remedy(family, material)}") from None


def _elsewhere(family: Family, material: Material) -> str:
    """Which m would have non-negative moduli, or that none up to `_LARGEST_M` has, or none."""
    if not representable_by_directions(material):
        return (
            f", nor at any m ≤ {_LARGEST_M} or beyond: bonds in all directions together do not "
            f"make it."
        )
    for m in range(int(family.m) + 1, _LARGEST_M + 1):
        other = Family(m, family.spacing * family.m / m, family.area_rule, family.influence)
        if representable(other, material):
            return f"; they exist at m = {m}. Use that, or the following."
    return f", nor at any m ≤ {_LARGEST_M}, whose bonds have too few directions."
