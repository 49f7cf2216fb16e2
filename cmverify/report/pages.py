"""Templates and style that all pages share."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING

from cmverify.report import wording

if TYPE_CHECKING:
    from jinja2 import Environment


@cache
def environment() -> Environment:
    """Jinja's, with the templates of this folder and the filters that spell figures."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    found = Environment(
        loader=PackageLoader("cmverify.report", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
    )
    for name in ("number", "seconds", "count", "mathtext", "heading", "tidy"):
        found.filters[name] = getattr(wording, name)
    found.globals["counted"] = wording.counted
    return found


def css() -> str:
    """The style sheet."""
    return (files("cmverify.report") / "style.css").read_text(encoding="utf-8")
