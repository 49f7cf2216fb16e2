"""BLAS on one thread, without a look round for libraries at each use.

BLAS reductions change in the last bits with the number of threads. `threadpoolctl` finds the
libraries that are loaded by reading the process's memory map, some 6 ms: a run that solves small
systems hundreds of times would spend a quarter of its time on it.
"""

from __future__ import annotations

from contextlib import AbstractContextManager
from functools import cache
from typing import Any

from threadpoolctl import ThreadpoolController


@cache
def _libraries() -> ThreadpoolController:
    # SciPy brings its own BLAS: it must be there to be found.
    import scipy.linalg
    import scipy.sparse.linalg  # noqa: F401

    return ThreadpoolController()


def one_thread() -> AbstractContextManager[Any]:
    """A context in which the BLAS of NumPy and SciPy keeps to one thread."""
    context: AbstractContextManager[Any] = _libraries().limit(limits=1, user_api="blas")
    return context
