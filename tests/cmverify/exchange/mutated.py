"""Scene files with something wrong in them: whole ones, a TOML writer, and what goes wrong."""

from __future__ import annotations

import copy
import json
import random
import tomllib
from typing import Any

WHOLE = {
    "inclusions": """
thickness = "0.2 + 0.01*x"
[discretisation]
spacing = 0.25
m = 2
[[region]]
shape = "rectangle"
width = 3.0
height = 2.0
[[region]]
shape = "disc"
radius = 0.4
centre = [0.9, 0.0]
operation = "subtract"
[material]
kind = "isotropic"
E = 1.0
nu = 0.2
[[inclusion]]
region = { shape = "rectangle", width = 1.0, height = 1.0, centre = [-0.75, 0.0] }
material = { kind = "isotropic", E = 5.0, nu = 0.25 }
[[support]]
where = "x < -1.3"
displacement = [0.0, 0.0]
[[load]]
kind = "body_force"
value = [1.0, 0.0]
""",
    "conduction": """
[discretisation]
spacing = 0.2
m = 2
calibration = "positive"
law = "cosine"
exponent = 4
[region]
shape = "disc"
radius = 1.0
centre = [0.0, 0.0]
[material]
kind = "conductivity"
tensor = [[3.0, 0.5], [0.5, 1.0]]
angle_degrees = 20
[[support]]
layer_cells = 2.5
temperature = "x**3/5 - x**2*y"
[[load]]
kind = "source"
value = "1 + x"
where = "y > 0"
[solve]
tolerance = 1e-8
""",
    "elasticity": """
title = "plate"
[discretisation]
spacing = 0.25
m = 2
surface = "extrapolated"
area_rule = "partial"
influence = "constant"
[region]
shape = "rectangle"
width = 3.0
height = 2.0
[material]
kind = "orthotropic"
E1 = 20e9
E2 = 10e9
G12 = 4e9
nu12 = 0.2
plane = "stress"
angle_degrees = 15
[[support]]
where = "x < -0.9"
displacement = [0.0, "0.1*y"]
rotation = 0.0
[[load]]
kind = "traction"
value = [0.0, -1e6]
start = [1.5, -1.0]
end = [1.5, 1.0]
[[crack]]
start = [0.1, 1.2]
end = [0.1, 0.1]
""",
    "fracture": """
[discretisation]
spacing = 0.5
m = 2
calibration = "lattice"
[region]
shape = "polygon"
vertices = [[-3.0, -2.0], [3.0, -2.0], [3.0, 2.0], [-3.0, 2.0]]
[material]
kind = "isotropic"
E = 20.0
nu = 0.2
[[support]]
where = "x < -2"
u2 = "sign(y)"
[[support]]
where = "x > 2"
displacement = [0.0, 0.0]
rotation = 0.0
[[crack]]
start = [-4.0, 0.0]
end = [-1.0, 0.0]
[fracture]
G1 = 1.0
G2 = 0.9
n = 2
control = "following"
no_fail = "x > 2"
max_solves = 4
""",
}

#: What is put in the place of a value.
VALUES: list[Any] = [
    0, 1, -1, 3, 500, 3000, 10**400, 0.0, 1e-320, 1e308, -1e308, float("nan"), float("inf"), True,
    "", "x", "x < 1", "stress", "x^2", "x < 1 and y < 2", "1/0", "9**9**9", "abs(x, x)",
    "maximum(x, y, -x)", "(-8)**(1/3)", "sqrt(x - 5)", "log(0*x)", "1j", "x.real", "(" * 300,
    "-" * 3000 + "x", "\x00", "é", "[/]", "{0}", [], [1.0], [[1.0]], [1.0, "x"], ["x", "1/0"],
    [0.0, 0.0, 0.0], [[1.0, 2.0], [2.0, 1.0]], [[]], {}, {"a": 1}, "positive", "extrapolated",
    [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]], 1e-3, 40, 1e30, 1e-30, 1e15,
]  # fmt: skip


_WORDS = [
    ["continuum", "lattice", "positive"],
    ["none", "volume", "extrapolated"],
    ["partial", "full", "exact"],
    ["constant", "conical", "gaussian"],
    ["cosine", "two-harmonic", "fourfold", "uniform-shear"],
    ["disc", "rectangle", "polygon"],
    ["conductivity", "elastic", "isotropic", "orthotropic"],
    ["stress", "strain"],
    ["body_force", "couple", "source", "traction", "stress", "flux"],
    ["fixed", "following"],
]
_FORMULAS = [
    "x", "0*x", "x < 0", "y >= 0.3", "(x < 0) * (y < 0)", "x < 99", "x > 99", "1/x", "sqrt(x)",
    "where(x > 0, sqrt(x), 0)", "exp(999*x)", "x*y", "abs(x) < 0.5",
]  # fmt: skip


def places(data: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Paths of all tables, keys and entries."""
    found = [path] if path else []
    items = data.items() if isinstance(data, dict) else []
    if isinstance(data, list):
        items = enumerate(data)
    for key, value in items:
        found += places(value, (*path, key))
    return found


def mutated(name: str, seed: int, times: int) -> str:
    """A whole file with some things changed, removed, renamed, doubled or cut."""
    chance = random.Random(seed)
    data = copy.deepcopy(tomllib.loads(WHOLE[name]))
    for _ in range(times):
        here = places(data)
        if not here:
            break
        *before, key = chance.choice(here)
        parent = data
        for part in before:
            parent = parent[part]
        kind = chance.randrange(8)
        value = parent[key]
        if chance.random() < 0.6 and isinstance(value, int | float | str):
            parent[key] = _likely(value, chance)
            continue
        if kind == 0:
            del parent[key]
        elif kind == 1 and isinstance(parent, dict):
            parent[f"{key}s"] = parent.pop(key)
        elif kind == 2 and isinstance(parent, dict):
            parent["width"] = chance.choice(VALUES)
        elif kind == 3 and isinstance(parent, list):
            parent.append(parent[key])
        else:
            parent[key] = copy.deepcopy(chance.choice(VALUES))
    text = dumped(data)
    if chance.random() < 0.15 and text:
        cut = chance.randrange(len(text))
        text = text[:cut] + chance.choice(["", '"', "[", "]", "=", "\n", "\x07"]) + text[cut + 1 :]
    return text


def _likely(value: Any, chance: random.Random) -> Any:
    """Another value that might stand there, so that the file comes further."""
    if isinstance(value, str):
        known = next((words for words in _WORDS if value in words), _FORMULAS)
        return chance.choice(known)
    value = max(min(value, 1e300), -1e300)  # whole numbers may be longer than that
    return chance.choice([0.0, -value, 0.3 * value, 3.0 * value, value + 1, 1e12 * value, value])


def dumped(data: dict[str, Any]) -> str:
    """TOML with inner tables inline, but for the tables and arrays of tables of scene files."""
    head, tables = [], []
    for key, value in data.items():
        many = isinstance(value, list) and value and all(isinstance(v, dict) for v in value)
        if isinstance(value, dict) or many:
            for table in value if many else [value]:
                bracket = f"[[{_key(key)}]]" if many else f"[{_key(key)}]"
                tables += [bracket, *(f"{_key(k)} = {_value(v)}" for k, v in table.items())]
        else:
            head.append(f"{_key(key)} = {_value(value)}")
    return "\n".join([*head, *tables]) + "\n"


def _key(key: Any) -> str:
    return json.dumps(str(key))


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(k)} = {_value(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    if isinstance(value, str):
        return json.dumps(value)
    return repr(value)
