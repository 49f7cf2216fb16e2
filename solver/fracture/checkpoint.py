"""Save a fracture run and go on from there with the same results to the last bit.

What is saved is all that decides how a run goes on: which bonds are gone, the last solution (the
next solve starts from it), and the preconditioner's coarse matrix with the bonds it was made for
(another one would need other iterations and end in other last bits), right-hand side included.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from contextlib import suppress
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy import sparse
from threadpoolctl import threadpool_limits

from ..errors import SceneError
from ..linear import Border, TwoLevel, method
from ..operators import BondOperator

if TYPE_CHECKING:
    from .growth import Growth

_BORDER = ("coupling", "stiffness", "force")
# What is hashed into the file to tell damage from content.
_DIGEST = "digest"


@cache
def code() -> str:
    """Hash of this package's sources and of the versions of the libraries that round for it.

    Other code would go on from the same state and end in other bits, and nobody would know
    which part of the run was made by which.
    """
    package = Path(__file__).parents[1]
    digest = hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
        digest.update(path.relative_to(package).as_posix().encode())
        digest.update(path.read_bytes())
    for library in ("numpy", "scipy", "numba"):
        try:
            digest.update(f"{library}={version(library)}".encode())
        except PackageNotFoundError:  # a copy that no installer knows
            digest.update(library.encode())
    return digest.hexdigest()


def fingerprint(run: Growth) -> str:
    """Hash of everything that decides the results of a run, the code included."""
    start, bonds = run.body.sound, run.bonds
    digest = hashlib.sha256()
    parts: list[Any] = [
        code(),
        start.lattice.mask,
        start.lattice.points[0],
        start.family.offsets,
        start.operator.blocks,
        start.prescribed,
        start.values,
        start.load,
        start.nodal_load,
        start.scene.surface,
        bonds.whole,
        bonds.critical,
        bonds.kept,
        run.programme,
        run.options,
        run.history.names,
    ]
    if start.constraints is not None:
        basis = start.constraints.basis
        parts += [start.constraints.slaves, basis.data, basis.indices, basis.indptr]
    if start.bonds.ended is not None:
        ended = start.bonds.ended
        parts += [ended.particle, ended.offset, ended.edge, ended.position, ended.length]
    for part in parts:
        _feed(digest, part)
    return digest.hexdigest()


def _feed(digest: Any, part: Any) -> None:
    if isinstance(part, np.ndarray):
        digest.update(f"{part.dtype}{part.shape}".encode())
        digest.update(np.ascontiguousarray(part).tobytes())
    else:
        digest.update(repr(part).encode())


def save(run: Growth, path: str | os.PathLike[str], mark: str) -> None:
    """Write the run to `path`; a kill at any moment leaves the old file or the new one.

    Raises
    ------
    SceneError
        If the file cannot be written (no such folder, no permission, no space).
    """
    body, ledger = run.body, run.ledger
    arrays: dict[str, Any] = {
        "fingerprint": mark,
        "factor": run.load_factor,
        "target": run.target,
        "resting": run.resting,
        "reason": run.reason,
        "breaks": run.bonds.broken.records,
        "steps": np.array(run.solves, dtype=np.int64).reshape(-1, 3),
        "history": run.history.array,
        "ledger": [
            ledger.work,
            ledger.dissipated,
            ledger.excess,
            ledger.deflection,
            ledger.whole,
        ],
        "aside": body.aside,
        "x": body.x,
        "rhs": np.zeros(0) if body.rhs is None else body.rhs,
        "masters": body.masters,
        "counters": [body.iterations, int(body.worn), body.built, int(run.precise)],
        "residual": [body.residual, body.seconds, body.pace],
    }
    if isinstance(body.preconditioner, TwoLevel):
        coarse = body.preconditioner.coarse
        arrays |= {
            "coarse_data": coarse.data,
            "coarse_indices": coarse.indices,
            "coarse_indptr": coarse.indptr,
            "coarse_cells": body.preconditioner.hats.coarsening,
        }
    if body.border is not None:
        arrays |= {f"border_{name}": getattr(body.border, name) for name in _BORDER}
    _write(path, arrays)


def load(run: Growth, path: str | os.PathLike[str], mark: str) -> bool:
    """Bring a fresh run to where the file left it; whether there was a file.

    Raises
    ------
    SceneError
        If the file belongs to another scene, toughness or programme, or is no checkpoint.
    """
    found = _read(path, mark)
    if found is None:
        return False
    # As every solve does: BLAS sums in another order with more threads, and the preconditioner
    # that is made here would differ in its last bits from the one that the run had.
    with threadpool_limits(limits=1, user_api="blas"):
        _restore(run, found)
    return True


def _restore(run: Growth, found: Mapping[str, Any]) -> None:
    body, bonds, ledger = run.body, run.bonds, run.ledger
    run.load_factor, run.target = float(found["factor"]), int(found["target"])
    run.resting, run.reason = bool(found["resting"]), str(found["reason"])
    bonds.broken.add(*(found["breaks"][name] for name in found["breaks"].dtype.names))
    run.solves += [(int(a), int(b), bool(c)) for a, b, c in found["steps"]]
    run.history.rows += found["history"].tolist()
    ledger.work, ledger.dissipated, ledger.excess, *rest = found["ledger"].tolist()
    ledger.deflection, ledger.whole = rest
    iterations, worn, built, precise = found["counters"].tolist()
    body.iterations, body.worn, run.precise = iterations, bool(worn), bool(precise)
    body.residual, body.seconds, body.pace = found["residual"].tolist()
    before = body.resume(found["aside"], built)
    if "coarse_data" in found:
        # The preconditioner belongs to the bonds there were when it was built.
        operator: BondOperator = method.positive(before, body.kind)
        parts = (found["coarse_data"], found["coarse_indices"], found["coarse_indptr"])
        coarse = sparse.csc_array(parts, shape=(len(parts[2]) - 1,) * 2)
        body.preconditioner = TwoLevel(operator, int(found["coarse_cells"]), coarse=coarse)
    body.x = found["x"]
    body.rhs = found["rhs"] if len(found["rhs"]) else None
    body.masters = found["masters"]
    if body.rhs is not None and "border_force" in found:
        body.border = Border(*(found[f"border_{name}"] for name in _BORDER))


def check(path: str | os.PathLike[str]) -> None:
    """Refuse a path that could not be written, before any work.

    Raises
    ------
    SceneError
        If its folder does not exist or takes no files, or it is a folder itself.
    """
    target = Path(path)
    if not target.name:
        raise SceneError(f"the checkpoint {path} names no file")
    partial = _partial(target)
    try:
        if target.is_dir():
            raise SceneError(f"the checkpoint {path} is a folder, not a file")
        if not target.parent.is_dir():
            raise SceneError(f"the checkpoint {path} lies in a folder that does not exist")
        partial.touch()
    except OSError as error:
        raise SceneError(f"the checkpoint {path} cannot be written: {error.strerror}") from error
    finally:
        _discard(partial)


def _digest(arrays: Mapping[str, Any]) -> str:
    digest = hashlib.sha256()
    for name in sorted(set(arrays) - {_DIGEST}):
        digest.update(name.encode())
        _feed(digest, np.asarray(arrays[name]))
    return digest.hexdigest()


def _partial(target: Path) -> Path:
    return target.with_name(f"{target.name}.{os.getpid()}.partial")


def _discard(path: Path) -> None:
    # What cannot be removed could not be made either: the first error is the one to tell.
    with suppress(OSError):
        path.unlink(missing_ok=True)


def _write(path: str | os.PathLike[str], arrays: Mapping[str, Any]) -> None:
    target = Path(path)
    partial = _partial(target)
    try:
        with open(partial, "wb") as file:
            np.savez(file, **{**arrays, _DIGEST: _digest(arrays)})
            file.flush()
            os.fsync(file.fileno())
        os.replace(partial, target)
    except OSError as error:
        raise SceneError(
            f"the checkpoint {path} cannot be written: {error.strerror or error}"
        ) from error
    finally:
        _discard(partial)


def _read(path: str | os.PathLike[str], mark: str) -> dict[str, Any] | None:
    check(path)
    if not Path(path).exists():
        return None
    try:
        with np.load(path, allow_pickle=False) as file:
            found = {name: file[name] for name in file.files}
    except Exception as error:
        # Whatever damaged bytes make zipfile, zlib and NumPy raise: a dozen kinds.
        said = " ".join(str(error).split()) or type(error).__name__
        raise SceneError(f"{path} is no checkpoint: {said}") from error
    if _DIGEST not in found or str(found[_DIGEST]) != _digest(found):
        raise SceneError(f"{path} is no checkpoint, or a damaged one: remove it")
    if str(found["fingerprint"]) != mark:
        raise SceneError(
            f"the checkpoint {path} belongs to another scene, toughness or programme, or was made "
            f"by other code: remove it or name another file"
        )
    return found
