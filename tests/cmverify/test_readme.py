"""What the README and the pages beside it show works as it is written."""

import importlib.util
import re
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from cmverify.cases import registry
from cmverify.cli import app

ROOT = Path(__file__).parents[2]
PAGES = (
    "README.md",
    "docs/python.md",
    "docs/results.md",
    "docs/howto/dashboards.md",
    "docs/howto/scene_files.md",
)
TEXT = "\n".join((ROOT / page).read_text() for page in PAGES)
FIGURES = [
    (Path(page).parent / link)
    for page in PAGES
    for link in re.findall(r'src="([^"]+)"', (ROOT / page).read_text())
]


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", TEXT, re.DOTALL)


def test_the_scene_of_the_readme_is_solved():
    code, again = [block for block in blocks("python") if "solution.temperature" in block]
    assert code == again
    names: dict = {}
    exec(code, names)  # a coarser grid would be another scene: this one takes under a second
    x, y = names["solution"].points.T
    exact = x**3 / 5 - x**2 * y + x * y**2 + y**3 / 3
    assert abs(names["solution"].temperature - exact).max() < 1e-10


def test_the_plate_of_the_readme_is_pulled():
    (code,) = [block for block in blocks("python") if "surface_displacement" in block]
    names: dict = {}
    exec(code, names)
    points = names["solution"].surface_points
    moved = names["solution"].surface_displacement
    stress = names["recovery"].stress(names["solution"], rule="family")
    # Held at its left, it is longer on the right; the sides carry what the edge is pulled by.
    assert moved[points[:, 0].argmax(), 0] > 0
    sides = abs(names["solution"].points[:, 0]) > 0.49
    assert abs(stress[sides, 0, 0].mean() - 1) < 0.02


def test_the_bodies_of_the_readme_vibrate_and_warm_up():
    (code,) = [block for block in blocks("python") if "modes.solve" in block]
    names: dict = {}
    exec(code, names)
    assert names["found"].rigid == 3
    # Lamé's mode of a free square plate, ω = π/L √((C11 − C12)/ρ).
    exact = np.pi / 0.5 * (70e9 / 1.3 / 2700.0) ** 0.5
    assert abs(names["found"].frequencies / exact - 1).min() < 2e-3
    assert abs(names["warm"].statistics.balance) < 1e-10


def test_commands_of_the_readme_exist():
    lines = [line for block in blocks("sh") for line in block.splitlines()]
    found = {m[1] for line in lines if (m := re.match(r"(?:.*/)?cmverify (\w+)", line))}
    assert {"run", "list", "report", "solve", "doctor"} <= found
    for command in found:
        assert CliRunner().invoke(app, [command, "--help"]).exit_code == 0
    for name in re.findall(r"cmverify (?:run|precision) ([a-z][\w-]+)", "\n".join(lines)):
        assert registry.select([name])


@pytest.mark.parametrize("figure", FIGURES, ids=str)
def test_figures_are_there_and_small(figure):
    assert 0 < (ROOT / figure).stat().st_size < 300_000


def test_the_crack_of_the_readme_grows():
    (code,) = [block for block in blocks("python") if "fracture.grow" in block]
    names: dict = {}
    exec(code, names)
    run = names["run"]
    assert run.advance >= 6
    assert abs(run.history.imbalance).max() < 1e-6 * run.history.work.max()


def test_the_scene_files_of_the_pages_are_read(tmp_path):
    from cmverify.exchange.scene_file import request

    found = blocks("toml")
    assert found
    for number, text in enumerate(found):
        (tmp_path / f"{number}.toml").write_text(text)
        request(tmp_path / f"{number}.toml")


def test_extensions_of_the_documentation_hide_no_installed_module():
    """Their folder comes first on the path: one called `coverage` took Numba's away."""
    names = {path.stem for path in (ROOT / "docs").glob("*.py")} - {"conf"}
    assert names
    for name in names:
        assert importlib.util.find_spec(name) is None, f"docs/{name}.py hides a module"
