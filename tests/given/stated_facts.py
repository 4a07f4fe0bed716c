"""What a sentence states, without its words: its numbers, and the parts of the run that it names."""

from __future__ import annotations

from campaigns.claims.numbers import ROUNDED, Format, rounded
from campaigns.claims.spans import Quantity, Reference, Spans, Symbol, Text

Fact = str | float


def facts(statement: Spans) -> list[Fact]:
    """The numbers of a sentence as they are written, and the ids that it refers to, in its order."""
    return [_fact(span) for span in statement if not isinstance(span, Text)]


def _fact(span: Quantity | Reference | Symbol) -> Fact:
    match span:
        case Quantity():
            if span.format in ROUNDED:
                return float(rounded(span.value, span.format, span.digits))
            return span.value if span.format is Format.COUNT else float(f"{span.value:.{span.digits}g}")
        case Reference():
            return span.id
        case Symbol():
            return span.name
