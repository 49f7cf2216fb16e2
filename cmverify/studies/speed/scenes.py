"""The scenes on which speed is measured."""

from __future__ import annotations

from typing import Any

import numpy as np

from cmverify.cases.common import materials
from cmverify.cases.common.scenes import cracked_disc
from cmverify.cases.crack_tip import STIFFNESS, Problem
from solver import (
    ConductivityTensor,
    Crack,
    ElasticTensor,
    Load,
    Region,
    Scene,
    Support,
    disc,
    polygon,
    rectangle,
)


def crack_tip(resolution: int) -> Scene:
    """The crack-tip problem, mode I, at spacing a/resolution."""
    field = Problem(1.0, 0.0)
    layer = Support.layer(cells=5.5, displacement=field.displacement, rotation=field.rotation)
    return cracked_disc(ElasticTensor(STIFFNESS), resolution, layer)


def kernel_scenes(resolution: int) -> dict[str, Scene]:
    """Elasticity with rotations, without, and conduction on the same disc."""
    held = {"cells": 5.5}
    central = ElasticTensor.isotropic(1.0, 1 / 3)
    conductor = ConductivityTensor([[5, 2], [2, 1]])
    region, spacing = disc(1.0), 1.0 / resolution
    return {
        "elastic, 3 unknowns": crack_tip(resolution),
        "central, 2 unknowns": Scene(
            region, spacing, central, [Support.layer(**held, displacement=(0.0, 0.0))]
        ),
        "conductive, 1 unknown": Scene(
            region, spacing, conductor, [Support.layer(**held, temperature=0.0)]
        ),
    }


def static_scenes(resolution: int) -> dict[str, Scene]:
    """Static problems with holes, notches, cracks and supports of every kind, side length 2."""
    spacing = 1.0 / resolution
    tensor = ElasticTensor(STIFFNESS)
    square = rectangle(2.0, 2.0)
    hole, notch = disc(0.4), polygon([(-1.1, 0.08), (-0.4, 0.0), (-1.1, -0.08)])
    arc = [(0.5 * np.cos(t), 0.5 * np.sin(t)) for t in np.linspace(0.3, 2.6, 24)]
    clamped = Support.where(lambda x, y: y < -0.9, displacement=(0.0, 0.0), rotation=0.0)
    pulled = Load.traction((0.0, 1.0), (-1.0, 1.0), (1.0, 1.0))
    rollers = [
        Support.where(lambda x, y: y < -1.0 + 1.01 * spacing, u2=0.0),
        Support.where(lambda x, y: x < -1.0 + 1.01 * spacing, u1=0.0),
    ]

    def plate(region: Region, **more: Any) -> Scene:
        material = more.pop("material", tensor)
        supports = more.pop("supports", [clamped])
        return Scene(region, spacing, material, supports, [pulled], **more)

    layer = Support.layer(cells=5.5, temperature=lambda x, y: np.exp(x - 2 * y) * np.cos(y))
    conductor = ConductivityTensor([[5, 2], [2, 1]])
    return {
        "crack tip": crack_tip(resolution),
        "plate, clamped and pulled": plate(square),
        "plate on rollers": plate(square, supports=rollers),
        "plate with a hole": plate(square - hole),
        "notched plate": plate(square - notch),
        "notched plate with a hole": plate(square - notch - disc(0.3, (0.4, 0.4))),
        "edge crack": plate(square, cracks=[Crack((-1.2, 0.0), (0.0, 0.0))]),
        "curved crack": plate(square, cracks=[Crack(*arc)]),
        "kinked crack beside a hole": plate(
            square - disc(0.25, (0.5, 0.3)), cracks=[Crack((-1.2, 0.0), (-0.2, 0.0), (0.2, 0.4))]
        ),
        "no surface treatment, hole": plate(square - hole, surface="none"),
        "silicon, hole": plate(square - hole, material=ElasticTensor(materials.TENSORS["silicon"])),
        "ν = 1/3 (no rotations), hole": plate(
            square - hole, material=ElasticTensor.isotropic(1.0, 1 / 3)
        ),
        "ν = 0.45 (indefinite), hole": plate(
            square - hole, material=ElasticTensor.isotropic(1.0, 0.45)
        ),
        "heat, ratio 34": Scene(disc(1.0), spacing, conductor, [layer], calibration="positive"),
        "carbon/epoxy at 30°, hole": plate(
            square - hole,
            material=ElasticTensor(materials.turned(materials.TENSORS["carbon/epoxy"], 30)),
            calibration="positive",
        ),
        "heat, ratio 1000": Scene(
            disc(1.0),
            spacing,
            ConductivityTensor(materials.conductivity(1000.0, 0.0)),
            [layer],
            calibration="positive",
        ),
        "heat, ratio 100 at π/8": Scene(
            disc(1.0),
            spacing,
            ConductivityTensor(materials.conductivity(100.0, np.pi / 8)),
            [layer],
            calibration="positive",
        ),
        "heat, isotropic": Scene(disc(1.0), spacing, ConductivityTensor.isotropic(1.0), [layer]),
    }
