"""The audit's figures show what their captions say."""

import numpy as np
import pytest

from cmverify.report import errata_figures


def lines(figure):
    """Drawn data by label."""
    (axis,) = figure.axes
    return {line.get_label(): np.array(line.get_data()) for line in axis.lines}


def test_the_printed_disc_keeps_its_rim_and_not_its_inside():
    found = lines(errata_figures.disc())
    printed = found["Eq. 169 as printed"][1]
    solved = found["solution with its boundary values"][1]
    assert printed[[0, -1]] == pytest.approx(solved[[0, -1]])
    assert np.max(np.abs(printed - solved)) > 0.02
    height, left = found["div(D∇T) of the print, over 4"]
    assert left == pytest.approx(-0.2 * height)


def test_the_corrected_square_sounds_like_its_blocks():
    found = lines(errata_figures.tetrachiral())
    blocks = found["25 × 25 blocks"][1]
    assert found["homogenised, Eq. 87 corrected"][1] == pytest.approx(blocks, rel=5e-3)
    assert np.all(found["homogenised, Eq. 87 as printed"][1] < 0.85 * blocks)


def test_half_a_stiffness_is_root_half_the_frequency():
    right, given = lines(errata_figures.half_a_stiffness())["Eq. 37 as printed"]
    assert given == pytest.approx(right * np.sqrt(0.5), abs=1e-6)
    assert right.max() > 1
