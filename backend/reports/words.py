"""Formats sentences, symbols and dates for a report, as on the pages."""

from __future__ import annotations

import datetime
import re

from markupsafe import Markup, escape

from campaigns.claims import say as claims
from campaigns.claims.numbers import printed
from campaigns.claims.spans import Quantity, Reference, Span, Spans, Symbol, Text
from campaigns.symbols import apart, is_path

_GREEK = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ε", "zeta": "ζ", "eta": "η", "theta": "θ",
    "kappa": "κ", "lambda": "λ", "mu": "μ", "nu": "ν", "xi": "ξ", "rho": "ρ", "sigma": "σ", "tau": "τ", "phi": "φ",
    "chi": "χ", "psi": "ψ", "omega": "ω",
}  # fmt: skip


def moment(at: float | None) -> str:
    if at is None:
        return "not recorded"
    return f"{day(at)}, {datetime.datetime.fromtimestamp(at, datetime.UTC):%H:%M:%S} UTC"


def day(at: float) -> str:
    at_utc = datetime.datetime.fromtimestamp(at, datetime.UTC)
    return f"{at_utc.day} {at_utc:%B %Y}"


def split(symbol: str) -> tuple[str, str]:
    """Base and index of a symbol: K_p1 is K with the index p1."""
    base, _, index = symbol.partition("_")
    return (_greek(base), _greek(index.strip("{}"))) if base else (_greek(symbol), "")


def _greek(text: str) -> str:
    return re.sub(r"[a-z]+", lambda m: _GREEK.get(m[0], m[0]), text)


def symbol_html(symbol: str, path: str = "") -> Markup:
    """A symbol in HTML as in print; a path is unchanged, with line-break opportunities. `path` is shown on hover."""
    if is_path(symbol):
        return Markup('<span class="path">{}</span>').format(Markup(".<wbr>").join(symbol.split(".")))
    own, part = apart(symbol)
    base, index = split(own)
    below = Markup("<sub>{}</sub>").format(index) if index else ""
    title = Markup(' title="{}"').format(path) if path and path != symbol else ""
    return Markup('<i class="v"{}>{}</i>{}{}').format(title, base, below, part)


def svg_symbol(symbol: str) -> Markup:
    if is_path(symbol):
        return Markup("<tspan>{}</tspan>").format(symbol)
    own, part = apart(symbol)
    base, index = split(own)
    below = Markup('<tspan font-size="0.8em" dy="0.28em">{}</tspan><tspan dy="-0.22em">\u200b</tspan>').format(index)
    upright = Markup("<tspan>{}</tspan>").format(part) if part else ""
    return Markup('<tspan font-style="italic">{}</tspan>{}{}').format(base, below if index else "", upright)


def drawn(statement: Spans) -> Markup:
    """A sentence as in print: formatted symbols, numbers with true minus signs and units."""
    return Markup("").join(map(_span, statement))


def sentence(statement: Spans) -> Markup:
    """A clause as in print, with a capital letter and a full stop."""
    return drawn(claims.sentence(statement))


def _span(span: Span) -> Markup:
    match span:
        case Symbol():
            return symbol_html(span.symbol, span.name)
        case Quantity():
            return escape(printed(span.value, span.unit, span.format, span.digits))
        case Text():
            return escape(span.text)
        case Reference():
            return escape(span.label)


WRAPPED = 85
"""A line of at least this length is assumed to be wrapped by an editor, not broken on purpose."""


def flowed(text: str) -> str:
    """Text in which lines that were wrapped only for width are joined."""
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
    """A component's text: prose as paragraphs, indented equations unchanged."""
    found = []
    for block in text.strip("\n").split("\n\n"):
        inset = all(line.startswith("    ") for line in block.splitlines() if line.strip())
        form = "<pre>{}</pre>" if inset else "<p>{}</p>"
        found.append(
            Markup(form).format("\n".join(line[4:] for line in block.splitlines()) if inset else flowed(block))
        )
    return found


def launched_by(owner: str, token: str | None) -> str:
    """The user, with the name of the API token."""
    return (owner or "unknown") + (f" (token {token})" if token else "")
