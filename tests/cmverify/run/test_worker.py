"""One measurement: what the solver says on the way is part of it."""

import logging
from dataclasses import replace

from cmverify.case import Level, Measurement, Method
from cmverify.run.worker import measure
from solver import ConductivityTensor, Scene, Support, rectangle
from tests.cmverify.toy_registry import trapezium


def thin(n: int) -> Measurement:
    """Solves two scenes and hands on nothing that they say."""
    for height in (3.0, 3.0, 4.0):
        Scene(
            rectangle(20.0, height),
            1.0,
            ConductivityTensor.isotropic(1.0),
            [Support.where(lambda x, y: abs(x) > 6.0, temperature=0.0)],
            m=3,
        ).solve()
    return replace(trapezium(n), warnings=("its own word",))


def test_a_measurement_knows_what_the_solver_said():
    method = Method("bond/thin", "bond", thin, {Level.QUICK: (10,)})
    own, *said = measure(method, 10).warnings
    assert own == "its own word"
    first, second = (warning for warning in said if "cells thick" in warning)
    assert "3 cells thick" in first
    assert "4 cells thick" in second
    assert measure(Method("exact", "exact", trapezium, {Level.QUICK: (10,)}), 10).warnings == ()


def test_listening_leaves_nothing_behind():
    logger = logging.getLogger("solver")
    before = logger.level, list(logger.handlers)
    measure(Method("bond/thin", "bond", thin, {Level.QUICK: (10,)}), 10)
    assert (logger.level, logger.handlers) == before
