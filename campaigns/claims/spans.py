"""A sentence as data: spans of text, symbols, quantities with their unit, and references to parts of the run.

Pages, reports and the command line render the same spans; `words` renders them as plain text.
"""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated, Literal

from pydantic import ConfigDict, Field
from typing_extensions import TypeAliasType

from campaigns.claims.numbers import Format, written
from campaigns.documented import Documented


class _Span(Documented):
    model_config = ConfigDict(frozen=True, extra="ignore", json_schema_serialization_defaults_required=True)


class Text(_Span):
    """Words."""

    kind: Literal["text"] = "text"
    text: str


class Symbol(_Span):
    """The symbol of a criterion's quantity or of a parameter."""

    kind: Literal["symbol"] = "symbol"
    name: str
    """As it is written: d_min, or the path of a parameter."""
    symbol: str
    """As printed; with its part, "y of obstacle 1", if another parameter of the campaign has the same symbol."""


class Quantity(_Span):
    """A number with its unit."""

    kind: Literal["quantity"] = "quantity"
    value: float
    """A fraction where the format is percent, or that of a probability."""
    unit: str = ""
    format: Format = Format.PLAIN
    digits: int = Field(6, ge=1, le=17)
    """Significant digits; a count is written with all its digits."""
    name: str = ""
    """The role of the number in its claim, such as `margin`; empty if nothing is decided from it."""


class Target(StrEnum):
    """The kind of thing that a reference points to."""

    FINDING = "finding"
    STAGE = "stage"
    EVALUATION = "evaluation"
    METHOD = "method"


class Reference(_Span):
    """A part of the run: the finding F1, a search method by its title."""

    kind: Literal["reference"] = "reference"
    to: Target
    id: str
    """The label of a finding, the position of a stage, the name of a method."""
    label: str
    """As it is written."""


Span = TypeAliasType("Span", Annotated[Text | Symbol | Quantity | Reference, Field(discriminator="kind")])
Spans = tuple[Span, ...]
"""A sentence, a clause, a phrase."""


def words(statement: Spans) -> str:
    """The sentence as plain text."""
    return "".join(map(_written, statement))


def values(statement: Spans) -> dict[str, float]:
    """The numbers that have a name in their claim."""
    return {span.name: span.value for span in statement if isinstance(span, Quantity) and span.name}


def _written(span: Span) -> str:
    match span:
        case Text():
            return span.text
        case Symbol():
            return span.name
        case Quantity():
            return written(span.value, span.unit, span.format, span.digits)
        case Reference():
            return span.label
