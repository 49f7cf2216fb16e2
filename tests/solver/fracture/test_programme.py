"""Where the load goes: to the event, to the next increment, never beyond the target."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import Programme, SceneError
from tests.solver.bodies import exact

factor = st.floats(0.01, 10.0)


@exact
@given(factor, factor)
def test_without_increments_the_load_goes_to_the_event(event, more):
    programme = Programme()
    assert programme.reach(event, event + more) == event
    assert programme.reach(event, event) == event


@exact
@given(factor, factor, st.floats(0.01, 1.0))
def test_increments_are_met_and_never_before_the_event(event, more, increment):
    reached = Programme(increment=increment).reach(event, event + more)
    assert event <= reached <= event + more
    steps = reached / increment
    # A factor just above an increment is that increment, to rounding: then it is the event.
    assert abs(steps - round(steps)) < 1e-6 or reached in (event, event + more)


@exact
@given(factor, st.floats(0.01, 0.5))
def test_overload_is_kept(event, overload):
    reached = Programme(overload=overload).reach(event, 100.0)
    assert (reached / event) ** 2 == pytest.approx(1 + overload)
    stepped = Programme(increment=1.0, overload=overload).reach(event, 100.0)
    assert event <= stepped
    assert (stepped / event) ** 2 <= 1 + overload + 1e-9


def test_targets():
    assert Programme(stop=3.0).targets == (3.0,)
    assert Programme(levels=[1, 0.5, 2]).targets == (1.0, 0.5, 2.0)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"start": -1.0}, "at least 0"),
        ({"start": 2.0, "stop": 1.0}, "before it starts"),
        ({"stop": 1.0, "levels": [1.0]}, "not both"),
        ({"increment": 0.0}, "increment must be positive"),
        ({"overload": -0.1}, "overload must be positive"),
        ({"levels": []}, "levels must be"),
        ({"levels": [1.0], "control": "following"}, "cannot follow"),
        ({"increment": 0.1, "control": "following"}, "no increments"),
        ({"control": "drifting"}, "'fixed' or 'following'"),
    ],
)
def test_programmes_that_are_none(settings, message):
    with pytest.raises(SceneError, match=message):
        Programme(**settings)
