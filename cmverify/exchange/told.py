"""What a result's summary says, in words for a terminal: names, numbers and their units."""

from __future__ import annotations

from collections.abc import Mapping

#: Units of what a summary names; counts, shares and words have none.
UNITS = {
    "frequencies": "rad/s",
    "end": "s",
    "step": "s",
    "stable step": "s",
    "hottest": "K",
    "error": "K",
    "advance": "m",
    "tip": "m",
    "first drop": "V",
}
#: The same per unit thickness, and of a body that has one.
PLATES = {
    "mass": ("kg/m", "kg"),
    "supplied": ("W/m", "W"),
    "made": ("W/m", "W"),
    "removed": ("W/m", "W"),
    "work": ("J/m", "J"),
    "stored": ("J/m", "J"),
    "dissipated": ("J/m", "J"),
    "excess": ("J/m", "J"),
    "resistance": ("Ω m", "Ω"),
    "unstrained resistance": ("Ω m", "Ω"),
}


def lines(said: Mapping[str, object], thick: bool) -> list[str]:
    """A line for everything but the warnings.

    Parameters
    ----------
    said : mapping
        `Result.summary()`.
    thick : bool
        Whether the scene has a thickness.
    """
    shown = {name.replace("_", " "): said[name] for name in said if name != "warnings"}
    width = 2 + max((len(name) for name in shown), default=0)
    return [f"{name:<{width}}{_value(name, value, thick)}" for name, value in shown.items()]


def _value(name: str, value: object, thick: bool) -> str:
    if name == "peak memory" and isinstance(value, int | float):
        return f"{value / 2**20:.0f} MiB"
    if name.endswith(" seconds"):
        return f"{_plain(value)} s"
    unit = PLATES[name][thick] if name in PLATES else UNITS.get(name, "")
    return f"{_plain(value)} {unit}".rstrip()


def _plain(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.5g}"
    return ", ".join(map(_plain, value)) if isinstance(value, list | tuple) else str(value)
