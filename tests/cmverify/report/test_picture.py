"""Figures as bytes: reproducible, and as small as they can be without another colour."""

import re

import numpy as np
import pytest
from matplotlib.figure import Figure

from cmverify.report.picture import Picture, in_palette


def line():
    figure = Figure(figsize=(3.0, 2.0))
    figure.subplots().plot([0.0, 1.0], [0.0, 1.0], label="$σ_{22}$")
    figure.axes[0].legend()
    return figure


@pytest.mark.parametrize("kind", ["svg", "png"])
def test_the_same_figure_is_the_same_bytes(kind):
    first, second = (Picture.drawn("f", kind, line(), "", "") for _ in range(2))
    assert first.content == second.content
    assert first.uri.startswith(f"data:image/{kind}")


def test_text_stays_text():
    content = Picture.drawn("f", "svg", line(), "", "").content.decode()
    assert "σ" in content
    assert "DejaVu Sans" in content
    assert "sans-serif" in content  # where a reader's machine has no DejaVu


def test_symbols_are_plain_where_unicode_has_them():
    figure = line()
    figure.axes[0].set_title(r"$w_c\,\delta^3$ at $x_1$")  # no c stands below a line: typeset
    content = Picture.drawn("f", "svg", figure, "", "").content.decode()
    assert "σ₂₂" in content
    assert "tspan" in content


def test_a_drawing_is_small_and_the_same_in_an_address():
    import urllib.parse
    import xml.etree.ElementTree as tree

    picture = Picture.drawn("f", "svg", line(), "", "")
    text = picture.content.decode()
    assert "<!--" not in text
    assert not re.findall(r'[" -]\d+\.\d{3,}', text)
    assert '"' not in picture.uri
    assert "&" not in picture.uri
    there = tree.fromstring(urllib.parse.unquote(picture.uri.split(",", 1)[1]))
    here = tree.fromstring(text)
    assert [n.tag for n in there.iter()] == [n.tag for n in here.iter()]
    for one, other in zip(there.iter(), here.iter(), strict=True):
        own = {k: v.replace("'", '"').split() for k, v in other.items()}
        assert {k: v.split() for k, v in one.items()} == own


def test_few_colours_are_kept_exactly():
    pixels = np.random.default_rng(0).integers(0, 4, (40, 50, 3)).astype(np.uint8) * 60
    image = in_palette(pixels)
    assert image is not None
    assert image.mode == "P"
    np.testing.assert_array_equal(np.asarray(image.convert("RGB")), pixels)


def test_the_rare_ones_go_to_their_neighbours():
    """Six hundred shades: too many where they are 6 % of the picture, not where 0.7 %."""
    pixels = np.full((100, 100, 3), 200, np.uint8)
    for row in range(6):
        pixels[row] = np.array([40 * row, 100, 0]) + np.arange(100)[:, None] * [0, 0, 1]
    assert in_palette(pixels) is None
    many = np.full((300, 300, 3), 200, np.uint8)
    many[:100, :100] = pixels
    image = in_palette(many)
    assert image is not None
    off = np.abs(np.asarray(image.convert("RGB")).astype(int) - many).max(axis=2)
    assert 0 < (off > 0).mean() < 0.005
    assert off.max() <= 60


def test_a_photograph_is_left_alone():
    pixels = np.random.default_rng(1).integers(0, 256, (50, 50, 3)).astype(np.uint8)
    assert in_palette(pixels) is None
