"""Save a fracture run and go on from there with the same results to the last bit.

What is saved is all that decides how a run goes on: which bonds are gone, the last solution (the
next solve starts from it), and the preconditioner's coarse matrix with the bonds it was made for
(another one would need other iterations and end in other last bits), right-hand side included.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy import sparse

from .. import state_file
from ..blas import one_thread
from ..linear import Border, TwoLevel, method
from ..linear.two_level import for_many
from ..operators import BondOperator
from ..state_file import StateFile

if TYPE_CHECKING:
    from .growth import Growth

_BORDER = ("coupling", "stiffness", "force")


def fingerprint(run: Growth) -> str:
    """Hash of everything that decides the results of a run, the code included."""
    start, bonds = run.body.sound, run.bonds
    parts: dict[str, Any] = {
        "mask": start.lattice.mask,
        "corner": start.lattice.points[0],
        "offsets": start.family.offsets,
        "blocks": start.operator.blocks,
        "prescribed": start.prescribed,
        "values": start.values,
        "load": start.load,
        "nodal": start.nodal_load,
        "surface": start.scene.surface,
        "free": bonds.free,
        "whole": bonds.whole,
        "critical": bonds.critical,
        "kept": bonds.kept,
        "programme": run.programme,
        "options": run.options,
        "history": run.history.names,
        **run.marks,
    }
    if start.constraints is not None:
        basis = start.constraints.basis
        parts |= {
            "slaves": start.constraints.slaves,
            "basis": basis.data,
            "basis rows": basis.indices,
            "basis columns": basis.indptr,
        }
    if start.bonds.ended is not None:
        ended = start.bonds.ended
        names = ("particle", "offset", "edge", "position", "length")
        parts |= {f"ended {name}": getattr(ended, name) for name in names}
    return state_file.fingerprint(**parts)


def save(run: Growth, path: str | os.PathLike[str], mark: str) -> None:
    """Write the run to `path`; a kill at any moment leaves the old file or the new one.

    Raises
    ------
    SceneError
        If the file cannot be written (no such folder, no permission, no space).
    """
    body, ledger = run.body, run.ledger
    arrays: dict[str, Any] = {
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
    StateFile(path, mark).save(arrays)


def load(run: Growth, path: str | os.PathLike[str], mark: str) -> bool:
    """Bring a fresh run to where the file left it; whether there was a file.

    Raises
    ------
    SceneError
        If the file belongs to another scene, toughness or programme, or is no checkpoint.
    """
    found = StateFile(path, mark).load()
    if found is None:
        return False
    # As every solve does: BLAS sums in another order with more threads, and the preconditioner
    # that is made here would differ in its last bits from the one that the run had.
    with one_thread():
        _restore(run, found)
    return True


def _restore(run: Growth, found: Mapping[str, Any]) -> None:
    body, bonds, ledger = run.body, run.bonds, run.ledger
    run.load_factor, run.target = float(found["factor"]), int(found["target"])
    run.resting, run.reason = bool(found["resting"]), str(found["reason"])
    bonds.broken.add(*(found["breaks"][name] for name in found["breaks"].dtype.names))
    run.arrive()
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
        body.preconditioner = for_many(operator, int(found["coarse_cells"]), coarse)
    body.x = found["x"]
    body.rhs = found["rhs"] if len(found["rhs"]) else None
    body.masters = found["masters"]
    if body.rhs is not None and "border_force" in found:
        body.border = Border(*(found[f"border_{name}"] for name in _BORDER))
