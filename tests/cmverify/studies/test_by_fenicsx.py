"""FEniCSx in the study of work and precision; here scikit-fem plays it."""

from dataclasses import replace

import numpy as np
import pytest

from cmverify.case import Level
from cmverify.cases import registry
from cmverify.studies import by_fenicsx, precision
from references.fem.conduction import steady_conduction
from references.fenicsx import bridge


@pytest.fixture
def played(monkeypatch):
    """Passes take 1 s, 2 s, …; forms, which do not count, a hundred."""

    def heat(**given):
        timing = bridge._timing.get()
        number = np.arange(timing.passes, dtype=float)
        taken = {"forms": number + 100.0, "setup": 0.25 * number, "solve": 0.75 * number}
        timing.taken.append({**taken, "memory": np.array(5_000_000)})
        return 1.001 * steady_conduction.__wrapped__(**given).values

    monkeypatch.setattr(bridge, "steady_conduction", heat)
    monkeypatch.setattr(bridge, "find", lambda: bridge.Fenicsx("python", "a test", {}))


def disc():
    case = registry.get("disc-exponential")
    small = [
        replace(case.method(name), resolutions={Level.QUICK: (10,)})
        for name in ("fem/P1", "fem/P2")
    ]
    return replace(case, methods=tuple(small), checks=(), featured="fem/P2", poses=())


def test_its_answer_is_judged_and_its_own_times_are_taken(played):
    points, refused = precision.measure([disc()], Level.QUICK, repeats=4)
    assert refused == []
    assert [p.method for p in points] == ["fem/P1", "fem/P2", "fenicsx/P1", "fenicsx/P2"]
    theirs, ours = points[3], points[1]
    assert theirs.error == pytest.approx(1e-3, rel=0.1)  # it is a thousandth off, on purpose
    assert theirs.unknowns == ours.unknowns
    # A first pass of a second: three are enough, of 1 s, 2 s and 3 s, after one that counts not.
    assert (theirs.repeats, theirs.seconds, theirs.fast, theirs.slow) == (3, 2.0, 1.5, 2.5)
    assert theirs.compiling == 100.0
    assert theirs.memory == 5_000_000
    assert '--method "fenicsx/P2" --resolution 10' in theirs.command


def test_where_it_is_missing_the_study_says_so_and_goes_on(monkeypatch):
    monkeypatch.setattr(bridge, "find", lambda: None)
    said = []
    points, refused = precision.measure([disc()], Level.QUICK, repeats=3, listen=said.append)
    assert [p.method for p in points] == ["fem/P1", "fem/P2"]
    (line,) = refused
    assert line.startswith("Left out: 2 by FEniCSx")
    assert "pip install" in line
    assert line in said


def test_a_method_of_two_problems_is_no_point(played):
    linear = disc().method("fem/P1")

    def both(n):
        linear.run(n)
        return linear.run(n)

    with pytest.raises(ValueError, match="solves 2 problems"):
        by_fenicsx.ByFenicsx(replace(linear, run=both))(10)


def test_every_case_of_the_study_has_it():
    for case in registry.select([precision.TAG]):
        names = {m.name for m in precision.methods_of(case)}
        assert {name.replace("fem/P2", "fenicsx/P2") for name in names if "fem/P2" in name} <= names
        assert any(name.startswith(by_fenicsx.THEIRS) for name in names)
