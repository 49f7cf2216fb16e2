"""Faults of the judges themselves: norms, orders, extrapolation, what cases measure with.

What carries answers of other programs to the points at which they are judged is a judge too.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from cmverify.faults.changes import argument, result, scaled
from cmverify.faults.fault import Fault

J, C, X = "cmverify.judge", "cmverify.cases.common", "cmverify.exchange"
Function = Callable[..., Any]


def _nan_passes(right: Function) -> Function:
    return lambda values: float(np.nanmax(np.fromiter(values, dtype=float)))


FAULTS = (
    Fault("every error reported as zero", f"{J}.norms.relative_l2", scaled(0.0), "norms"),
    Fault("every error halved", f"{J}.norms.relative_l2", scaled(0.5), "norms"),
    Fault("every error + 1 %", f"{J}.norms.relative_l2", scaled(1.01), "norms"),
    Fault("the worst of errors passes over NaN", f"{J}.norms.worst", _nan_passes, "norms"),
    Fault("the worst of errors + 1 %", f"{J}.norms.worst", scaled(1.01), "norms"),
    Fault(
        "observed orders + 1",
        f"{J}.convergence.observed_orders",
        result(lambda p: p + 1.0),
        "orders",
    ),
    Fault("observed orders doubled", f"{J}.convergence.observed_orders", scaled(2.0), "orders"),
    Fault(
        "energies of waves of the other sign",
        f"{C}.bond_energies.energy_of_wave",
        scaled(-1.0),
        "judges",
    ),
    Fault(
        "energies of strains + 1 %", f"{C}.bond_energies.energy_of_strain", scaled(1.01), "judges"
    ),
    Fault(
        "no non-negative moduli ever",
        f"{C}.bond_energies.non_negative_moduli_exist",
        result(lambda found: False),
        "judges",
    ),
    Fault(
        "intensities by series + 1 %", f"{C}.sif.fit_series", lambda right: _series(right), "judges"
    ),
    Fault("slopes between particles + 1 %", f"{C}.sif.local_gradient", scaled(1.01), "judges"),
    # ---- answers of other programs ------------------------------------------------------
    Fault("distances between lines + 1 %", f"{J}.norms.line_distance", scaled(1.01), "answers"),
    Fault("largest deviations + 1 %", f"{J}.norms.largest_deviation", scaled(1.01), "answers"),
    Fault(
        "rigid motions counted as errors",
        f"{J}.norms.without_rigid_motion",
        lambda right: lambda points, displacement: displacement,
        "answers",
    ),
    Fault(
        "answers taken from the nearest particle",
        f"{X}.carry._by_fit",
        lambda right: lambda answer, tree, wanted, values, cracks: values[tree.query(wanted)[1]],
        "answers",
    ),
    Fault(
        "answers carried across cracks", f"{X}.carry._by_fit", argument(4, lambda _: ()), "answers"
    ),
    Fault("answers on triangles + 1 %", f"{X}.carry._on_triangles", scaled(1.01), "answers"),
    Fault("answers in time + 1 %", f"{X}.carry._in_time", scaled(1.01), "answers"),
)


def _series(right: Function) -> Function:
    import dataclasses

    def wrong(*args: Any, **kwargs: Any) -> Any:
        found = right(*args, **kwargs)
        return dataclasses.replace(found, KI=1.01 * found.KI, KII=1.01 * found.KII)

    return wrong
