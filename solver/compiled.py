"""Kernels compiled by Numba, kept on disk where there is a place for that."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from types import FunctionType
from typing import Any

import numba as nb

#: Names of kernels that are compiled anew in every process: nowhere could they be kept.
in_memory: list[str] = []


class Threaded:
    """A kernel that shares out its work, compiled for many threads only where there are many.

    For many threads Numba compiles a function twice over, which takes three times as long: too
    much for bodies that keep to one thread (see `solver.threads`).

    Attributes
    ----------
    py_func : callable
        As for Numba's own: the function in Python.
    alone, shared : callable
        What Numba makes of it for one thread and for more.
    """

    def __init__(self, function: FunctionType, uses: tuple[str, ...], options: Any) -> None:
        self.py_func = function
        self.__name__, self.__doc__ = function.__name__, function.__doc__
        # Numba keeps by name what it compiles, whatever its options.
        twin = FunctionType(
            function.__code__,
            function.__globals__,
            function.__name__,
            function.__defaults__,
            function.__closure__,
        )
        twin.__qualname__, twin.__module__ = f"{function.__qualname__}_alone", function.__module__
        self.alone = _compiled(twin, uses, options)
        self.shared = _compiled(function, uses, options | {"parallel": True})

    @property
    def signatures(self) -> list[Any]:
        """Of all that has been compiled, or found on disk."""
        return [*self.alone.signatures, *self.shared.signatures]

    @property
    def stats(self) -> Any:
        """Where Numba keeps it."""
        return self.shared.stats

    def __call__(self, *given: Any) -> None:
        (self.alone if nb.get_num_threads() == 1 else self.shared)(*given)


def kernel(
    uses: tuple[str, ...] = (), parallel: bool = False, **options: Any
) -> Callable[[Callable[..., Any]], Any]:
    """Like `numba.njit` with a cache, but a cache that cannot be had is done without.

    Without a writable folder Numba raises at the decorator, so that nothing could be imported; on
    a full disk it raises when a compiled kernel is to be saved, in the middle of a solve.

    Parameters
    ----------
    uses : tuple of str
        Source files of compiled functions that the kernel calls. Numba looks at the kernel's own
        file only, and would go on with what it has kept when one of these changes.
    parallel : bool
        Whether loops over `numba.prange` are shared out among threads, see `Threaded`.
    options
        Of `numba.njit`.
    """

    def compile_(function: Any) -> Any:
        if parallel:
            return Threaded(function, uses, options)
        return _compiled(function, uses, options)

    return compile_


def _compiled(function: FunctionType, uses: tuple[str, ...], options: dict[str, Any]) -> Any:
    try:
        found = nb.njit(cache=True, **options)(function)
    except (RuntimeError, OSError):
        in_memory.append(function.__name__)
        return nb.njit(**options)(function)
    cache = getattr(found, "_cache", None)
    index = getattr(cache, "_cache_file", None)
    if uses and hasattr(index, "_source_stamp"):
        stamps = [(os.stat(path).st_mtime_ns, os.stat(path).st_size) for path in uses]
        index._source_stamp = (index._source_stamp, *stamps)  # type: ignore[union-attr]
    save = getattr(cache, "save_overload", None)
    if save is not None:

        def save_if_possible(*given: Any) -> None:
            with suppress(OSError):
                save(*given)

        # The attribute is Numba's own: where a version has none, its behaviour stays.
        cache.save_overload = save_if_possible  # type: ignore[union-attr]
    return found
