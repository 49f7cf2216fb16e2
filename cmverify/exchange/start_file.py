"""Commented files to start from: one for each analysis, its optional keys as comments."""

from __future__ import annotations

import re
import tomllib
from typing import Any

from cmverify.exchange import schema

_PLATE = """
[discretisation]
spacing = 0.1
m = 3
surface = "extrapolated"
[region]
shape = "rectangle"
width = 2.0
height = 1.0
"""
_SOLID = """
[material]
kind = "isotropic"
E = 1.0e9
nu = 0.2
density = 1000.0
"""
_ORTHOTROPIC = """
[material]
kind = "orthotropic"
E1 = 20.0e9
E2 = 10.0e9
G12 = 4.0e9
nu12 = 0.2
"""
_HELD = """
[[support]]
where = "x < -0.7"
displacement = [0.0, 0.0]
rotation = 0.0
"""
_PULLED = """
[[load]]
kind = "traction"
value = [1.0e6, 0.0]
start = [1.0, -0.5]
end = [1.0, 0.5]
"""
_OPENED = """
[[support]]
where = "x < -0.7"
u2 = "1e-4*sign(y)"
[[support]]
where = "x > 0.7"
displacement = [0.0, 0.0]
rotation = 0.0
[[crack]]
start = [-1.2, 0.0]
end = [-0.3, 0.0]
"""
_HOT = """
[material]
kind = "conductivity"
principal = [2.0, 1.0]
angle_degrees = 30.0
heat_capacity = 1.0e6
[[support]]
where = "x < -0.7"
temperature = 0.0
"""
_LEFT, _RIGHT = (
    f'region = {{ shape = "rectangle", width = 0.6, height = 0.6, centre = [{x}, 0.0] }}\n'
    for x in (-0.65, 0.65)
)

# Whole ends of the plate as leads: bodies of which the rim is known.
_ENDS = "\n".join(
    f'{lead} = {{ shape = "rectangle", width = 0.3, height = 1.0, centre = [{x}, 0.0] }}'
    for lead, x in (("plus", 0.85), ("minus", -0.85))
)

#: What a file is for, and the file without comments; analyses by their own names.
KINDS: dict[str, tuple[str, str]] = {
    "static": ("A plate that is held and pulled", _PLATE + _ORTHOTROPIC + _HELD + _PULLED),
    "conduction": (
        "Steady heat in an anisotropic plate",
        _PLATE + _HOT + '[[load]]\nkind = "source"\nvalue = 100.0\nwhere = "x > 0.5"\n',
    ),
    "electric": (
        "Current between two leads",
        _PLATE
        + '[material]\nkind = "electric"\nresistivities = [1.0, 2.0]\n'
        + f'[[support]]\nkind = "lead"\n{_LEFT}potential = 0.0\n'
        + f'[[support]]\nkind = "lead"\n{_RIGHT}'
        + f'[[load]]\nkind = "lead"\n{_RIGHT}value = 1.0\n',
    ),
    "inclusion": (
        "A plate with a hole and a stiff inclusion",
        _PLATE.replace("[region]", "[[region]]").replace("0.1", "0.05")
        + '[[region]]\nshape = "disc"\nradius = 0.2\ncentre = [0.4, 0.0]\noperation = "subtract"\n'
        + _SOLID
        + '[[inclusion]]\nregion = { shape = "disc", radius = 0.2, centre = [-0.4, 0.0] }\n'
        + 'material = { kind = "isotropic", E = 5.0e9, nu = 0.3 }\n'
        + _HELD
        + _PULLED,
    ),
    "modes": ("Natural modes of a free plate", _PLATE + _SOLID + "[modes]\ncount = 4\n"),
    "transient": (
        "A hot plate cools at one end",
        _PLATE + _HOT + "[transient]\ninitial = 100.0\ntimes = [1.0e4, 1.0e5]\n",
    ),
    "waves": (
        "A pulse runs through a free plate",
        _PLATE
        + _SOLID
        + '[waves]\nend = 5.0e-4\nvelocity = ["exp(-50*(x**2 + y**2))", 0.0]\n'
        + "times = [2.5e-4, 5.0e-4]\n",
    ),
    "fracture": (
        "A double cantilever is opened until its crack has grown",
        _PLATE
        + _ORTHOTROPIC
        + _OPENED
        + '[fracture]\nG1 = 100.0\nG2 = 80.0\ncontrol = "following"\nadvance = 0.1\n',
    ),
    "sensing": (
        "A crack grows, and a voltmeter tells",
        _PLATE
        + _ORTHOTROPIC
        + _OPENED
        + "[sensing]\nG1 = 100.0\nG2 = 80.0\nresistivities = [1.0e-3, 2.0e-3]\n"
        + 'lead_plus = "(x < -0.8) * (y > 0.2)"\nlead_minus = "(x < -0.8) * (y < -0.2)"\n'
        + 'probe_plus = "(x < -0.9) * (abs(y - 0.1) < 0.11)"\n'
        + 'probe_minus = "(x < -0.9) * (abs(y + 0.1) < 0.11)"\n'
        + 'control = "following"\nadvance = 0.1\n',
    ),
    "quench": (
        "Cracks run into a plate whose lower edge turns cold",
        # Temperatures strain whole bonds only while others break.
        _PLATE.replace('"extrapolated"', '"volume"')
        + _SOLID
        + '[[support]]\nwhere = "y > 0.4"\nu2 = 0.0\nrotation = 0.0\n\n'
        + '[[support]]\nwhere = "(y > 0.4) * (x < -0.9)"\nu1 = 0.0\n\n'
        + "[[crack]]\nstart = [-0.3, -0.6]\nend = [-0.3, -0.2]\n\n"
        + "[[crack]]\nstart = [0.3, -0.6]\nend = [0.3, -0.15]\n\n"
        + '[quench]\ncooled = "y < -0.49"\nchange = -50.0\ntimes = [200.0, 1000.0, 5000.0]\n'
        + "conductivities = [50.0, 50.0]\nexpansions = [1.0e-5, 1.0e-5]\n"
        + 'heat_capacity = 3.0e6\nG1 = 100.0\nno_fail = "y < -0.3"\n',
    ),
    "piezoresistive": (
        "The resistance of a bar that is pulled",
        _PLATE
        + _SOLID
        + _HELD
        + _PULLED
        + "[piezoresistive]\ngauge = 8.0\n"
        + _ENDS
        + "\n"
        + "resistivities = [2.0, 2.0]\n",
    ),
    "joule": (
        "A plate that a current heats and the heat strains",
        _PLATE
        + _SOLID
        + _HELD
        + "[joule]\n"
        + _ENDS
        + '\nsink = "abs(x) > 0.7"\nvoltage = 0.1\n'
        + "resistivities = [1.0e-3, 1.0e-3]\nconductivities = [1.0, 1.0]\n"
        + "expansions = [1.0e-5, 1.0e-5]\n",
    ),
    "thermoelastic": (
        "A bar that rings warms where it is compressed",
        # Deformational heating knows whole bonds only.
        _PLATE.replace('"extrapolated"', '"volume"')
        + _SOLID
        + _HELD
        + "[thermoelastic]\nconductivities = [50.0, 50.0]\nexpansions = [1.0e-5, 1.0e-5]\n"
        + "heat_capacity = 3.0e6\nreference = 300.0\nstep = 2.0e-5\nsteps = 20\n"
        + 'velocity = ["x + 0.7", 0.0]\n',
    ),
}
_WIDTH = 44


