"""What a figure depends on besides the code: versions, machine, threads."""

from __future__ import annotations

import os
import platform
import subprocess
from dataclasses import asdict, dataclass
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from cmverify.run.threads import available_cores

LIBRARIES = (
    "cmverify", "numpy", "scipy", "numba", "llvmlite", "scikit-fem", "gmsh", "shapely", "meshio",
    "matplotlib",
)  # fmt: skip


@dataclass(frozen=True)
class Environment:
    """Versions and machine of a run."""

    python: str
    system: str
    processor: str
    cores: int
    memory_gb: float
    versions: dict[str, str]
    commit: str

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return asdict(self)


def describe() -> Environment:
    """The environment of this process."""
    import psutil

    return Environment(
        python=f"{platform.python_implementation()} {platform.python_version()}",
        system=f"{platform.system()} {platform.release()} {platform.machine()}",
        processor=_processor(),
        cores=available_cores(),
        memory_gb=round(psutil.virtual_memory().total / 2**30, 1),
        versions={name: _version(name) for name in LIBRARIES},
        commit=_commit(),
    )


def numba_cache() -> tuple[Path | None, bool]:
    """Where Numba keeps the solver's compiled kernels, and whether it can write there.

    No folder if Numba has found none that it can write to: kernels are then compiled in memory.
    """
    from solver import compiled
    from solver.operators import kernels

    if compiled.in_memory:
        return None, False
    folder = Path(str(kernels.scatter.stats.cache_path))
    return folder, _writable(folder)


def _writable(folder: Path) -> bool:
    while not folder.exists() and folder != folder.parent:
        folder = folder.parent
    return os.access(folder, os.W_OK)


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def _processor() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text(errors="replace").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def _commit() -> str:
    """Short hash of the checkout this package runs from, "+" if it has changes.

    That of the checkout it was built from where it is installed; "" where neither is known.
    """
    here = Path(__file__).resolve().parents[2]
    if not (here / ".git").exists():
        return _built_from()
    try:
        command = ["git", "-C", str(here), "describe", "--always", "--dirty=+"]
        return subprocess.run(command, capture_output=True, text=True, timeout=10).stdout.strip()
    except (OSError, subprocess.TimeoutExpired):
        return ""


def _built_from() -> str:
    """Hash that the build wrote down; "" in a build from an archive."""
    try:
        commit = import_module("cmverify._version").commit_id
    except (ImportError, AttributeError):
        return ""
    return str(commit or "").removeprefix("g")
