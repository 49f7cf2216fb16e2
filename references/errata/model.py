"""What a judgement of the paper is: a printed form, what it should be, a verdict and a proof.

A proof compares every printed form with what is derived from definitions or theory.  Where the two
differ the difference is stated exactly, so that a printed form is pinned: another transcription
of it fails the proof.  Proofs raise `AssertionError` through functions rather than by `assert`, so
that they prove something under `python -O` too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from functools import cache
from typing import Any

from references.errata.expression import (
    agrees_in_digits,
    at_a_point,
    evaluate,
    same,
    surely_different,
)


class Verdict(Enum):
    """How a printed equation or number stands."""

    RIGHT = "right"
    DEFINITION = "definition"
    UNSAID = "right, frame or symbol not said"
    INCOMPLETE = "incomplete"
    NOTATION = "notation"
    LOST = "probably lost in extraction"
    WRONG = "wrong"
    OPEN = "cannot be judged"


#: Verdicts whose printed form must differ from the derived one.
DIFFERS = {Verdict.INCOMPLETE, Verdict.NOTATION, Verdict.LOST, Verdict.WRONG}


def require(condition: object, what: str) -> None:
    """Raise AssertionError with `what` unless the condition holds."""
    if not condition:
        raise AssertionError(what)


@dataclass(frozen=True)
class Form:
    """One printed member in code notation.

    Attributes
    ----------
    printed : str
    right : str
        As it should be; empty where that is as printed.
    off, ratio : str
        Printed minus derived, or printed over derived, exactly; empty for equal.
    digits, truncated : bool
        A number printed to some digits, rounded or cut off.
    """

    printed: str
    right: str = ""
    off: str = ""
    ratio: str = ""
    digits: bool = False
    truncated: bool = False

    def check(self, names: Mapping[str, Any], truth: Any, exact: bool) -> None:
        """Raise AssertionError unless the form stands to the truth as it says."""
        if self.digits:
            self._check_digits(float(truth))
            return
        if exact:
            self._glance(_at_a_point(names), at_a_point(truth))
        printed = evaluate(self.printed, names, exact)
        if self.off:
            pinned = same(_minus(printed, evaluate(self.off, names, exact)), truth)
        elif self.ratio:
            pinned = same(printed, evaluate(self.ratio, names, exact) * truth)
        else:
            pinned = same(printed, truth)
        require(pinned, self._failure())
        if self.right:
            corrected = evaluate(self.right, names, exact)
            require(same(corrected, truth), f"{self.right} is not what is derived")
            require(not same(printed, corrected), f"{self.printed} does not differ from it")

    def _glance(self, numbers: Mapping[str, Any], truth: Any) -> None:
        """The same at one point, which is quick and can only refuse."""
        try:
            printed = evaluate(self.printed, numbers, exact=False)
            stands = truth
            if self.off:
                printed = _minus(printed, evaluate(self.off, numbers, exact=False))
            elif self.ratio:
                stands = evaluate(self.ratio, numbers, exact=False) * truth
            refused = surely_different(printed, stands)
            if self.right and not refused:
                corrected = evaluate(self.right, numbers, exact=False)
                refused = surely_different(corrected, truth)
        except (AssertionError, TypeError, ValueError):
            return  # not a matter of numbers: left to the algebra
        require(not refused, self._failure())

    def _failure(self) -> str:
        return f"{self.printed} is not what is derived (off by {self._said()})"

    def _check_digits(self, truth: float) -> None:
        places = len(self.printed.partition(".")[2])
        stands = float(self.printed) - (float(self.off) if self.off else 0.0)
        text = f"{stands:.{places}f}"
        require(
            agrees_in_digits(stands, truth, text, self.truncated),
            f"{self.printed} is printed where {truth:.10g} is found (off by {self._said()})",
        )
        if self.right:
            require(
                agrees_in_digits(float(self.right), truth, self.right, self.truncated),
                f"{self.right} is not {truth:.10g}",
            )
            require(float(self.right) != float(self.printed), "the digits do not differ")

    def _said(self) -> str:
        return self.off or (f"the factor {self.ratio}" if self.ratio else "nothing")


@cache
def _once(derivation: Callable[[], Any]) -> Any:
    """A derivation's result: it does not depend on the forms that are held against it."""
    return derivation()