def text(kind: str) -> str:
    """The commented file of a kind.

    Raises
    ------
    KeyError
        If there is no such kind.
    """
    title, base = KINDS[kind]
    data = tomllib.loads(base)
    declared = schema.json_schema()
    lines = [
        f"# {title}. SI units. Solve it with: cmverify solve FILE.toml --out NAME",
        "# What is commented out may be said, too: keys with their defaults, or an example. All of",
        "# it is explained in docs/scene-files.md; cmverify schema --out scene.schema.json writes",
        "# what editors complete and check these files with.",
        f"title = {schema.toml(title)}",
    ]
    for name, value in data.items():
        header = f"[[{name}]]" if isinstance(value, list) else f"[{name}]"
        for k, table in enumerate(value if isinstance(value, list) else [value]):
            lines += ["", header, *_table(table, _declared(declared, name, table), k == 0)]
    lines += ["", *_more(data, declared)]
    return "\n".join(line.rstrip() for line in lines) + "\n"


def _declared(declared: dict[str, Any], name: str, given: dict[str, Any]) -> dict[str, Any]:
    """The schema of a table of this name and kind."""
    kinds = schema.definitions(declared["properties"][name])
    tables = [declared["$defs"][kind] for kind in kinds]
    for table in tables:
        tags = {k: v["const"] for k, v in table["properties"].items() if "const" in v}
        if all(given.get(key) == tag for key, tag in tags.items()):
            return dict(table)
    raise KeyError(name)


def _table(given: dict[str, Any], table: dict[str, Any], optional: bool = True) -> list[str]:
    """Lines of a table: what is given, and the other keys as comments."""
    known = {key.name: key for key in schema.keys(table)}
    lines = []
    for name, value in given.items():
        said = "" if "const" in table["properties"].get(name, {}) else _said(known.get(name))
        lines.append(_commented(f"{name} = {schema.toml(value)}", said))
    for name, key in known.items():
        if optional and name not in given:
            lines.append(_commented(f"# {name} = {key.example}", _said(key)))
    return lines


def _said(key: schema.Key | None) -> str:
    """What a key is, in a few words."""
    return "" if key is None else re.split(r"[.;] |[.;]$", key.meaning or key.kind)[0]


def _commented(line: str, said: str) -> str:
    return f"{line:<{_WIDTH}} # {said}" if said else line


def _more(data: dict[str, Any], declared: dict[str, Any]) -> list[str]:
    """Tables of every scene that the file does not have, as comments."""
    lines = []
    if "crack" not in data:
        lines += ["# [[crack]]", "# start = [-0.2, 0.0]", "# end = [0.2, 0.0]", ""]
    lines += ["# [output]", *_table({}, declared["$defs"]["Output"]), ""]
    line = {"name": "axis", "start": [-0.9, 0.0], "end": [0.9, 0.0]}
    inside = _table(line, declared["$defs"]["Line"])
    lines.append("# [[output.line]]")
    return lines + [row if row[0] == "#" else f"# {row}" for row in inside]
