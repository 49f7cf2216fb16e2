"""`cmverify doctor`: is everything here that a run needs, and where is it?"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cmverify
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
    yield from _packages()
    yield from _threads()
    yield _cache()
    yield _gmsh()
    yield _fenicsx()


def _packages() -> Iterator[Finding]:
    """Whose solver and references are imported, and who else has packages of these names."""
    from importlib.machinery import PathFinder
    from importlib.metadata import packages_distributions

    home = Path(cmverify.__file__).parents[1]
    owners = packages_distributions()
    for name in cmverify.SIBLINGS:
        ours = home / name
        if other := cmverify.foreign(name):
            detail = f"another package of that name was imported first, from {other}"
            yield Finding("problem", name, detail)
            continue
        if not (ours / "__init__.py").is_file():
            yield Finding("problem", name, f"{ours} is missing: install cmverify anew")
            continue
        others = sorted(set(owners.get(name, [])) - {"cmverify"})
        if others:
            detail = (
                f"{', '.join(others)} installs a package {name} too, and one may have overwritten "
                f"the other: remove it, or install cmverify into an environment of its own"
            )
            yield Finding("problem", name, detail)
            continue
        # What a script would get that does not import cmverify first: its own folder comes before.
        spec = PathFinder.find_spec(name, [os.getcwd(), *sys.path])
        found = list(spec.submodule_search_locations or [str(spec.origin)]) if spec else []
        if found and Path(str(found[0])).resolve() != ours.resolve():
            safe = "write 'from cmverify import Scene', or " if name == "solver" else ""
            detail = f"{ours}; scripts here would import {found[0]} instead: {safe}rename that"
            yield Finding("note", name, detail)
        else:
            yield Finding("ok", name, str(ours))


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
    where = f"{folder} is not writable" if folder else "no folder can be written to"
    hint = "every process compiles for a minute; set NUMBA_CACHE_DIR to a folder you may write to"
    return Finding("note", "Numba cache", f"{where}: {hint}")


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
