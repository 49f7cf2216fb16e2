"""Derivatives by differences, and what any elastic field satisfies."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from cmverify.case import Array
from cmverify.cases.common import materials
from cmverify.judge.norms import relative_l2

STEP = 1e-3  # of the differences; their error is some 1e-12 of the fourth derivative
SEED = 2022
TENSOR = materials.TENSORS["fully anisotropic"] / 100.0
CONDUCTIVITY = np.array([[5.0, 2.0], [2.0, 1.0]])  # Eq. 168
Field = Callable[[Array, Array], Array]


def slopes(function: Field, x: Array, y: Array, step: float = STEP) -> Array:
    """∂f/∂x and ∂f/∂y along a new last axis, by differences of fourth order."""

    def along(dx: float, dy: float) -> Array:
        near = function(x + dx, y + dy) - function(x - dx, y - dy)
        far = function(x + 2 * dx, y + 2 * dy) - function(x - 2 * dx, y - 2 * dy)
        return np.asarray((8 * near - far) / (12 * step))

    return np.stack([along(step, 0.0), along(0.0, step)], axis=-1)


def elastic_identities(
    voigt: Array, displacement: Field, stress: Field, x: Array, y: Array
) -> dict[str, float]:
    """Hooke's law between displacement and stress, and balance of the stress, relative."""
    du = slopes(displacement, x, y)
    strain = np.stack([du[..., 0, 0], du[..., 1, 1], du[..., 0, 1] + du[..., 1, 0]], axis=-1)
    ds = slopes(stress, x, y)
    force = np.stack([ds[..., 0, 0] + ds[..., 2, 1], ds[..., 2, 0] + ds[..., 1, 1]], axis=-1)
    return {
        "Hooke": relative_l2(stress(x, y), strain @ voigt),
        "balance": float(np.linalg.norm(force) / np.linalg.norm(ds)),
    }


def around(radius: float = 0.5, count: int = 40) -> tuple[Array, Array]:
    """Points on a circle, none of them on the negative axis 1."""
    angle = -np.pi + (np.arange(count) + 0.5) * 2 * np.pi / count
    return radius * np.cos(angle), radius * np.sin(angle)
