"""Maps of stability: over Poisson's ratio, over orthotropy, over the anisotropy of conduction."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from cmverify.case import Array
from cmverify.cases.common import materials

if TYPE_CHECKING:
    from solver.material import Calibration

#: Values of a map where there are no such moduli, and where the rotation block has a pole.
NONE, POLE = np.nan, -np.inf


@dataclass(frozen=True)
class Map:
    """Stability margins over two parameters.

    Attributes
    ----------
    title, xlabel, ylabel : str
    x, y : ndarray
        Parameters along both axes.
    margin : ndarray, shape (len(y), len(x))
        NaN where no moduli exist, −inf where the rotation block has a pole.
    """

    title: str
    xlabel: str
    ylabel: str
    x: Array
    y: Array
    margin: Array


def margin(tensor: Array, m: float, calibration: Calibration, count: int) -> float:
    """Stability margin, `NONE` without moduli, `POLE` where rotations lose their stiffness."""
    from cmverify.studies.stability.assessments import material
    from solver import CalibrationError, Family
    from solver.material import assess, calibrate

    family = Family(m)
    try:
        moduli = calibrate(family, material(tensor), calibration)
    except CalibrationError:
        return NONE
    return assess(family, moduli, count).margin


def _map(
    title: str,
    labels: tuple[str, str],
    x: Sequence[float] | Array,
    y: Sequence[float] | Array,
    value: Callable[[float, float], float],
) -> Map:
    values = np.array([[value(a, b) for a in x] for b in y])
    return Map(title, *labels, np.asarray(x, float), np.asarray(y, float), values)


def poisson(fine: bool) -> list[Map]:
    """Isotropic solids over (ν ≥ 0, m), lattice calibration, in plane stress and plane strain."""
    nus = np.linspace(0.0, 0.495, 67 if fine else 23)
    horizons = (2, 2.5, 3, 3.5, 4, 5, 6, 7) if fine else (2, 3, 4, 5, 6)
    planes: tuple[Literal["stress", "strain"], ...] = ("stress", "strain")
    return [
        _map(
            f"plane {plane}",
            ("Poisson's ratio ν", "horizon m"),
            nus,
            horizons,
            lambda nu, m, plane=plane: margin(  # type: ignore[misc]
                materials.isotropic(nu, plane), m, "lattice", 24 if fine else 16
            ),
        )
        for plane in planes
    ]


def poisson_limit(m: float, calibration: Calibration = "lattice") -> float:
    """Largest stable Poisson ratio in plane strain, by bisection to 1e-4."""
    low, high = 0.30, 0.45
    while high - low > 1e-4:
        middle = 0.5 * (low + high)
        found = margin(materials.isotropic(middle, "strain"), m, calibration, 32)
        low, high = (middle, high) if found > 0 else (low, middle)
    return 0.5 * (low + high)


#: Ratio ν12 of the orthotropic maps.
NU12 = 0.25


def orthotropic(fine: bool, m: float = 5) -> list[Map]:
    """Orthotropic solids over (E1/E2, G12/E2), ν12 = 1/4, one map a calibration."""
    stiff = np.geomspace(1.0, 40.0, 25 if fine else 11)
    shear = np.geomspace(0.15, 2.0, 21 if fine else 9)
    return [
        _map(
            calibration,
            ("$E_1/E_2$", "$G_{12}/E_2$"),
            stiff,
            shear,
            lambda e, g, c=calibration: margin(  # type: ignore[misc]
                materials.orthotropic(e, 1.0, g, NU12), m, c, 24 if fine else 12
            ),
        )
        for calibration in materials.CALIBRATIONS
    ]


def conduction(fine: bool, m: float = 3) -> list[Map]:
    """Conductors over ratio and angle, one map a calibration."""
    ratios = np.geomspace(1.0, 1000.0, 25 if fine else 10)
    angles = np.linspace(0.0, 45.0, 19 if fine else 7)
    return [
        _map(
            calibration,
            ("$K_1/K_2$", "angle (°)"),
            ratios,
            angles,
            lambda r, a, c=calibration: margin(  # type: ignore[misc]
                materials.conductivity(r, np.radians(a)), m, c, 24 if fine else 12
            ),
        )
        for calibration in materials.CALIBRATIONS
    ]


#: Turn of the orthotropic axes in the map of representability; aligned, m = 1 does or none.
ANGLE = 20.0


def smallest_horizon(tensor: Array, largest: int = 10) -> float:
    """Smallest m with non-negative exact moduli; inf if no m has them, NaN if none to `largest`."""
    from cmverify.studies.stability.assessments import material
    from solver import Family
    from solver.material import representable, representable_by_directions

    solid = material(tensor)
    if tensor.shape == (3, 3) and tensor[2, 2] < tensor[0, 1]:
        return np.inf
    if not representable_by_directions(solid):
        return np.inf
    for m in range(1, largest + 1):
        if representable(Family(m), solid):
            return float(m)
    return np.nan


@dataclass(frozen=True)
class Representability:
    """Which tensors have non-negative moduli, and at which m.

    Attributes
    ----------
    orthotropic : Map
        Smallest m over (E1/E2, G12/E2), inf where none.
    horizons, shares : sequences
        Share of random positive-definite tensors that have them at each m.
    never, below : float
        Share that has them at no m, and of these the share (of all) with C66 < C12.
    count : int
        Random tensors tried.
    """

    orthotropic: Map
    horizons: tuple[int, ...]
    shares: tuple[float, ...]
    never: float
    below: float
    count: int


def representability(fine: bool) -> Representability:
    """Smallest m over an orthotropic grid, and shares of the suite's random tensors."""
    from itertools import islice

    from cmverify.cases.hard.random_tensors import tensors

    stiff = np.geomspace(1.0, 40.0, 25 if fine else 11)
    shear = np.geomspace(0.15, 2.0, 21 if fine else 9)
    grid = _map(
        f"smallest m, turned by {ANGLE:g}°",
        ("$E_1/E_2$", "$G_{12}/E_2$"),
        stiff,
        shear,
        lambda e, g: smallest_horizon(
            materials.turned(materials.orthotropic(e, 1.0, g, NU12), ANGLE)
        ),
    )
    count = 200 if fine else 60
    random = list(islice(tensors(), count))
    smallest = np.array([smallest_horizon(t) for t in random])
    below = np.array([t[2, 2] < t[0, 1] for t in random])
    horizons = tuple(range(1, 11))
    shares = tuple(float((smallest <= m).mean()) for m in horizons)
    return Representability(
        grid, horizons, shares, float(np.isinf(smallest).mean()), float(below.mean()), count
    )
