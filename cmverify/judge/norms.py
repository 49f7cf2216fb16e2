"""The norms in which the suite states its errors."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray


def worst(values: Iterable[float]) -> float:
    """The largest of some errors, NaN if one is: Python's and NumPy's ``max`` let NaN pass.

    ``max(0.1, nan)`` is 0.1 and ``np.fmax`` ignores NaN by design; so does a loop with ``if``.

    Raises
    ------
    ValueError
        If there are none.

    Examples
    --------
    >>> worst([0.1, float("nan"), 0.2])
    nan
    >>> worst([0.1, -0.3])
    0.1
    """
    return float(np.max(np.fromiter(values, dtype=float)))


def relative_l2(computed: ArrayLike, reference: ArrayLike) -> float:
    """Relative L2 difference over points, ``sqrt(sum |a - b|^2) / sqrt(sum |b|^2)``.

    Parameters
    ----------
    computed, reference : arrays of equal shape, (N,) or (N, components)

    Returns
    -------
    float
        NaN if either array holds one: an error that is not a number has to stay visible.

    Raises
    ------
    ValueError
        If the shapes differ, nothing is to be compared, or the reference vanishes everywhere.
    """
    a = np.asarray(computed, dtype=float)
    b = np.asarray(reference, dtype=float)
    if a.shape != b.shape:
        raise ValueError(f"computed {a.shape} and reference {b.shape} do not match")
    if a.size == 0:
        raise ValueError("no points to compare")
    scale = np.linalg.norm(b)
    if scale == 0.0:
        raise ValueError("the reference vanishes everywhere: a relative error has no meaning")
    return float(np.linalg.norm(a - b) / scale)


def without_rigid_motion(points: NDArray[Any], displacement: NDArray[Any]) -> NDArray[Any]:
    """Displacements (k, 2) less their mean and their mean rotation about the points' centre."""
    arm = points - points.mean(axis=0)
    u = displacement - displacement.mean(axis=0)
    spin = np.sum(arm[:, 0] * u[:, 1] - arm[:, 1] * u[:, 0]) / np.sum(arm**2)
    rigid = np.stack([-arm[:, 1], arm[:, 0]], axis=-1)
    return np.asarray(u - spin * rigid)


def largest_deviation(computed: ArrayLike, reference: ArrayLike) -> float:
    """Largest ``|a / b - 1|``, NaN if one is.

    Raises
    ------
    ValueError
        If the shapes differ or a reference vanishes.
    """
    a, b = np.asarray(computed, dtype=float), np.asarray(reference, dtype=float)
    if a.shape != b.shape:
        raise ValueError(f"computed {a.shape} and reference {b.shape} do not match")
    if not np.all(b):
        raise ValueError("a reference vanishes: a relative deviation has no meaning")
    return worst(np.abs(a / b - 1.0).ravel())


def line_distance(one: ArrayLike, other: ArrayLike) -> float:
    """Largest distance from a point of either line to the other line (Hausdorff's).

    A line that ends before the other is as far from it as its end.

    Parameters
    ----------
    one, other : (k, 2) arrays
        Corners, two at least; to a fiftieth of each straight part.
    """
    from shapely import LineString, hausdorff_distance

    return float(hausdorff_distance(LineString(one), LineString(other), densify=0.02))
