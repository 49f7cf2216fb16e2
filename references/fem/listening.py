"""Lets others hear which finite-element problems are solved, so that another code can solve them.

A solver of this room is `listened` to; within ``with listening(ear)`` each of its answers goes
through ``ear``, which may hand on another code's in its place. Nobody listens otherwise.
"""

import inspect
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import wraps
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")


@dataclass(frozen=True)
class Heard:
    """A problem that was solved.

    Attributes
    ----------
    solver : str
        Name of the function.
    arguments : dict
        What it was given, defaults included.
    answer
        What it gives.
    """

    solver: str
    arguments: dict[str, Any]
    answer: Any


Ear = Callable[[Heard], Any]
_ear: ContextVar[Ear | None] = ContextVar("_ear", default=None)


def listened(solver: Callable[P, R]) -> Callable[P, R]:
    """Let whoever listens hear a solver's problems, and change its answers."""
    signature = inspect.signature(solver)

    @wraps(solver)
    def told(*args: P.args, **kwargs: P.kwargs) -> R:
        answer = solver(*args, **kwargs)
        ear = _ear.get()
        if ear is None:
            return answer
        given = signature.bind(*args, **kwargs)
        given.apply_defaults()
        changed: R = ear(Heard(solver.__name__, dict(given.arguments), answer))
        return changed

    return told


@contextmanager
def listening(ear: Ear) -> Iterator[None]:
    """Hear every problem that is solved within the block; what ``ear`` returns is the answer."""
    before = _ear.set(ear)
    try:
        yield
    finally:
        _ear.reset(before)
