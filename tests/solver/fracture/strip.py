"""A small cracked body that the tests of a growing one share."""

import numpy as np

from solver import Crack, ElasticTensor, Scene, Support, rectangle

N, M = 10, 2


def scene(**changes) -> Scene:
    """A square with an edge crack to its middle, pulled apart at top and bottom."""
    settings = {
        "region": rectangle(1.0, 1.0),
        "spacing": 1.0 / N,
        "m": M,
        "material": ElasticTensor.isotropic(1.0, 0.2),
        "surface": "none",
        "cracks": [Crack((-0.6, 0.0), (0.0, 0.0))],
        "supports": [
            Support.where(
                lambda x, y: np.abs(y) > 0.5 - 2.5 / N,
                displacement=lambda x, y: np.stack([0 * x, np.sign(y)], axis=-1),
                rotation=0.0,
            )
        ],
        **changes,
    }
    return Scene(**settings)
