"""Faults of the judges themselves: norms, orders, extrapolation, and what cases measure with."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from cmverify.faults.changes import result, scaled
from cmverify.faults.fault import Fault

J, C = "cmverify.judge", "cmverify.cases.common"
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
)


def _series(right: Function) -> Function:
    import dataclasses

    def wrong(*args: Any, **kwargs: Any) -> Any:
        found = right(*args, **kwargs)
        return dataclasses.replace(found, KI=1.01 * found.KI, KII=1.01 * found.KII)

    return wrong
