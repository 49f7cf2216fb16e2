"""A figure as the pages show it and as a file beside them."""

from __future__ import annotations

import base64
import io
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from PIL.Image import Image

Kind = Literal["svg", "png"]
_MEDIA = {"svg": "image/svg+xml", "png": "image/png"}


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
            else:
                _raster(figure).save(buffer, format="png")
        return cls(name, kind, buffer.getvalue(), caption, alt, wide)

    @property
    def uri(self) -> str:
        """The figure inside a page."""
        return f"data:{_MEDIA[self.kind]};base64,{base64.b64encode(self.content).decode()}"

    def save(self, stem: Path) -> Path:
        """Write it, for papers and slides; the suffix is added."""
        path = stem.with_name(f"{stem.name}.{self.kind}")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(self.content)
        return path


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
