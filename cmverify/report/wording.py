"""How figures, names and seconds are spelt on the pages."""

from __future__ import annotations

import math
import re

#: First words that stay small: abbreviations and symbols are not capitalised.
_SMALL = {"rms"}
_THIN = "\u202f"


def number(value: float | None, digits: int = 2) -> str:
    """A figure with few digits: 0.00123 as "1.2e-3", counts as they are."""
    if value is None or not math.isfinite(value):
        return "n/a"
    if value == 0:
        return "0"
    if value == int(value) and 1 <= abs(value) < 1e9:
        return count(int(value))
    if 0.1 <= abs(value) < 1000:
        return f"{value:.{digits + 1}g}"
    return tidy(f"{value:.{digits - 1}e}")


def tidy(text: str) -> str:
    """Exponents without padding: "≤ 2e-06" as "≤ 2e-6", as `number` spells them."""
    return re.sub(r"e([+-])0*(\d)", lambda m: "e" + m[1].replace("+", "") + m[2], text)


def count(value: int | None) -> str:
    """A whole number in groups of three."""
    return "–" if value is None else f"{value:,}".replace(",", _THIN)


def counted(value: int, one: str, many: str = "") -> str:
    """A count with its noun: "1 check", "2 checks"."""
    return f"{count(value)} {one if value == 1 else many or one + 's'}"


def seconds(value: float | None) -> str:
    """Seconds to a sensible digit."""
    if value is None or math.isnan(value):
        return "–"
    return f"{value:.3f}" if value < 1 else f"{value:.2f}" if value < 100 else f"{value:.0f}"


def heading(name: str) -> str:
    """A name with a capital letter if it begins with a word; symbols keep their case.

    Examples
    --------
    >>> heading("critical K"), heading("flux by Eq. 170"), heading("a/W"), heading("m = 3")
    ('Critical K', 'Flux by Eq. 170', 'a/W', 'm = 3')
    """
    word = re.match(r"[A-Za-z]{2,}\b(?![/^])", name)
    if word is None or word[0] in _SMALL:
        return name
    return name[:1].upper() + name[1:]


_GREEK = {
    "alpha": "α", "kappa": "κ", "lambda": "λ", "mu": "µ", "omega": "ω", "phi": "φ", "sigma": "σ",
    "varphi": "φ", "delta": "δ", "Delta": "Δ", "mathrm": "",
}  # fmt: skip
_BELOW = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
_ABOVE = str.maketrans("0123456789-*", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻*")


def mathtext(label: str) -> str:
    """Plain Unicode for the mathtext that labels use, as far as there is any.

    Examples
    --------
    >>> mathtext("$u_{22}$ of $10^{-3}$"), mathtext("$u^*$ (mm)"), mathtext("$w_c$")
    ('u₂₂ of 10⁻³', 'u* (mm)', 'w_c')
    """
    return re.sub(r"\$([^$]*)\$", lambda math: _spelt(math[1]), label)


def drawn(label: str) -> str:
    """A label as figures take it: plain Unicode where that says all, which renders sooner."""
    plain = mathtext(label)
    return label if re.search(r"[\\_^{}$]", plain) else plain


def _spelt(math: str) -> str:
    text = re.sub(
        r"\\([A-Za-z]+)(?![A-Za-z]) ?", lambda found: _GREEK.get(found[1], found[0]), math
    )
    text = text.replace("\\,", "\u202f")
    text = re.sub(r"_(?:(\d)|\{(\d+)\})", lambda n: (n[1] or n[2]).translate(_BELOW), text)
    text = re.sub(r"\^(?:([\d*])|\{(-?\d+)\})", lambda n: (n[1] or n[2]).translate(_ABOVE), text)
    return text.replace("{", "").replace("}", "")
