"""How many threads a worker may use, and how to tell the libraries.

Numba, OpenMP and the BLAS read these variables once, when they are first imported. A worker is
therefore started with them set; setting them in a process that has already imported NumPy is too
late.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

#: Environment variables of every threaded library in use.
VARIABLES = (
    "NUMBA_NUM_THREADS",
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)


def available_cores() -> int:
    """Cores this process may use (an affinity mask or a container's limit included)."""
    try:
        cores = len(os.sched_getaffinity(0))
    except AttributeError:  # not on Linux
        cores = os.cpu_count() or 1
    quota = _cgroup_quota()
    return max(1, min(cores, quota) if quota else cores)


def threads_per_worker(jobs: int) -> int:
    """Threads for each of `jobs` workers so that together they do not exceed the cores."""
    if jobs < 1:
        raise ValueError(f"at least one job is needed, not {jobs}")
    return max(1, available_cores() // jobs)


def thread_environment(threads: int) -> dict[str, str]:
    """Environment variables that limit every library to `threads`."""
    return dict.fromkeys(VARIABLES, str(threads))


@contextmanager
def child_environment(variables: Mapping[str, str] | None = None) -> Iterator[None]:
    """Environment of the children that are started inside the block.

    Besides the given variables: a file of the working folder that is called as one of Python's
    modules (random.py) is not to be imported instead of it.
    """
    wanted = {"PYTHONSAFEPATH": "1", **(variables or {})}
    before = {name: os.environ.get(name) for name in wanted}
    os.environ.update(wanted)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def _cgroup_quota() -> int | None:
    """Whole cores of a Linux control group's limit, or None if there is none."""
    try:
        with open("/sys/fs/cgroup/cpu.max") as file:
            quota, period = file.read().split()
        return None if quota == "max" else max(1, int(quota) // int(period))
    except (OSError, ValueError):
        return None
