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
declared = list(project["dependencies"])
for extra in sys.argv[1:]:
    declared += project["optional-dependencies"][extra]
for requirement in declared:
    found = re.fullmatch(r"([\w.-]+)>=([\d.]+)", requirement)
    if not found:
        sys.exit(f"no lowest version in {requirement!r}")
    print(f"{found[1]}=={found[2]}")
