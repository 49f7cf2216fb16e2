"""`cmverify doctor`: is everything here that a run needs, and where is it?"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass

from cmverify import environment
from cmverify.threads import VARIABLES, available_cores


@dataclass(frozen=True)
class Finding:
    """One line of the diagnosis: "ok", "note" (something optional is missing) or "problem"."""

    state: str
    subject: str
    detail: str


def examine() -> Iterator[Finding]:
    """Every finding, cheap ones first."""
    here = environment.describe()
    yield Finding("ok", "Python", f"{here.python} ({sys.executable})")
    yield Finding("ok", "machine", f"{here.processor}, {here.cores} cores, {here.memory_gb} GB")
    for name, found in here.versions.items():
        state = "problem" if found == "not installed" else "ok"
        yield Finding(state, name, found)
    yield from _threads()
    yield _cache()
    yield _gmsh()
    yield _fenicsx()


def _threads() -> Iterator[Finding]:
    given = {name: os.environ[name] for name in VARIABLES if name in os.environ}
    detail = f"{available_cores()} usable cores"
    if given:
        limits = ", ".join(f"{k}={v}" for k, v in given.items())
        detail += f"; set in the environment: {limits} (workers set their own)"
    yield Finding("ok", "threads", detail)


def _cache() -> Finding:
    folder, writable = environment.numba_cache()
    if writable:
        return Finding("ok", "Numba cache", str(folder))
    hint = "every process will compile anew; set NUMBA_CACHE_DIR to a folder you may write to"
    return Finding("problem", "Numba cache", f"{folder} is not writable: {hint}")


def _gmsh() -> Finding:
    missing = environment.missing_gmsh_libraries()
    if missing:
        packages = " ".join(missing.values())
        detail = f"missing {', '.join(missing)}; on Debian: apt-get install {packages}"
        return Finding("problem", "gmsh libraries", detail)
    try:
        import gmsh
    except (ImportError, OSError) as error:
        return Finding("problem", "gmsh", f"cannot be loaded: {error}")
    return Finding("ok", "gmsh libraries", f"all found; gmsh {gmsh.__version__} loads")


def _fenicsx() -> Finding:
    """Look for dolfinx the way the cross-check does: named, this, or the system's interpreter."""
    probe = (
        "import importlib.util as u\n"
        "if u.find_spec('dolfinx_solver'):\n import dolfinx_solver\n"
        "import dolfinx; print(dolfinx.__version__)"
    )
    named = os.environ.get("CMVERIFY_FENICSX_PYTHON")
    candidates = [named, sys.executable, "/usr/bin/python3"]
    clean = {"PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV", "LD_LIBRARY_PATH"}
    outside = {k: v for k, v in os.environ.items() if k not in clean}
    for python in filter(None, candidates):
        if shutil.which(python) is None:
            continue
        try:
            found = subprocess.run(
                [python, "-c", probe], capture_output=True, text=True, timeout=120, env=outside
            )
        except (OSError, subprocess.TimeoutExpired):
            continue
        if found.returncode == 0:
            return Finding("ok", "FEniCSx", f"dolfinx {found.stdout.strip()} in {python}")
    detail = (
        "not found: its cross-check is skipped. Install with: pip install 'cmverify[fenicsx]' "
        "(Python 3.12 or later), or apt-get install python3-dolfinx, or point "
        "CMVERIFY_FENICSX_PYTHON at an interpreter that has it"
    )
    return Finding("note", "FEniCSx", detail)
