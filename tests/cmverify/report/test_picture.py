"""Figures as bytes: reproducible, and as small as they can be without another colour."""

import io
import re

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure

from cmverify.report.picture import Picture, in_palette, slim


def line():
    figure = Figure(figsize=(3.0, 2.0))
    figure.subplots().plot([0.0, 1.0], [0.0, 1.0], label="$σ_{22}$")
    figure.axes[0].legend()
    return figure


@pytest.mark.parametrize("kind", ["svg", "png"])
def test_the_same_figure_is_the_same_bytes(kind):
    first, second = (Picture.drawn("f", kind, line(), "", "") for _ in range(2))
    assert first.content == second.content
    assert re.match(f"data:image/({kind}|webp)", first.uri)
    assert first.uri == second.uri


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

    figure = line()
    figure.axes[0].set_title('the hole\'s "edge"')
    picture = Picture.drawn("f", "svg", figure, "", "")
    text = picture.content.decode()
    assert "<!--" not in text
    assert not re.findall(r'[" -]\d+\.\d{3,}', text)
    assert '"' not in picture.uri
    assert "&" not in picture.uri
    there = tree.fromstring(urllib.parse.unquote(picture.uri.split(",", 1)[1]))
    here = tree.fromstring(text)
    assert [n.tag for n in there.iter()] == [n.tag for n in here.iter()]
    said = [[n.text for n in root.iter() if n.tag.endswith("text")] for root in (here, there)]
    assert said[0] == said[1]
    assert 'the hole\'s "edge"' in said[1]
    for one, other in zip(there.iter(), here.iter(), strict=True):
        own = {k: v.replace("'", '"').split() for k, v in other.items()}
        assert {k: v.split() for k, v in one.items()} == own


def drawn(text):
    """What a drawing's marks are, where they lie and what they look like, in their order."""
    import xml.etree.ElementTree as tree

    root, found = tree.fromstring(text), []
    sheet = "".join(n.text for n in root.iter() if n.tag.endswith("style"))
    looks = dict(re.findall(r"\.(c\d+)\{([^}]*)\}", sheet))
    for node in root.iter():
        given = {k: v for k, v in node.items() if k not in ("class", "style", "transform")}
        if not node.tag.endswith(("path", "use", "text", "tspan", "image")):
            continue
        given["look"] = looks[node.get("class")] if node.get("class") else node.get("style")
        turn = node.get("transform", "")
        turned = "" if "(-0 " in turn else turn
        found.append((node.tag, node.text and node.text.strip(), given, turned))
    return found


def test_a_small_drawing_looks_as_the_large_one():
    figure = line()
    figure.axes[0].scatter([0.2, 0.4], [0.5, 0.6], c=["r", "b"])
    figure.axes[0].set_ylabel("displacement, $u_c$")
    buffer = io.StringIO()
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": "salt"}):
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    large = buffer.getvalue()
    small = slim(large)
    assert len(small) < 0.6 * len(large)

    one, other = (str(drawn(text)) for text in (small, large))
    number = r"-?\d+(?:\.\d+)?"
    assert re.sub(number, "", one).split() == re.sub(number, "", other).split()
    here, there = ([float(n) for n in re.findall(number, text)] for text in (one, other))
    np.testing.assert_allclose(here, there, atol=0.0051)


def test_pixels_in_a_page_are_those_of_the_file():
    import base64

    import PIL.features
    import PIL.Image

    picture = Picture.drawn("f", "png", line(), "", "")
    kind, content = picture.uri.split(";base64,")
    assert kind == ("data:image/webp" if PIL.features.check("webp") else "data:image/png")
    images = [PIL.Image.open(io.BytesIO(b)) for b in (picture.content, base64.b64decode(content))]
    there, here = (np.asarray(image.convert("RGB")) for image in images)
    np.testing.assert_array_equal(there, here)


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
