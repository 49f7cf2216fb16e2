"""Threads where they pay.

Waking threads and waiting for the slowest takes some tens of microseconds a kernel, and a solve
calls hundreds of kernels: small bodies lose more by a second thread than they gain. The kernels'
results do not depend on how many there are.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numba as nb

from .operators import BondOperator

# Bonds times unknowns of a product that are worth a thread: half a millisecond of work.
_WORK = 2_000_000


def worth(operator: BondOperator) -> int:
    """How many threads the products of an operator are worth, however many there are."""
    return max(1, operator.directed_bonds * operator.components // _WORK)


@contextmanager
def suited(operator: BondOperator) -> Iterator[None]:
    """A context with as many of the threads at hand as an operator is worth."""
    at_hand = nb.get_num_threads()
    nb.set_num_threads(min(at_hand, worth(operator)))
    try:
        yield
    finally:
        nb.set_num_threads(at_hand)
