"""Who may know whom, and what an import may do: read from the source, so that nothing runs."""

import ast
import subprocess
import sys
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("solver", "references", "cmverify")
# A reference that shared code with what it judges would prove nothing.
ALLOWED = {"solver": set(), "references": set(), "cmverify": {"solver", "references"}}
SOURCES = [path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))]


def imported(source: str, package: str) -> set[str]:
    """Top-level packages that a module imports anywhere, lazily in a function too."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found.add(package if node.level else str(node.module).split(".")[0])
        elif isinstance(node, ast.Call):
            name = getattr(node.func, "attr", getattr(node.func, "id", ""))
            if name in ("import_module", "__import__") and node.args:
                argument = node.args[0]
                if isinstance(argument, ast.Constant) and isinstance(argument.value, str):
                    found.add(argument.value.split(".")[0])
    return found


def strangers(source: str, package: str) -> set[str]:
    """Packages of the project that a module of `package` imports and must not know."""
    return (imported(source, package) & set(PACKAGES)) - {package} - ALLOWED[package]


def test_there_is_something_to_look_at():
    assert {path.relative_to(ROOT).parts[0] for path in SOURCES} == set(PACKAGES)


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: str(p.relative_to(ROOT)))
def test_packages_know_whom_they_may(path):
    package = path.relative_to(ROOT).parts[0]
    assert not strangers(path.read_text(encoding="utf-8"), package)


@pytest.mark.parametrize(
    ("package", "source"),
    [
        ("solver", "import references.analytic"),
        ("solver", "def late():\n    from cmverify import case"),
        ("references", "from solver.material.tensors import ElasticTensor"),
        ("references", "import importlib\nimportlib.import_module('solver')"),
    ],
)
def test_a_forbidden_import_is_seen(package, source):
    assert strangers(source, package)
    assert not strangers(source, "cmverify")


def imported_modules(path: Path, known: set[str]) -> set[str]:
    """Modules of the project that a module imports, anywhere in it."""
    parts = list(path.relative_to(ROOT).with_suffix("").parts)
    here = parts[:-1]
    me = ".".join(here if parts[-1] == "__init__" else parts)
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = here[: len(here) - node.level + 1] if node.level else []
            module = ".".join([*base, *([node.module] if node.module else [])])
            names = {f"{module}.{alias.name}" for alias in node.names}
            found |= names if names <= known else names | {module}
    return (found & known) - {me}


def circle(imports: dict[str, set[str]]) -> list[str]:
    """Modules that import each other in a circle, in order; empty if none do."""
    try:
        list(TopologicalSorter(imports).static_order())
    except CycleError as error:
        return list(error.args[1])
    return []


@pytest.mark.parametrize("package", PACKAGES)
def test_nothing_imports_in_circles(package):
    modules: dict[str, Path] = {}
    for path in sorted((ROOT / package).rglob("*.py")):
        name = ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
        modules[name] = path
    known = set(modules)
    assert not circle({name: imported_modules(path, known) for name, path in modules.items()})


def test_a_circle_is_seen():
    assert circle({"a": {"b"}, "b": {"c"}, "c": {"a"}})
    assert not circle({"a": {"b"}, "b": {"c"}, "c": set()})


# Settings that have to precede an import, and commands that a program collects.
SETTINGS = ("setattr", "os.environ.", "matplotlib.use", "app.")


def actions(source: str) -> list[str]:
    """Statements of a module that do more than define, import or set."""
    found = []
    for node in ast.parse(source).body:
        inner = node.body if isinstance(node, (ast.With, ast.Try, ast.If)) else [node]
        guarded = isinstance(node, ast.If) and "__main__" in ast.unparse(node.test)
        for statement in [] if guarded else inner:
            if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call):
                if not ast.unparse(statement.value.func).startswith(SETTINGS):
                    found.append(ast.unparse(statement))
            elif isinstance(statement, (ast.For, ast.While, ast.With)):
                found.append(ast.unparse(statement))
    return found


@pytest.mark.parametrize(
    "path",
    [path for path in SOURCES if path.name != "__main__.py"],
    ids=lambda p: str(p.relative_to(ROOT)),
)
def test_modules_do_nothing_when_imported(path):
    assert not actions(path.read_text(encoding="utf-8"))


def test_a_run_at_import_is_seen():
    assert actions("import numpy as np\nsolve(np.ones(3))") == ["solve(np.ones(3))"]
    assert actions("for m in (3, 5):\n    warm_up(m)")
    assert actions("try:\n    product(grid)\nexcept ValueError:\n    pass")
    assert not actions("if __name__ == '__main__':\n    main()")


def run(code: str) -> str:
    """Run Python in a fresh interpreter from the root of the project."""
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return done.stdout


def test_importing_the_solver_compiles_nothing_and_loads_no_other_package():
    out = run(
        "import sys, solver, solver.analyses.statics, solver.operators.kernels as k\n"
        "print([n for n in ('references', 'cmverify', 'gmsh', 'skfem', 'matplotlib', 'sympy',"
        " 'scipy.integrate')"
        " if n in sys.modules])\n"
        "print(sum(len(f.signatures) for f in vars(k).values() if hasattr(f, 'py_func')))\n"
        "print(sum(hasattr(f, 'py_func') for f in vars(k).values()))\n"
    )
    loaded, compiled, kernels = out.splitlines()
    assert loaded == "[]"
    assert compiled == "0"
    assert int(kernels) >= 3


def test_importing_the_harness_is_light():
    # The solver, gmsh and the plotting library are for the commands that need them.
    out = run(
        "import sys, cmverify.cli\n"
        "print([n for n in ('gmsh', 'matplotlib', 'dolfinx') if n in sys.modules])"
    )
    assert out.strip() == "[]"
