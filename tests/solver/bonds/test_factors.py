"""Factors on single bonds: one on each is the bond itself, two double the moduli."""

import numpy as np
import pytest

from solver import ConductivityTensor, ElasticTensor, Scene, Support, disc, rectangle
from solver.bonds import Factors


def even(value):
    """The same factor on all bonds, as `Description.factors` calls it."""

    def factors(bonds, moduli):
        half = bonds.family.size // 2
        whole = np.full((bonds.family.size, bonds.lattice.count), value)
        if bonds.ended is None:
            return Factors(whole)
        chords = bonds.ended.chords
        return Factors(
            whole,
            np.full(len(bonds.ended), value),
            None if chords is None else np.full(len(chords.offset), value),
            np.full((len(bonds.ended.outline.edges), half), value),
        )

    return factors


@pytest.mark.parametrize("surface", ["none", "volume", "extrapolated"])
@pytest.mark.parametrize("region", [disc(1.0), rectangle(2.0, 1.5)], ids=["disc", "rectangle"])
@pytest.mark.parametrize(
    ("material", "held"),
    [
        (ConductivityTensor([[2.0, 0.5], [0.5, 1.0]]), {"temperature": 0.0}),
        (ElasticTensor.isotropic(1.0, 0.2), {"displacement": (0.0, 0.0), "rotation": 0.0}),
    ],
    ids=["heat", "elastic"],
)
def test_a_factor_on_all_bonds_is_one_on_the_operator(surface, region, material, held):
    supports = [Support.where(lambda x, y: x < -0.6, **held)]
    common = {"spacing": 0.1, "m": 3, "surface": surface, "supports": supports}
    plain = Scene(region, material=material, **common).discretise().operator
    x = np.cos(1.7 * np.arange(plain.shape[0]))
    wanted = plain.matvec(x)
    for value in (1.0, 2.0):
        scaled = Scene(region, material=material, factors=even(value), **common)
        found = scaled.discretise().operator.matvec(x)
        assert np.abs(found - value * wanted).max() < 1e-11 * np.abs(wanted).max()
