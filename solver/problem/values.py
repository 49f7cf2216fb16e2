"""Values of supports and loads: numbers, arrays and functions of (x, y) or (x, y, t)."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..errors import SceneError
from ..magnitude import VALUES, outside

Value = float | ArrayLike | Callable[..., Any]


def in_time(value: Value | None) -> bool:
    """Whether a value is a function of (x, y, t): one that needs a third argument.

    A third argument with a default does not count: ``lambda x, y, k=k: …`` is common Python.
    """
    if not callable(value):
        return False
    try:
        parameters = inspect.signature(value).parameters.values()
    except (TypeError, ValueError):  # built-in functions that do not say
        return False
    places = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    needed = [p for p in parameters if p.kind in places and p.default is inspect.Parameter.empty]
    return len(needed) == 3


def at_time(value: Value, time: float) -> Value:
    """The value as a function of (x, y) alone, at one time."""
    if not in_time(value):
        return value
    assert callable(value)
    function = value
    return lambda x, y: function(x, y, time)


def evaluate(value: Value, points: Array, components: int, what: str) -> Array:
    """Number, array or function (x, y) → shape (n, components) at `points`.

    Raises
    ------
    SceneError
        If the shape does not fit, a value is not finite, or it depends on time.
    """
    if in_time(value):
        raise SceneError(
            f"{what} is a function of (x, y, t), and statics knows no time: run it with "
            f"solver.transient or solver.waves, or give a function of (x, y)"
        )
    # What a function says where it is not defined is judged here, by name.
    with np.errstate(all="ignore"):
        raw = value(points[:, 0], points[:, 1]) if callable(value) else value
    try:
        array = np.asarray(raw, dtype=np.float64)
        if components == 1:
            result = np.broadcast_to(array, (len(points),))[:, None]
        else:
            result = np.broadcast_to(array, (len(points), components))
    except (ValueError, TypeError) as error:
        wanted = "one value" if components == 1 else f"{components} values"
        raise SceneError(
            f"{what} needs {wanted} a particle for {len(points)} particles, "
            f"got shape {np.shape(raw)}"
        ) from error
    if not np.all(np.isfinite(result)):
        bad = points[~np.isfinite(result).all(axis=1)][0]
        raise SceneError(f"{what} is not finite at x = ({bad[0]:g}, {bad[1]:g})")
    if wrong := outside(float(np.abs(result).max(initial=0.0)), VALUES):
        raise SceneError(f"{what} is {wrong}")
    return np.array(result)
