"""Ways to make a function wrong: its result scaled, turned, swapped, not a number."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

Function = Callable[..., Any]
Change = Callable[[Function], Function]


def result(alter: Callable[[Any], Any]) -> Change:
    """The result altered."""

    def change(right: Function) -> Function:
        return lambda *args, **kwargs: alter(right(*args, **kwargs))

    return change


def argument(place: int, alter: Callable[[Any], Any]) -> Change:
    """A positional argument altered (counting self)."""

    def change(right: Function) -> Function:
        def wrong(*args: Any, **kwargs: Any) -> Any:
            given = list(args)
            given[place] = alter(given[place])
            return right(*given, **kwargs)

        return wrong

    return change


def scaled(factor: float) -> Change:
    """The result times a factor, whatever it is: a number, an array, a tuple of these."""
    return result(lambda value: _times(value, factor))


def _times(value: Any, factor: float) -> Any:
    if isinstance(value, tuple):
        scaled_values = (_times(v, factor) for v in value)
        return type(value)(*scaled_values) if hasattr(value, "_fields") else tuple(scaled_values)
    return factor * value


def field(name: str, alter: Callable[[Any], Any]) -> Change:
    """One field of the dataclass that is returned."""
    return result(
        lambda value: (
            dataclasses.replace(value, **{name: alter(getattr(value, name))})
            if hasattr(value, name)
            else value
        )
    )


def times(factor: float) -> Callable[[Any], Any]:
    """Multiplication, for `field` and `argument`."""
    return lambda value: _times(value, factor)


def one_nan(value: Any) -> Any:
    """An array with one entry that is no number (a number becomes none)."""
    if np.ndim(value) == 0:
        return float("nan")
    # In C order, so that the flat view is one and not a copy.
    spoilt = np.array(value, dtype=float, order="C")
    spoilt.reshape(-1)[spoilt.size // 2] = np.nan
    return spoilt


def swapped(axis: int = -1) -> Callable[[Any], Any]:
    """The first two components exchanged."""

    def alter(value: Any) -> Any:
        order = list(range(np.shape(value)[axis]))
        order[0], order[1] = 1, 0
        return np.take(value, order, axis=axis)

    return alter


def first_bond(values: Any) -> Any:
    """One bond of a family and its opposite stiffer by 5 %."""
    values = np.array(values)
    half = len(values) // 2
    values[[0, half]] *= 1.05
    return values
