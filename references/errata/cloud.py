"""A cloud of particles that are all neighbours: what assembled sums must come to.

Energies, their second derivatives and variations are formed here from Eqs. 1-4 of every unordered
pair, without the matrices of Sect. 2.1, so that these can be held against them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np

_SIZE = 5


@cache
def cloud() -> SimpleNamespace:
    rng = np.random.default_rng(5)
    k = rng.uniform(1, 2, (_SIZE, _SIZE, 3))
    alpha = rng.uniform(0.5, 1, (_SIZE, _SIZE))
    return SimpleNamespace(
        points=rng.uniform(0, 3, (_SIZE, 2)),
        volumes=rng.uniform(0.5, 1.5, _SIZE),
        moduli=k + k.transpose(1, 0, 2),
        fractions=alpha + alpha.T,
        inertia=rng.uniform(1, 2, (_SIZE, 3)),
        loads=rng.normal(size=(_SIZE, 3)),
        motion=rng.normal(size=(_SIZE, 3)),
        rate=rng.normal(size=(_SIZE, 3)),
        variation=rng.normal(size=(_SIZE, 3)),
    )


def ordered_pairs(size: int) -> Iterator[tuple[int, int]]:
    """(p, q) and (q, p) alike."""
    return ((p, q) for p in range(size) for q in range(size) if p != q)


def pair_matrices(p: int, q: int) -> dict[str, Any]:
    """Eqs. 27 and 29 with numbers, and what else an ordered pair has."""
    here = cloud()
    bond = here.points[q] - here.points[p]
    length = float(np.hypot(*bond))
    (c, s), half = bond / length, length / 2
    block = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1.0]])
    rows = [[-1, 0, 0, 1, 0, 0], [0, -1, -half, 0, 1, -half], [0, 0, -1, 0, 0, 1]]
    return {
        "R": np.kron(np.eye(2), block),
        "B": np.array(rows) / length,
        "D": np.diag(here.moduli[p, q]),
        "L": np.vstack([np.eye(3), np.zeros((3, 3))]),
        "P": np.diag(here.inertia[p]),
        "xi": length,
        "alpha": here.fractions[p, q],
        "dvp": here.volumes[p],
        "dvq": here.volumes[q],
        "b": here.loads[p],
        "vp": here.motion[p],
        "a": here.rate[p],
        "v": np.concatenate([here.motion[p], here.motion[q]]),
    }


def _given(function: Callable[..., Any], p: int, q: int) -> Any:
    pair = pair_matrices(p, q)
    code = function.__code__
    return function(*(pair[name] for name in code.co_varnames[: code.co_argcount]))


def assembled(function: Callable[..., Any], particles: bool = False) -> np.ndarray:
    """Sum over ordered pairs (or particles): rows of both particles, columns as wide as it has."""
    size = 3 * _SIZE
    first = np.asarray(_given(function, 0, 1))
    total = np.zeros(size if first.ndim == 1 else (size, size))
    todo = [(p, p - 1) for p in range(_SIZE)] if particles else list(ordered_pairs(_SIZE))
    for p, q in todo:
        own, other = np.arange(3 * p, 3 * p + 3), np.arange(3 * (q % _SIZE), 3 * (q % _SIZE) + 3)
        part = np.asarray(_given(function, p, q % _SIZE))
        both = np.concatenate([own, other])
        rows = own if particles else both
        if part.ndim == 1:
            np.add.at(total, rows, part)
        else:
            total[np.ix_(rows, both if part.shape[1] == 6 else own)] += part
    return total


@cache
def energy_hessian() -> np.ndarray:
    """Of the cloud's energy, from Eqs. 1-4 of every unordered pair, by finite polarisation."""
    size = 3 * _SIZE
    unit = np.eye(size)
    single = [cloud_energy(row) for row in unit]
    hessian = np.empty((size, size))
    for i in range(size):
        for j in range(size):
            hessian[i, j] = cloud_energy(unit[i] + unit[j]) - single[i] - single[j]
    return hessian


def cloud_energy(motion: np.ndarray) -> float:
    """Energy of the cloud: every unordered pair once."""
    here, total = cloud(), 0.0
    u = np.reshape(motion, (-1, 3))
    for p in range(_SIZE):
        for q in range(p):
            bond = here.points[q] - here.points[p]
            length = np.hypot(*bond)
            n = bond / length
            eta = u[q, :2] - u[p, :2]
            strains = (
                eta @ n / length,
                (eta[1] * n[0] - eta[0] * n[1]) / length - (u[p, 2] + u[q, 2]) / 2,
                (u[q, 2] - u[p, 2]) / length,
            )
            stored = length / 2 * here.moduli[p, q] @ np.square(strains)
            total += stored * here.fractions[p, q] * here.volumes[p] * here.volumes[q]
    return float(total)


def cloud_names() -> dict[str, Any]:
    here = cloud()
    repeated = np.repeat(here.volumes, 3)

    def halved(function: Callable[..., Any]) -> float:
        return sum(_given(function, p, q) for p, q in ordered_pairs(_SIZE)) / 2

    def over_time(function: Callable[..., Any]) -> float:
        """Sum over particles, integral over time 0..1 with variations t (1 - t)."""
        weight = 1 / 6
        return weight * sum(
            function(here.variation[p], np.diag(here.inertia[p]), here.rate[p], here.loads[p],
                     here.volumes[p]) for p in range(_SIZE)
        )  # fmt: skip

    return {
        "over_pairs": assembled,
        "over_particles": lambda f: assembled(f, particles=True),
        "pair_sums_over_2": halved,
        "over_time": over_time,
        "neighbours": _SIZE - 1,
        "M": np.diag(here.inertia.ravel() * repeated),
        "K": energy_hessian(),
        "p": (here.loads * here.volumes[:, None]).ravel(),
        "v": here.motion.ravel(),
        "a": here.rate.ravel(),
    }


def mass() -> np.ndarray:
    """Second derivative of the kinetic energy, particle by particle."""
    here = cloud()
    return np.diag((here.inertia * here.volumes[:, None]).ravel())


def loads() -> np.ndarray:
    here = cloud()
    return np.concatenate([vol * load for vol, load in zip(here.volumes, here.loads, strict=True)])


def kinetic_variation() -> tuple[float]:
    """int of d(variation)/dt . P . velocity: motion with acceleration a, variation v t (1 - t)."""
    here, (node, weight) = cloud(), np.polynomial.legendre.leggauss(4)
    total = 0.0
    for t, w in zip((node + 1) / 2, weight / 2, strict=True):
        for p in range(_SIZE):
            velocity = here.motion[p] + t * here.rate[p]
            virtual = (1 - 2 * t) * here.variation[p]
            total += w * virtual @ (here.inertia[p] * velocity) * here.volumes[p]
    return (float(total),)


def load_variation() -> tuple[float]:
    here = cloud()
    work = np.einsum("pi,pi,p->", here.variation, here.loads, here.volumes)
    return (-float(work) / 6,)


def equation_of_motion() -> tuple[np.ndarray]:
    """Gradient of the energies (kinetic, stored, of the loads) at a motion and acceleration."""
    here, step = cloud(), np.eye(3 * _SIZE)
    motion = here.motion.ravel()
    stored = np.array([(cloud_energy(motion + e) - cloud_energy(motion - e)) / 2 for e in step])
    return (mass() @ here.rate.ravel() + stored - loads(),)
