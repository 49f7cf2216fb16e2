"""Summaries in words: no name runs into its number, and quantities have their units."""

from hypothesis import given, settings
from hypothesis import strategies as st

from cmverify.exchange.told import PLATES, UNITS, lines

names = st.text("abc_ ", min_size=1, max_size=40).filter(str.strip)


@settings(derandomize=True, deadline=None, max_examples=30)
@given(st.dictionaries(names, st.floats(1e-9, 1e9), min_size=1, max_size=6))
def test_numbers_stand_apart_and_below_each_other(said):
    found = lines(said, False)
    shown = {name.replace("_", " "): value for name, value in said.items()}
    width = 2 + max(map(len, shown))
    assert len(found) == len(shown)
    for line, (name, value) in zip(found, shown.items(), strict=True):
        assert line[:width].rstrip() == name.rstrip()
        assert line[:width][-2:] == "  "
        assert line[width:].split()[0] == f"{value:.5g}"


def test_units_are_those_of_bodies_with_and_without_a_thickness():
    said = {"frequencies": [1.0, 2.5], "mass": 2.0, "warnings": ("no",), "peak_memory": 2**21}
    said |= {
        "unstrained resistance": 1.5,
        "setup_seconds": 0.25,
        "particles": 12,
        "kind": "positive",
    }
    assert [line.split("  ")[-1].strip() for line in lines(said, False)] == [
        "1, 2.5 rad/s", "2 kg/m", "2 MiB", "1.5 Ω m", "0.25 s", "12", "positive",
    ]  # fmt: skip
    assert "2 kg" in [line.split("  ")[-1].strip() for line in lines(said, True)]
    assert not set(UNITS) & set(PLATES)
