"""A guess near what has changed lowers the energy of the error, and most of the residual."""

import numpy as np
import pytest

from solver import Crack, ElasticTensor, Scene, Support, rectangle
from solver.linear import TwoLevel, nearby


def _bodies(surface: str, **changes: object) -> tuple:
    """A cracked square before and after the crack has grown a little."""
    held = Support.where(lambda x, y: np.abs(y) > 23, displacement=(0.0, 1.0), rotation=0.0)
    settings = {"cracks": [Crack((-30, 0.3), (0, 0.3))], "m": 3, "surface": surface, **changes}
    scene = Scene(rectangle(52, 52), 1.0, ElasticTensor.isotropic(1.0, 0.2), [held], **settings)
    sound = scene.discretise(sharp_tips=False)
    ahead = np.abs(sound.lattice.points - [2.0, 0.0]).max(axis=1) < 2
    up = (sound.family.offsets[: sound.family.size // 2] == [0, 1]).all(axis=1)
    offset = int(np.nonzero(up)[0][0])
    origins = np.nonzero(ahead)[0]
    bonds = sound.bonds.breaking(np.full(len(origins), offset), origins)
    prescribed = sound.prescribed
    return sound.operator, type(sound.operator)(bonds, sound.moduli, prescribed), origins


@pytest.mark.parametrize(("surface", "left"), [("volume", 0.25), ("extrapolated", 1.0)])
def test_most_of_the_residual_goes_and_energy_falls(monkeypatch, surface, left):
    """Not all of it where the surface's particles are held too."""
    monkeypatch.setattr(nearby, "_AROUND", 9)
    before, after, changed = _bodies(surface)
    near = nearby.around(after, changed)
    assert 0 < len(near) < 0.4 * len(after.active)
    # Where bonds have gone something is out of balance.
    residual = np.zeros((3, len(after.active)))
    at = np.searchsorted(after.active, changed)
    residual[:, at] = np.random.default_rng(0).normal(size=(3, len(at)))
    change, loss = nearby.change(after, TwoLevel(before), near, residual.ravel())
    np.testing.assert_allclose(loss, after.matvec(change), atol=1e-12)
    assert np.linalg.norm(residual.ravel() - loss) < left * np.linalg.norm(residual)
    # Energy of the error, ½ e·Ke less a constant.
    assert change @ (0.5 * loss - residual.ravel()) < 0
    held = np.ones(len(after.active), dtype=bool)
    held[near] = False
    assert not change.reshape(3, -1)[:, held].any()


def test_much_of_the_body_is_left_to_the_whole():
    _, after, _ = _bodies("none")
    assert len(nearby.around(after, after.active)) == 0
