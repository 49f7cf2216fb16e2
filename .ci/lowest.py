"""The lowest versions that pyproject.toml declares, one requirement a line.

Usage: python lowest.py [EXTRA]...
"""

import re
import sys
import tomllib
from pathlib import Path

project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text("utf-8"))[
    "project"
]


def extra(name: str) -> list[str]:
    """Requirements of an extra, those of the extras that it names itself among them."""
    found = []
    for requirement in project["optional-dependencies"][name]:
        inner = re.fullmatch(r"cmverify\[([\w-]+)\]", requirement)
        found += extra(inner[1]) if inner else [requirement]
    return found


declared = list(project["dependencies"])
for asked in sys.argv[1:]:
    declared += extra(asked)
for requirement in declared:
    found = re.fullmatch(r"([\w.-]+)>=([\d.]+)(\s*;.*)?", requirement)
    if not found:
        sys.exit(f"no lowest version in {requirement!r}")
    print(f"{found[1]}=={found[2]}{found[3] or ''}")
