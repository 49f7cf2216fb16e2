"""Edge-, centre- and compact-tension cracks in anisotropic plates: stress intensity factors."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from references.fem.elasticity import ElasticSolution, solve_elasticity
from references.fem.interaction import StressIntensity, stress_intensity
from references.fem.mesh import Mesh, Segment, rectangle


def plate_under_tension(
    voigt: ArrayLike,
    width: float,
    height: float,
    cracks: Sequence[Segment],
    tension: float,
    elements: int,
) -> ElasticSolution:
    """A cracked rectangle about the origin, pulled along axis 2 by a uniform traction.

    Parameters
    ----------
    voigt : (3, 3) array_like
        Pa.
    width, height : float
    cracks : sequence of ((x, y), (x, y))
    tension : float
        Pa, on the edges ``top`` and ``bottom``.
    elements : int
        Along the longer side, far from the cracks. At the tips they are smaller than the crack by
        a factor of 100 ``elements`` and grow away from them by 2.4 / ``elements`` per unit length.
    """
    if elements < 4:
        raise ValueError("at least four elements along the longer side")
    shortest = min(float(np.hypot(b[0] - a[0], b[1] - a[1])) for a, b in cracks)
    mesh = rectangle(
        width,
        height,
        max(width, height) / elements,
        cracks=cracks,
        tip_size=shortest / (100 * elements),
        growth=2.4 / elements,
    )
    pull = {"top": (0.0, tension), "bottom": (0.0, -tension)}
    return solve_elasticity(mesh, voigt, tractions=pull)


def edge_crack(
    voigt: ArrayLike,
    width: float,
    height: float,
    length: float,
    tension: float = 1.0,
    elements: int = 16,
) -> StressIntensity:
    """Crack from the middle of the left edge, along axis 1; tension along axis 2.

    Parameters
    ----------
    voigt : (3, 3) array_like
    width, height, length : float
        Of the plate and of the crack, m.
    tension : float
        Pa.
    elements : int
        Fineness of the mesh, see :func:`plate_under_tension`.

    Returns
    -------
    StressIntensity

    Raises
    ------
    ValueError
        If the crack is not shorter than the plate is wide.
    """
    if not 0 < length < width:
        raise ValueError("the crack must be shorter than the plate is wide")
    left = -width / 2
    tip = (left + length, 0.0)
    crack = ((left, 0.0), tip)
    solution = plate_under_tension(voigt, width, height, [crack], tension, elements)
    return stress_intensity(solution, tip, 0.0, 0.6 * min(length, width - length))


def centre_crack(
    voigt: ArrayLike,
    width: float,
    height: float,
    half_length: float,
    angle: float = 0.0,
    tension: float = 1.0,
    elements: int = 16,
) -> StressIntensity:
    """Crack through the plate's centre; the tip at positive abscissa.

    Parameters
    ----------
    voigt : (3, 3) array_like
    width, height, half_length : float
        m.
    angle : float
        Of the crack from axis 1, rad, between −π/2 and π/2.
    tension : float
        Pa, along axis 2.
    elements : int
        Fineness of the mesh, see :func:`plate_under_tension`.

    Returns
    -------
    StressIntensity

    Raises
    ------
    ValueError
        If the crack leaves the plate or the angle its range.
    """
    if not abs(angle) <= np.pi / 2:
        raise ValueError("the crack's angle must lie between −π/2 and π/2")
    tip = (half_length * float(np.cos(angle)), half_length * float(np.sin(angle)))
    room = min(width / 2 - abs(tip[0]), height / 2 - abs(tip[1]))
    if half_length <= 0 or room <= 0:
        raise ValueError("the crack does not lie inside the plate")
    crack = ((-tip[0], -tip[1]), tip)
    solution = plate_under_tension(voigt, width, height, [crack], tension, elements)
    return stress_intensity(solution, tip, angle, 0.6 * min(half_length, room))


def compact_tension(
    voigt: ArrayLike, width: float, length: float, force: float = 1.0, elements: int = 16
) -> StressIntensity:
    """Compact-tension specimen with the proportions of ASTM E399, cut by a slit.

    Plate 1.25 W × 1.2 W with pin holes of diameter 0.25 W at ± 0.275 W from the crack; the crack
    is measured from the load line. The pins push on the outer half of their holes with a pressure
    that goes with the cosine from the load's direction.

    Parameters
    ----------
    voigt : (3, 3) array_like
    width, length : float
        W and a, m.
    force : float
        On each pin, N per unit thickness, along axis 2.
    elements : int
        Fineness of the mesh, see :func:`plate_under_tension`.

    Returns
    -------
    StressIntensity

    Raises
    ------
    ValueError
        If the crack's tip leaves 0.2 < a/W < 0.9.
    """
    if not 0.2 * width < length < 0.9 * width:
        raise ValueError("a compact-tension crack has 0.2 < a/W < 0.9")
    shift, radius, offset = -0.375 * width, 0.125 * width, 0.275 * width
    tip = (length + shift, 0.0)
    mesh = rectangle(
        1.25 * width,
        1.2 * width,
        1.25 * width / elements,
        holes=[(shift, offset, radius), (shift, -offset, radius)],
        cracks=[((-0.625 * width, 0.0), tip)],
        tip_size=length / (100 * elements),
        hole_size=2 * radius / elements,
        growth=2.4 / elements,
    )

    def pin(sign: float):  # type: ignore[no-untyped-def]
        def pressure(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
            away = np.stack([x - shift, y - sign * offset], axis=-1) / radius
            # ∫ cos² over half the circle is π/2
            return 2 * force / (np.pi * radius) * np.maximum(sign * away[..., 1:], 0) * away

        return pressure

    tractions = {}
    for k, sign in enumerate((1.0, -1.0)):
        upward = sign * _vertical_force(mesh, f"hole{k}", pin(sign))
        # the polygon is a little shorter than the circle: scale to the force asked for
        tractions[f"hole{k}"] = _scaled(pin(sign), force / upward)
    solution = solve_elasticity(mesh, voigt, tractions=tractions)
    ring = 0.6 * min(width - length, length - radius)
    return stress_intensity(solution, tip, 0.0, ring)


def _scaled(function, factor: float):  # type: ignore[no-untyped-def]
    return lambda x, y: factor * function(x, y)


def _vertical_force(mesh: Mesh, name: str, traction) -> float:  # type: ignore[no-untyped-def]
    """∫ t₂ along a boundary, with the three-point Gauss rule on each edge."""
    a, b = (mesh.points[mesh.boundaries[name][:, i]] for i in range(2))
    abscissae, weights = np.polynomial.legendre.leggauss(3)
    total = 0.0
    for s, w in zip(abscissae, weights, strict=True):
        x = (a + b) / 2 + s * (b - a) / 2
        total += np.sum(traction(*x.T)[:, 1] * w * np.hypot(*(b - a).T) / 2)
    return float(total)
