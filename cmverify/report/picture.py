"""A figure as the pages show it and as a file beside them."""

from __future__ import annotations

import base64
import io
import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from PIL.Image import Image

Kind = Literal["svg", "png"]
_MEDIA = {"svg": "image/svg+xml", "png": "image/png"}
#: Signs that would end an attribute or an address; both kinds of quotes change places.
_IN_AN_ADDRESS = str.maketrans({'"': "'", "'": "%22", "%": "%25", "#": "%23", "&": "%26"})
_QUOTES = str.maketrans({'"': "&quot;", "'": "&#39;"})


@dataclass(frozen=True)
class Picture:
    """A figure, its caption, and a text for those who cannot see it."""

    name: str
    kind: Kind
    content: bytes
    caption: str
    alt: str
    wide: bool = False

    @classmethod
    def drawn(
        cls, name: str, kind: Kind, figure: Figure, caption: str, alt: str, wide: bool = False
    ) -> Picture:
        """A matplotlib figure, the same bytes for the same figure."""
        import matplotlib
        from matplotlib.text import Text

        from cmverify.report import style, wording

        for text in figure.findobj(Text):
            assert isinstance(text, Text)
            if "$" in text.get_text():
                text.set_text(wording.drawn(text.get_text()))
        buffer = io.BytesIO()
        # What is made while drawing, ticks and ids, follows the style too.
        with matplotlib.rc_context(style.RC):
            if kind == "svg":
                figure.savefig(buffer, format="svg", metadata={"Date": None})
                content = slim(buffer.getvalue().decode()).encode()
            else:
                _raster(figure).save(buffer, format="png")
                content = buffer.getvalue()
        return cls(name, kind, content, caption, alt, wide)

    @property
    def uri(self) -> str:
        """The figure inside a page, as the value of an attribute between double quotes."""
        from markupsafe import Markup

        if self.kind == "png":
            kind, content = _without_loss(self.content)
            return f"data:{kind};base64,{base64.b64encode(content).decode()}"
        # As text, a quarter smaller than base64. Browsers drop the line ends of an address.
        text = self.content.decode().replace("\n", " ")
        # Quotes of attributes change places; those in what is read do not.
        text = re.sub(r">[^<]+<", lambda said: said[0].translate(_QUOTES), text)
        text = text.translate(_IN_AN_ADDRESS)
        return Markup(f"data:{_MEDIA[self.kind]},{text}")

    def save(self, stem: Path) -> Path:
        """Write it, for papers and slides; the suffix is added."""
        path = stem.with_name(f"{stem.name}.{self.kind}")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(self.content)
        return path


def slim(svg: str) -> str:
    """The same drawing in half the characters.

    Without remarks and names of groups, with lengths to a hundredth of a point, and with what many
    of its parts look like said once.

    Examples
    --------
    >>> slim('<svg><!-- 0.125 --><g id="a"><path d="M 1.23456 -0.001"/></g></svg>')
    '<svg><path d="M 1.23 0"/></svg>'
    """
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<!--.*?-->|<metadata>.*?</metadata>", "", svg, flags=re.S)
    svg = re.sub(r"<[^>]*>", lambda tag: re.sub(r"-?\d+\.\d{3,}", _rounded, tag[0]), svg)
    svg = re.sub(r' transform="rotate\(-?0 [^")]*\)"', "", re.sub(r'<g id="[^"]*">', "<g>", svg))
    svg = _styles_once(svg)
    # Blanks between letters count, those between marks do not.
    parts = re.split(r"(<text.*?</text>)", re.sub(r"\s*\n\s*", "\n", svg), flags=re.S)
    svg = "".join(p if p.startswith("<text") else re.sub(r"\s*(<|/?>)\s*", r"\1", p) for p in parts)
    return re.sub(r"<g>(<(?:use|path)[^>]*/>|<text[^>]*>[^<]*</text>)</g>", r"\1", svg)


def _styles_once(svg: str) -> str:
    """Looks that several parts share, as classes in the drawing's own sheet of styles."""
    if "</style>" not in svg:
        return svg
    rules = []
    shared = Counter(re.findall(r' style="[^"]*"', svg)).most_common()
    for number, (look, times) in enumerate(shared):
        name = f"c{number}"
        if times > 1:
            svg = svg.replace(look, f' class="{name}"')
            rules.append(f".{name}{{{look[8:-1]}}}")
    return svg.replace("</style>", "".join(rules) + "</style>", 1)


def _without_loss(png: bytes) -> tuple[str, bytes]:
    """The same pixels in WebP, a third smaller, where Pillow can write it; else as they are."""
    import PIL.features
    import PIL.Image

    buffer = io.BytesIO()
    if PIL.features.check("webp"):
        with PIL.Image.open(io.BytesIO(png)) as image:
            image.convert("RGB").save(buffer, "webp", lossless=True, quality=50, method=3)
    content = buffer.getvalue()
    return ("image/webp", content) if 0 < len(content) < len(png) else (_MEDIA["png"], png)


def _rounded(length: re.Match[str]) -> str:
    return f"{round(float(length[0]), 2) + 0.0:g}" if abs(float(length[0])) < 1e4 else length[0]


def _raster(figure: Figure) -> Image:
    """A figure's pixels, in a palette of its own where that changes no colour of its maps."""
    import PIL.Image
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure.set_dpi(130)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())[..., :3]
    return in_palette(pixels) or PIL.Image.fromarray(pixels)


def in_palette(pixels: np.ndarray) -> Image | None:
    """An image in the 256 commonest of its colours: half the bytes of one in all of them.

    Parameters
    ----------
    pixels : (rows, columns, 3) uint8 array

    Returns
    -------
    Image or None
        None where more than the edges of letters and lines would have to change their colour.
    """
    import PIL.Image

    counted = PIL.Image.fromarray(pixels).getcolors(1 << 14)
    if counted is None:
        return None
    counted.sort(key=lambda entry: -entry[0])
    colours = np.array([colour for _, colour in counted])
    kept, rest = colours[:256], colours[256:]
    if sum(count for count, _ in counted[256:]) > 0.02 * pixels[..., 0].size:
        return None
    index = np.zeros(1 << 24, dtype=np.uint8)
    index[_packed(kept)] = np.arange(len(kept))
    if len(rest):
        distance = ((rest[:, None, :].astype(int) - kept[None, :, :]) ** 2).sum(axis=2)
        index[_packed(rest)] = distance.argmin(axis=1)
    image = PIL.Image.fromarray(index[_packed(pixels)])
    image.putpalette(kept.astype(np.uint8).tobytes())
    return image


def _packed(colours: np.ndarray) -> np.ndarray:
    red, green, blue = np.moveaxis(colours.astype(np.uint32), -1, 0)
    return np.asarray(red << 16 | green << 8 | blue)
