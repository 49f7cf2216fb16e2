"""A figure as the pages show it and as a file beside them."""

from __future__ import annotations

import base64
import io
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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
        """A matplotlib figure, the same bytes for the same figure.

        Text of an SVG stays text, a third of the size of outlines; maps have 256 colours.
        """
        import matplotlib

        from cmverify.report import style

        buffer = io.BytesIO()
        options: dict[str, Any] = {"dpi": 130} if kind == "png" else {"metadata": {"Date": None}}
        with matplotlib.rc_context(style.RC):
            figure.savefig(buffer, format=kind, **options)
        content = _few_colours(buffer) if kind == "png" else _spare_font(buffer.getvalue())
        return cls(name, kind, content, caption, alt, wide)

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


def _few_colours(buffer: io.BytesIO) -> bytes:
    """A PNG with a palette: half the size, and no eye tells it from the other."""
    from PIL import Image

    packed = io.BytesIO()
    with Image.open(buffer) as image:
        image.convert("RGB").quantize(
            256, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE
        ).save(packed, "PNG")
    return packed.getvalue()


def _spare_font(content: bytes) -> bytes:
    """Verdana, which is as wide, where whoever shows the figure has no DejaVu."""
    return content.replace(b"'DejaVu Sans'", b"'DejaVu Sans', Verdana, sans-serif")
