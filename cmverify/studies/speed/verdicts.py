"""What the measured speeds must hold, as ratios and counts; never absolute times."""

from __future__ import annotations

from cmverify.judge.verdict import Verdict
from cmverify.studies.speed import peers
from cmverify.studies.speed.measure import Timing


def _verdict(what: str, measured: float, asked: str, passed: bool) -> Verdict:
    method, _, quantity = what.rpartition(": ")
    return Verdict("speed", method, quantity, "bound", "", measured, asked, bool(passed))


def _at_least(what: str, measured: float, bound: float) -> Verdict:
    return _verdict(what, measured, f"≥ {bound:g}", measured >= bound)


def _at_most(what: str, measured: float, bound: float) -> Verdict:
    return _verdict(what, measured, f"≤ {bound:g}", measured <= bound)


def of_kernel(rows: list[Timing]) -> list[Verdict]:
    """Five times SciPy's CSR product at a twentieth of its memory, 1.6 from two threads."""
    found = []
    for row in rows:
        if row.name.endswith("SciPy CSR"):
            kind = row.name.split(":")[0]
            found.append(_at_least(f"{kind}: CSR product time ÷ ours", row.values["slower"], 5.0))
            found.append(_at_least(f"{kind}: CSR memory ÷ ours", row.values["memory"], 20.0))
            found.append(_at_most(f"{kind}: difference from CSR", row.values["error"], 1e-13))
        elif row.values["threads"] == 2:
            kind = row.name.split(":")[0]
            gain = 1.0 / row.values["slower"]
            found.append(_at_least(f"{kind}: gain of two threads", gain, 1.6))
    return found


def of_solvers(rows: list[Timing]) -> list[Verdict]:
    """1/25 of the CPU seconds of SciPy CG in CSR, 1/30 of PARDISO, 1/15 of multigrid."""
    bounds = {"SciPy CG, block Jacobi, CSR": 25.0, "MKL PARDISO": 30.0}
    bounds |= dict.fromkeys(peers.PEERS, 15.0)
    return [
        _at_least(f"{row.name}: CPU seconds ÷ ours", row.values["slower"], bounds[row.name])
        for row in rows
        if row.name in bounds
    ]


def of_heat(rows: list[Timing]) -> list[Verdict]:
    """An eighth of the CPU seconds of PETSc's multigrid where every particle has one unknown."""
    return [
        _at_least(f"heat, {row.name}: CPU seconds ÷ ours", row.values["slower"], 8.0)
        for row in rows
        if row.name.startswith("PETSc")
    ]


def of_preconditioner(rows: list[Timing], ratios: bool = True) -> list[Verdict]:
    """Single precision costs no iteration, and double precision time (with `ratios`)."""
    single, double = (row.values for row in rows)
    most = double["iterations to 1e-12"]
    found = [
        _at_most("V-cycle: iterations in single precision", single["iterations to 1e-12"], most),
        _at_least("V-cycle: CPU seconds in double ÷ single precision", double["slower"], 1.15),
    ]
    return found if ratios else found[:1]


def of_modes(rows: list[Timing]) -> list[Verdict]:
    """1/30 of the CPU seconds of SciPy's shift and invert, and no mode missed or unconverged."""
    ours = rows[0].values
    found = [_at_most(f"{rows[0].name}: largest residual", ours["residual"], 1e-8)]
    found += [
        _at_least(f"{row.name}: CPU seconds ÷ ours", row.values["slower"], 30.0)
        for row in rows
        if row.name.endswith("SuperLU")
    ]
    return found


def of_accuracy(rows: list[Timing]) -> list[Verdict]:
    """Less time to one error than quadratic finite elements take, beyond the spread."""
    return [
        _at_least(f"{row.name}: CPU seconds to one error ÷ ours, lower quartile",
                  row.values["from"], 1.0)
        for row in rows[1:]
    ]  # fmt: skip


def of_growth(rows: list[Timing]) -> list[Verdict]:
    """Twelve iterations at every spacing; a million particles in 4 GB at 1.5 times the cost."""
    found = [_at_most(f"{row.name}: iterations", row.values["iterations"], 12) for row in rows]
    by_name = {row.name: row.values for row in rows}
    if "a/560" in by_name:
        largest, base = by_name["a/560"], by_name["a/120"]
        cost = largest["us_per_particle"] / base["us_per_particle"]
        found.append(_at_most("a/560: time per particle ÷ a/120's", cost, 1.5))
        found.append(_at_most("a/560: peak memory, GB", largest["peak_gb"], 4.0))
    return found


def of_scenes(rows: list[Timing]) -> list[Verdict]:
    """Iterations on other static scenes: twenty is the goal."""
    return [_at_most(f"{row.name}: iterations", row.values["iterations"], 20) for row in rows]


def of_surfaces(rows: list[Timing]) -> list[Verdict]:
    """At most 1.5 times the iterations; nothing at all where every edge is prescribed."""
    found = []
    for row in rows:
        if not row.name.endswith(": extrapolated"):
            continue
        more = row.values["iterations ÷ none"]
        found.append(_at_most(f"{row.name}: iterations ÷ those without", more, 1.5))
        if row.name.startswith("heat"):
            bytes_more = row.values["bytes ÷ none"]
            found.append(_at_most(f"{row.name}: memory ÷ that without", bytes_more, 1.0))
    return found
