"""An edge crack in a long strip under any stress across it, by Bueckner's weight function.

H. F. Bueckner (1970, *ZAMM* 50, 529): a pair of unit forces on the faces at the distance x from
the edge makes K_I = h(x, a),

    h = sqrt(2/(π (a − x))) [1 + m1 (1 − x/a) + m2 (1 − x/a)²],

with m1, m2 polynomials of r = a/W, good to a per cent up to r = 1/2. By superposition a stress σ(x)
that the strip would bear without a crack makes K_I = ∫ σ h dx, whatever raises it; here what is
left of a change of temperature once the strip is free to lengthen and to bend.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.special import erfc

from references.analytic.quadrature import gauss
from references.analytic.voigt import Floats

# Gauss points over the crack, and over the width.
_POINTS = 200


def intensity(stress: Callable[[Floats], Floats], crack: float, width: float) -> float:
    """K_I, Pa m^(1/2).

    Parameters
    ----------
    stress : callable
        σ(x), Pa, of an array of distances from the edge, m.
    crack, width : float
        a and W, m.

    Raises
    ------
    ValueError
        If not 0 < a ≤ W/2.
    """
    if not 0 < crack <= 0.5 * width:
        raise ValueError(f"the weight function is known for 0 < a ≤ W/2, not a = {crack}")
    r = crack / width
    m1 = 0.6147 + 17.1844 * r**2 + 8.7822 * r**6
    m2 = 0.2502 + 3.2899 * r**2 + 70.0444 * r**6
    # 1 − x/a = s² takes the root away.
    s, weight = gauss(_POINTS)
    s, weight = 0.5 * (s + 1), 0.5 * weight
    shape = 1 + m1 * s**2 + m2 * s**4
    return float(
        2
        * crack
        * np.sqrt(2 / (np.pi * crack))
        * (weight * stress(crack * (1 - s**2)) * shape).sum()
    )


def quenched(x: Floats, width: float, depth: float) -> Floats:
    """Temperature of a strip whose edges have been cold for a time t, per degree of the jump.

    −erfc(x/2ℓ) − erfc((W − x)/2ℓ), ℓ = sqrt(κ t): both edges as if alone, while ℓ is small
    beside W.
    """
    return np.asarray(-erfc(x / (2 * depth)) - erfc((width - x) / (2 * depth)))


def thermal_stress(
    x: Floats, width: float, change: Callable[[Floats], Floats], young: float, expansion: float
) -> Floats:
    """σ along a long strip, free of forces and moments, Pa: E α (mean and line of T less T)."""
    points, weight = gauss(_POINTS)
    there, lever = 0.5 * width * (points + 1), points
    mean = 0.5 * float(weight @ change(there))
    slope = 1.5 * float(weight @ (lever * change(there)))
    line = mean + slope * (2 * np.asarray(x) / width - 1)
    return np.asarray(young * expansion * (line - change(np.asarray(x))))
