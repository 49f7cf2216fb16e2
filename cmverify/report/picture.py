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
        """A matplotlib figure, the same bytes for the same figure."""
        buffer = io.BytesIO()
        options: dict[str, Any] = {"dpi": 130} if kind == "png" else {"metadata": {"Date": None}}
        figure.savefig(buffer, format=kind, **options)
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
