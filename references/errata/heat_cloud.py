"""A cloud of particles that conduct: what the assembled sums of Sect. 4.1 must come to.

Potentials and their second derivatives are formed here pair by pair, without the matrices of the
paper; see `cloud` for the elastic ones.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from references.errata.cloud import cloud, ordered_pairs


@cache
def fields() -> dict[str, np.ndarray]:
    rng = np.random.default_rng(17)
    size = len(cloud().points)
    letters = ("rho", "cT", "om", "T", "rate", "dT")
    found = {name: rng.uniform(1, 2, size) for name in letters}
    k = rng.uniform(1, 2, (size, size))
    return found | {"k": k + k.T, "vol": cloud().volumes}


def pair_matrices(p: int, q: int) -> dict[str, Any]:
    data, length = fields(), float(np.hypot(*(cloud().points[q] - cloud().points[p])))
    return {
        "l": np.array([[-1.0, 1.0]]) / length,
        "D": data["k"][p, q],
        "L": np.array([[1.0], [0.0]]),
        "alpha": cloud().fractions[p, q],
        "dvp": data["vol"][p],
        "dvq": data["vol"][q],
        "z": data["T"][[p, q]],
        **{name: data[name][p] for name in ("rho", "cT", "om", "T")},
    }


def _given(function: Callable[..., Any], p: int, q: int) -> Any:
    pair, code = pair_matrices(p, q), function.__code__
    return function(*(pair[name] for name in code.co_varnames[: code.co_argcount]))


def assembled(function: Callable[..., Any], particles: bool = False) -> np.ndarray:
    """Sum over ordered pairs (or particles), one unknown a particle."""
    size = len(cloud().points)
    first = np.asarray(_given(function, 0, 1))
    vector = first.ndim == 1 or (particles and function.__code__.co_varnames[0] in ("om", "T"))
    total = np.zeros(size if vector else (size, size))
    todo = [(p, (p + 1) % size) for p in range(size)] if particles else ordered_pairs(size)
    for p, q in todo:
        part = np.asarray(_given(function, p, q))
        if particles:
            total[(p,) if vector else (p, p)] += float(part)
        elif part.ndim == 1:
            np.add.at(total, [p, q], part)
        else:
            total[np.ix_([p, q], [p, q] if part.shape[1] == 2 else [p])] += part
    return total


def potential(temperatures: np.ndarray) -> float:
    """Every unordered pair of the cloud once, k g^2/2."""
    data, total = fields(), 0.0
    for p in range(len(temperatures)):
        for q in range(p):
            length = np.hypot(*(cloud().points[q] - cloud().points[p]))
            slope = (temperatures[q] - temperatures[p]) / length
            weight = cloud().fractions[p, q] * data["vol"][p] * data["vol"][q]
            total += data["k"][p, q] * slope**2 / 2 * weight
    return float(total)


@cache
def conductance() -> np.ndarray:
    """Second derivative of the cloud's potential."""
    unit = np.eye(len(cloud().points))
    single = [potential(row) for row in unit]
    return np.array([[potential(a + b) - single[i] - single[j] for j, b in enumerate(unit)]
                     for i, a in enumerate(unit)])  # fmt: skip


def cloud_names() -> dict[str, Any]:
    data, size = fields(), len(cloud().points)
    return {
        **data,
        "sum": np.sum,
        "over_pairs": assembled,
        "over_particles": lambda f: assembled(f, particles=True),
        "pair_sums_over_2": lambda f: sum(_given(f, p, q) for p, q in ordered_pairs(size)) / 2,
        "neighbours": size - 1,
        "M": np.diag(data["rho"] * data["cT"] * data["vol"]),
        "K": conductance(),
        "p": data["om"] * data["vol"],
        "z": data["T"],
    }


def capacity() -> np.ndarray:
    data = fields()
    return np.diag(
        [r * c * v for r, c, v in zip(data["rho"], data["cT"], data["vol"], strict=True)]
    )


def sources() -> np.ndarray:
    data = fields()
    return np.array([w * v for w, v in zip(data["om"], data["vol"], strict=True)])


def changed(name: str) -> tuple[float]:
    """Change of sum T X dv when T changes by dT and X is kept."""
    data = fields()
    kept = capacity() @ data["rate"] if name == "capacity" else -sources()
    return (float((data["T"] + data["dT"]) @ kept - data["T"] @ kept),)


def balance() -> tuple[np.ndarray]:
    data, step = fields(), np.eye(len(cloud().points))
    slope = [(potential(data["T"] + e) - potential(data["T"] - e)) / 2 for e in step]
    return (capacity() @ data["rate"] + np.array(slope) - sources(),)
