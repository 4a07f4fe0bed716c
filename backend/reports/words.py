"""Sentences, symbols and dates as a report prints them, the same as on the pages. Start reading at `drawn`."""

from __future__ import annotations

import datetime
import re

from markupsafe import Markup, escape

from campaigns.claims import say as claims
from campaigns.claims.numbers import printed
from campaigns.claims.spans import Quantity, Reference, Said, Span, Symbol, Text
from campaigns.symbols import is_path

_GREEK = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ε", "zeta": "ζ", "eta": "η", "theta": "θ",
    "kappa": "κ", "lambda": "λ", "mu": "μ", "nu": "ν", "xi": "ξ", "rho": "ρ", "sigma": "σ", "tau": "τ", "phi": "φ",
    "chi": "χ", "psi": "ψ", "omega": "ω",
}  # fmt: skip


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


def drawn(said: Said) -> Markup:
    """A sentence as in print: symbols set, numbers with true minus signs and their units."""
    return Markup("").join(map(_span, said))


def sentence(said: Said) -> Markup:
    """The same of a clause, with a capital and a full stop."""
    return drawn(claims.sentence(said))


def _span(span: Span) -> Markup:
    match span:
        case Symbol():
            return sign(span.symbol, span.name)
        case Quantity():
            return escape(printed(span.value, span.unit, span.format, span.digits))
        case Text():
            return escape(span.text)
        case Reference():
            return escape(span.label)


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
