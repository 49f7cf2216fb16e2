"""Who may know whom: solver and references know neither the harness nor each other."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = {"solver", "references", "cmverify"}


def imported(path: Path) -> set[str]:
    names = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            names.add(node.module.split(".")[0])
    return names


@pytest.mark.parametrize("package", ["solver", "references"])
def test_a_reference_shares_no_code_with_what_it_judges(package):
    modules = sorted((ROOT / package).rglob("*.py"))
    assert modules
    guilty = {str(m): found for m in modules if (found := imported(m) & (PACKAGES - {package}))}
    assert not guilty


def test_the_check_would_see_an_import(tmp_path):
    path = tmp_path / "module.py"
    path.write_text("def f():\n    from solver.scene import Scene\n")
    assert imported(path) == {"solver"}
