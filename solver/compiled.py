"""Kernels compiled by Numba, kept on disk where there is a place for that."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numba as nb

#: Names of kernels that are compiled anew in every process: nowhere could they be kept.
in_memory: list[str] = []


def kernel(uses: tuple[str, ...] = (), **options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Like `numba.njit` with a cache, but a cache that cannot be had is done without.

    Without a writable folder Numba raises at the decorator, so that nothing could be imported; on
    a full disk it raises when a compiled kernel is to be saved, in the middle of a solve.

    Parameters
    ----------
    uses : tuple of str
        Source files of compiled functions that the kernel calls. Numba looks at the kernel's own
        file only, and would go on with what it has kept when one of these changes.
    options
        Of `numba.njit`.
    """

    def compile_(function: Callable[..., Any]) -> Any:
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

    return compile_
