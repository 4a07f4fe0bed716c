"""Base classes of all request and response models, with the rules for storable values."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, ClassVar

from fastapi import Path
from pydantic import ConfigDict, Field, ValidationInfo, field_validator

from campaigns.asked.reading import LONGEST_KEY, Place, field
from campaigns.documented import Documented

LARGEST_WHOLE = 2**63 - 1
"""The largest integer that a database can store."""

RunName = Annotated[str, Path(description="The run by its name, such as R-0001.")]
DraftName = Annotated[str, Path(description="The draft by its name, such as D-0001.")]
FlightName = Annotated[str, Path(description="A stored flight: `nominal`, or a finding by its label, such as F1.")]
Number32 = Annotated[int, Field(ge=1, le=2**31 - 2)]
"""An integer that fits into a 32-bit column even after an increment."""
UNIX_TIME = "unix-time"
Instant = Annotated[float, Field(json_schema_extra={"format": UNIX_TIME})]
"""A time as seconds since 1970; the format in the OpenAPI document distinguishes it from other numbers."""
Finite = Annotated[float, Field(allow_inf_nan=False)]


class Schema(Documented):
    """No unknown fields; the docstring of a field is its description in the OpenAPI document."""

    model_config = ConfigDict(extra="forbid")


class Given(Schema):
    """A request body: refuses text and numbers that a database cannot store."""

    checked_elsewhere: ClassVar[frozenset[str]] = frozenset()
    """Keys whose values are validated separately."""

    @field_validator("*", mode="before")
    @classmethod
    def _storable(cls, value: Any, info: ValidationInfo) -> Any:
        if info.field_name not in cls.checked_elsewhere:
            for reason in _unstorable(value):
                raise ValueError(reason)
        return value


def _unstorable(value: Any) -> Iterator[str]:
    waiting: list[tuple[Place, Any]] = [(None, value)]
    while waiting:
        place, value = waiting.pop()
        if isinstance(value, dict):
            waiting += [((place, key), inner) for key, inner in value.items()]
            waiting += [((place, "a key"), key) for key in value]
        elif isinstance(value, list):
            waiting += [((place, i), inner) for i, inner in enumerate(value)]
        elif (reason := _reason(value)) is not None:
            yield f"{field(place)[:LONGEST_KEY]}: {reason}" if place else reason


def _reason(value: Any) -> str | None:
    if isinstance(value, str):
        return unstorable_text(value)
    if isinstance(value, int) and abs(value) > LARGEST_WHOLE:
        return "a whole number of more than 64 bits"
    return None


def unstorable_text(text: str) -> str | None:
    """The reason why a text cannot be stored or returned; None for Unicode text without null characters."""
    if "\0" in text:
        return "text must not contain null characters"
    try:
        text.encode()
    except UnicodeEncodeError:
        return "invalid Unicode text: it contains an unpaired surrogate"
    return None
