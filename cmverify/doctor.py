"""`cmverify doctor`: is everything here that a run needs, and where is it?"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from dataclasses import dataclass

from cmverify.run import environment
from cmverify.run.threads import VARIABLES, available_cores


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
    from references.fem.mesh import MeshingUnavailableError, load_gmsh, missing_libraries

    missing = missing_libraries()
    try:
        gmsh = load_gmsh()
    except MeshingUnavailableError as error:
        return Finding("problem", "gmsh", str(error))
    if missing:  # it loads all the same, so another copy was found
        detail = f"gmsh {gmsh.__version__} loads; not found by name: {', '.join(missing)}"
        return Finding("note", "gmsh", detail)
    return Finding("ok", "gmsh", f"{gmsh.__version__} loads, all system libraries found")


def _fenicsx() -> Finding:
    from references.fenicsx import bridge

    try:
        found = bridge.find()
    except bridge.FenicsxError as error:
        return Finding("problem", "FEniCSx", str(error))
    if found is None:
        return Finding("note", "FEniCSx", f"the cross-check is skipped. {bridge.INSTALL}")
    return Finding("ok", "FEniCSx", str(found))