def _takes_numbers(value: Any) -> bool:
    """Not a function of ours, which may want expressions."""
    return not callable(value) or getattr(value, "__module__", "").startswith("sympy")


_POINTS: dict[int, tuple[Mapping[str, Any], dict[str, Any]]] = {}


def _at_a_point(names: Mapping[str, Any]) -> dict[str, Any]:
    """The names with ordinary numbers for symbols, made once."""
    if id(names) not in _POINTS:
        _POINTS[id(names)] = (
            names,
            {k: at_a_point(v) for k, v in names.items() if _takes_numbers(v)},
        )
    return _POINTS[id(names)][1]


def _minus(value: Any, off: Any) -> Any:
    if isinstance(value, list | tuple):
        require(len(value) == len(off), "the difference has another length")
        return [a - b for a, b in zip(value, off, strict=True)]
    return value - off


@dataclass(frozen=True)
class Entry:
    """One equation, or one statement or number of the text, judged.

    Attributes
    ----------
    number : str
        "79", or for what has no number its place ("Sect. 2.3.1 (particles)").
    title : str
    verdict : Verdict
    forms : tuple of Form
    truth : callable
        Derives what each form must equal, in order; it does not see the forms.
    names : callable
        What the names of the forms stand for.
    how : str
        How the truth is derived.
    readings : tuple of str
        Readings under which the print was tried, and what became of them.
    effect : str
        What somebody gets who follows the print; fields in braces are filled by `measure`.
    measure : callable, optional
        Computes the numbers of `effect`.
    needs : str
        What would have to be known, where nothing can be judged.
    exact : bool
        Whether literals of the forms are exact numbers.
    harmless : tuple of str
        Changed texts that say the same as the print, where only a reader can see that.
    """

    number: str
    title: str
    verdict: Verdict
    forms: tuple[Form, ...]
    truth: Callable[[], tuple[Any, ...]] = field(repr=False, compare=False)
    names: Callable[[], Mapping[str, Any]] = field(repr=False, compare=False, default=dict)
    how: str = ""
    readings: tuple[str, ...] = ()
    effect: str = ""
    measure: Callable[[], dict[str, float]] | None = field(repr=False, compare=False, default=None)
    needs: str = ""
    exact: bool = True
    harmless: tuple[str, ...] = ()

    @property
    def is_equation(self) -> bool:
        """Whether it is one of the paper's numbered equations."""
        return self.number.isdigit()

    @property
    def printed(self) -> str:
        """All printed forms."""
        return "; ".join(form.printed for form in self.forms)

    @property
    def derived(self) -> str:
        """All forms as they should be, or "as printed"."""
        if not any(form.right for form in self.forms):
            return "as printed" if self.verdict is not Verdict.OPEN else ""
        return "; ".join(form.right or form.printed for form in self.forms)

    def prove(self, forms: tuple[Form, ...] | None = None) -> None:
        """Compare every form with what is derived.

        Parameters
        ----------
        forms : tuple of Form, optional
            Others in the place of the entry's own: a test changes them and expects a failure.

        Raises
        ------
        AssertionError
            If a form is not what the entry says it is.
        """
        scope = _once(self.names)
        for form, truth in zip(forms or self.forms, _once(self.truth), strict=True):
            form.check(scope, truth, self.exact)

    def effect_in_numbers(self) -> str:
        """The effect with its numbers, computed now."""
        return self._filled(self.effect)

    def readings_in_numbers(self) -> tuple[str, ...]:
        """The readings with their numbers, computed now."""
        return tuple(self._filled(reading) for reading in self.readings)

    def _filled(self, text: str) -> str:
        return text.format(**_once(self.measure)) if self.measure else text
