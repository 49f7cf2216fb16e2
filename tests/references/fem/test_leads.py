"""Leads on a plate: a strip in one dimension, balance, and the Johnson formula for a slit."""

import numpy as np
import pytest

from references.analytic.potential_drop import johnson
from references.fem.leads import Lead, plate_between_leads


def test_a_bar_between_two_ends():
    """Evenly fed ends: V'' = −I/(σ h d) in the leads, V' = −I/(σ h) between them."""
    ends = [Lead(-1.0, -0.25, -0.8, 0.25, potential=0.0), Lead(0.8, -0.25, 1.0, 0.25, current=3.0)]
    bar = plate_between_leads(2.0, 0.5, 0.05, np.diag([2.0, 0.3]), ends)
    x = np.array([-0.5, 0.0, 0.7])
    wanted = 3.0 / (2.0 * 0.5) * (x + 0.8)
    np.testing.assert_allclose(bar.at(np.column_stack([x, 0 * x + 0.11])), wanted, rtol=1e-10)


def test_currents_that_cancel_need_no_potential():
    pair = [Lead(-0.5, 0.0, -0.4, 0.1, current=2.0), Lead(0.3, 0.0, 0.5, 0.2, current=-2.0)]
    plate = plate_between_leads(2.0, 1.0, 0.1, [[5.0, 2.0], [2.0, 1.0]], pair)
    assert plate.at([[-0.45, 0.05]])[0] > plate.at([[0.4, 0.1]])[0]
    with pytest.raises(ValueError, match="do not cancel"):
        plate_between_leads(2.0, 1.0, 0.1, np.eye(2), pair[:1])


def test_a_slit_raises_the_drop_as_johnson_says():
    kx, ky = 1 / 540, 1 / 170
    far = [Lead(-0.5, -3.0, 0.5, -2.9, current=-1.0), Lead(-0.5, 2.9, 0.5, 3.0, current=1.0)]
    probes = np.array([[-0.5, 0.5], [-0.5, -0.5]])
    slit = ((-0.5, 0.0), (-0.1, 0.0))
    errors = []
    for size in (0.05, 0.025):
        whole = plate_between_leads(1.0, 6.0, size, np.diag([kx, ky]), far)
        cut = plate_between_leads(1.0, 6.0, size, np.diag([kx, ky]), far, slit)
        ratio = np.subtract(*cut.at(probes)) / np.subtract(*whole.at(probes))
        errors.append(1 - ratio / johnson(0.4, 0.5, kx, ky))
    # First order, as a square-root singularity on a regular mesh allows.
    assert 0 < errors[1] < 5e-3
    assert 1.8 < errors[0] / errors[1] < 2.3


def test_what_is_refused():
    with pytest.raises(ValueError, match="either a current or a potential"):
        Lead(0.0, 0.0, 1.0, 1.0)
    one = [Lead(-0.5, -0.5, -0.37, 0.0, potential=0.0)]
    with pytest.raises(ValueError, match="lines of the mesh"):
        plate_between_leads(1.0, 1.0, 0.1, np.eye(2), one)
    held = [Lead(-0.5, -0.5, -0.3, 0.0, potential=0.0)]
    with pytest.raises(ValueError, match="along x or along y"):
        plate_between_leads(1.0, 1.0, 0.1, np.eye(2), held, ((0.0, 0.0), (0.2, 0.2)))
