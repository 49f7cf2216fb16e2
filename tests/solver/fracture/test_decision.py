"""Unfinished solves decide as finished ones do: the same bonds break in the same order."""

import numpy as np
import pytest

from solver import Crack, ElasticTensor, Programme, Scene, Support, Toughness, rectangle
from solver.fracture import decision, grow, growth
from solver.fracture.breaking import TIE, next_batch
from solver.linear import nearby


def test_a_batch_that_stands_apart_is_the_same_under_noise():
    rng = np.random.default_rng(5)
    apart = 0
    for _ in range(300):
        found, size = rng.uniform(0.5, 1.5, 40), int(rng.integers(1, 30))
        noise = 10 ** rng.uniform(-5, -2)
        if not decision.parted(found, 1.0, size, noise):
            continue
        apart += 1
        batch, _ = next_batch(found[None], 1.0, size)
        other, _ = next_batch((found + rng.uniform(-noise, noise, 40))[None], 1.0, size)
        np.testing.assert_array_equal(batch, other)
    assert 30 < apart < 270


@pytest.mark.parametrize(("found", "size"), [([1.0, 0.5], 4), ([1.5, 1.4999, 1.2], 1)])
def test_what_lies_at_the_line_is_not_decided(found, size):
    assert not decision.parted(np.array(found), 1.0, size, 1e-3)
    assert not decision.parted(np.array(found), 1.0, size, 0.1 * TIE) or size == 4


def _scene(surface: str, cracks: list[Crack], shear: float) -> Scene:
    grips = Support.where(
        lambda x, y: np.abs(y) > 18, rotation=0.0,
        displacement=lambda x, y: np.sign(y)[:, None] * [shear, 1.0],
    )  # fmt: skip
    voigt = np.array([[1, 0.2, 0.1], [0.2, 0.8, 1 / 6], [0.1, 1 / 6, 1 / 3]])
    material = ElasticTensor(voigt) if shear else ElasticTensor.isotropic(1.0, 1 / 3)
    return Scene(rectangle(32, 40), 1.0, material, [grips], m=3, cracks=cracks, surface=surface)


@pytest.mark.parametrize(
    ("surface", "cracks", "shear"),
    [
        ("volume", [Crack((-17, 0.3), (-8, 0.3))], 0.8),
        ("extrapolated", [Crack((-17, 0.3), (-8, 0.3))], 0.3),
        # Mirror images break together; no rotations.
        ("none", [Crack((-17, 0), (-10, 0)), Crack((10, 0), (17, 0))], 0.0),
    ],
)
def test_the_same_bonds_break_as_in_finished_solves(monkeypatch, surface, cracks, shear):
    def run() -> object:
        body = _scene(surface, cracks, shear)
        return grow(body, Toughness(1.0), Programme(overload=0.02), max_solves=30)

    monkeypatch.setattr(nearby, "_AROUND", 6)
    quick = run()
    monkeypatch.setattr(growth, "Decision", lambda *_: None)
    monkeypatch.setattr(growth, "_ROUGH", 1.1e-8)
    monkeypatch.setattr(nearby, "_SHARE", 0.0)
    slow = run()
    assert len(slow.broken_bonds) > 60
    np.testing.assert_array_equal(quick.breaks["step"], slow.breaks["step"])
    np.testing.assert_array_equal(quick.broken_bonds, slow.broken_bonds)
    np.testing.assert_allclose(quick.breaks["load_factor"], slow.breaks["load_factor"], rtol=1e-6)
    assert quick.steps["iterations"].sum() < 0.75 * slow.steps["iterations"].sum()
    assert abs(quick.history.imbalance).max() < 1e-7 * abs(quick.history.work).max()
