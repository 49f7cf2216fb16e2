"""Threads where they pay.

Waking threads and waiting for the slowest takes some tens of microseconds a kernel, and a solve
calls hundreds of kernels: small bodies lose more by a second thread than they gain, and on one
thread kernels are compiled in a third of the time (`solver.compiled.Threaded`). Their results do
not depend on how many there are.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager

import numba as nb

from .operators import BondOperator

# Bonds times unknowns of a product that are worth a thread: half a millisecond of work.
_WORK = 2_000_000


def worth(operator: BondOperator) -> int:
    """How many threads the products of an operator are worth, however many there are."""
    return max(1, operator.directed_bonds * operator.components // _WORK)


@contextmanager
def at_most(count: int) -> Iterator[None]:
    """A context with some of the threads at hand."""
    at_hand = nb.get_num_threads()
    nb.set_num_threads(min(at_hand, count))
    try:
        yield
    finally:
        nb.set_num_threads(at_hand)


def suited(operator: BondOperator) -> AbstractContextManager[None]:
    """A context with as many of the threads at hand as an operator is worth."""
    return at_most(worth(operator))
