"""Numbers, symbols and units as a report prints them, the same as on the pages. Start reading at `fixed`.

True minus sign, narrow space between thousands, a dash for what is not known.
"""

from __future__ import annotations

import datetime
import itertools
import math
import re
from collections.abc import Collection, Iterable, Mapping
from typing import NamedTuple

from markupsafe import Markup, escape

from campaigns.symbols import is_path

MINUS, NARROW, NONE = "\u2212", "\u202f", "\u2014"
_GREEK = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ε", "zeta": "ζ", "eta": "η", "theta": "θ",
    "kappa": "κ", "lambda": "λ", "mu": "μ", "nu": "ν", "xi": "ξ", "rho": "ρ", "sigma": "σ", "tau": "τ", "phi": "φ",
    "chi": "χ", "psi": "ψ", "omega": "ω",
}  # fmt: skip
_RAISED = {"2": "²", "3": "³", "4": "⁴"}


class Terms(NamedTuple):
    """What stored sentences may speak of."""

    symbols: Mapping[str, str]
    """The symbol of what is written: d_min of d_min, m of vehicle.m."""
    units: Collection[str]
    """Those that numbers may have."""


NO_TERMS = Terms({}, ())


def known(value: object) -> bool:
    """Whether this is a number that can be printed."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def fixed(value: float | None, decimals: int = 2) -> str:
    """A number with so many decimals."""
    if value is None or not known(value):
        return NONE
    text = f"{abs(value):,.{min(max(decimals, 0), 20)}f}".replace(",", NARROW)
    negative = value < 0 and any(c in "123456789" for c in text)
    return (MINUS if negative else "") + text


def signed(value: float | None, decimals: int = 2) -> str:
    """As `fixed`, with a plus before positive numbers."""
    text = fixed(value, decimals)
    return f"+{text}" if value is not None and value > 0 and any(c in "123456789" for c in text) else text


def count(value: float | None) -> str:
    """A whole number."""
    return fixed(value, 0)


def decimals_for(values: Iterable[float | None], digits: int = 4) -> int:
    """Decimals that show the largest of some numbers with so many significant digits."""
    largest = max((abs(v) for v in values if v is not None and known(v)), default=0.0)
    if largest == 0:
        return max(0, digits - 1)
    return min(12, max(0, digits - 1 - math.floor(math.log10(largest) + 1e-12)))


def decimals_apart(values: Iterable[float | None], digits: int = 4, most: int = 7) -> int:
    """Decimals that show some numbers and still tell the nearest two apart."""
    ordered = sorted(v for v in values if v is not None and known(v))
    scale = max((abs(v) for v in ordered), default=0.0)
    gaps = [b - a for a, b in itertools.pairwise(ordered) if b - a > 1e-9 * scale]
    base = decimals_for(ordered, digits)
    if not gaps:
        return base
    return min(max(base, math.ceil(-math.log10(min(gaps)) - 0.01)), decimals_for(ordered, most))


def plain(value: float | None, digits: int = 6) -> str:
    """A number as an engineer writes it: significant digits, no trailing zeros, powers of ten at the ends."""
    if value is None or not known(value):
        return NONE
    if value == 0:
        return "0"
    size = abs(value)
    if size >= 1e9 or size < 1e-4:
        mantissa, _, power = f"{size:.{digits - 1}e}".partition("e")
        text = f"{_trimmed(mantissa)}e{int(power)}".replace("-", MINUS)
    else:
        text = _trimmed(fixed(size, decimals_for([size], digits)))
    return (MINUS if value < 0 else "") + text


def _trimmed(digits: str) -> str:
    return digits.rstrip("0").rstrip(".") if "." in digits else digits


def percent(share: float | None, digits: int = 3) -> str:
    """A share as percent."""
    if share is None or not known(share):
        return NONE
    value = 100 * share
    return f"{fixed(value, 0 if value == 0 else decimals_for([value], digits))}{NARROW}%"


def seconds(value: float | None) -> str:
    """A length of time [s]."""
    if value is None or not known(value):
        return NONE
    if value < 0.05:
        return "< 0.1 s"
    if value < 60:
        return f"{value:.1f} s"
    minutes, rest = divmod(round(value), 60)
    return f"{minutes}:{rest:02d} min" if minutes < 60 else f"{minutes // 60} h {minutes % 60:02d} min"


def moment(at: float | None) -> str:
    """A time [s since 1970] in UTC."""
    if at is None:
        return "not recorded"
    told = datetime.datetime.fromtimestamp(at, datetime.UTC)
    return f"{told.day} {told:%B %Y, %H:%M:%S} UTC"


def day(at: float) -> str:
    """The day of a time [s since 1970] in UTC."""
    told = datetime.datetime.fromtimestamp(at, datetime.UTC)
    return f"{told.day} {told:%B %Y}"


def unit(text: str) -> str:
    """kg m2 as kg·m²."""
    raised = re.sub(r"([A-Za-zµΩ°])\^?([234])(?!\d)", lambda m: m[1] + _RAISED[m[2]], text)
    return re.sub(r"(?<=\S) (?=\S)", "·", raised)


def split(symbol: str) -> tuple[str, str]:
    """Base and index of a symbol: K_p1 is K with the index p1."""
    base, _, index = symbol.partition("_")
    return (_greek(base), _greek(index.strip("{}"))) if base else (_greek(symbol), "")


def _greek(text: str) -> str:
    return re.sub(r"[a-z]+", lambda m: _GREEK.get(m[0], m[0]), text)


def sign(symbol: str, path: str = "") -> Markup:
    """A symbol set as in print, in HTML; a path as it is written, with places to break. `path` is told on hover."""
    if is_path(symbol):
        return Markup('<span class="path">{}</span>').format(Markup(".<wbr>").join(symbol.split(".")))
    base, index = split(symbol)
    below = Markup("<sub>{}</sub>").format(index) if index else ""
    told = Markup(' title="{}"').format(path) if path and path != symbol else ""
    return Markup('<i class="v"{}>{}</i>{}').format(told, base, below)


def svg_sign(symbol: str) -> Markup:
    """The same inside an SVG text."""
    if is_path(symbol):
        return Markup("<tspan>{}</tspan>").format(symbol)
    base, index = split(symbol)
    below = Markup('<tspan font-size="0.8em" dy="0.28em">{}</tspan><tspan dy="-0.22em">\u200b</tspan>').format(index)
    return Markup('<tspan font-style="italic">{}</tspan>{}').format(base, below if index else "")


def prose(text: str | None, terms: Terms = NO_TERMS) -> Markup:
    """A stored sentence, escaped and set as in print: symbols for what is written in ASCII, signs, units."""
    clean = typeset(text or "", terms.units)
    written = sorted((term for term in terms.symbols if term != terms.symbols[term] or "_" in term), key=len)
    if not written:
        return escape(clean)
    any_of = "|".join(map(re.escape, reversed(written)))
    parts = re.split(rf"(?<![\w.])({any_of})(?!\w|\.\w)", clean)
    return Markup("").join(sign(terms.symbols[part], part) if i % 2 else escape(part) for i, part in enumerate(parts))


def sentence(text: str | None, terms: Terms = NO_TERMS) -> Markup:
    """As `prose`, of a clause that is to begin with a capital and end with a full stop."""
    clean = (text or "").strip()
    if clean and not any(clean.startswith(term) for term in terms.symbols):
        clean = clean[0].upper() + clean[1:]
    return prose(clean if clean.endswith(".") else f"{clean}.", terms) if clean else Markup("")


def typeset(text: str, units: Iterable[str]) -> str:
    """Numbers and units of plain text as in print: true minus signs, narrow spaces before units."""
    signs = re.sub(rf"(?<![\w.{MINUS}-])-(?=\d)|(?<=\de)-(?=\d)", MINUS, text)
    known_units = sorted({*units, "%"} - {""}, key=len, reverse=True)
    pattern = rf"(?<=\d) ({'|'.join(map(re.escape, known_units))})(?![\w/])"
    return re.sub(pattern, lambda found: NARROW + unit(found[1]), signs)


WRAPPED = 85
"""A line of a text that is at least so long was broken by its author's editor, not by its author."""


def flowed(text: str) -> str:
    """Text whose lines are put together where they were broken for width only."""
    found: list[str] = []
    whole = True
    for line in text.strip().splitlines():
        if whole or not line.strip():
            found.append(line)
        else:
            found[-1] += f" {line.strip()}"
        whole = len(line) < WRAPPED
    return "\n".join(found)


def paragraphs(text: str) -> list[Markup]:
    """A component's text: prose as paragraphs, indented equations as they stand."""
    found = []
    for block in text.strip("\n").split("\n\n"):
        inset = all(line.startswith("    ") for line in block.splitlines() if line.strip())
        form = "<pre>{}</pre>" if inset else "<p>{}</p>"
        found.append(
            Markup(form).format("\n".join(line[4:] for line in block.splitlines()) if inset else flowed(block))
        )
    return found
