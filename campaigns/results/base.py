"""The base of all results: frozen, documented by the lines below their fields, read from stored JSON.

A field that an earlier version did not store has a default that shows this.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from enum import StrEnum
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, computed_field, model_validator

from campaigns.claims import earlier, spans
from campaigns.claims.say import say
from campaigns.claims.spans import Spans
from campaigns.codes import StopCode
from campaigns.documented import UNLESS_EMPTY, Documented

Values = dict[str, float]
"""Values by the path of a parameter, in its unit."""


Untraced = Annotated[dict[str, str], UNLESS_EMPTY]
"""Of a simulator that gives traces: why there is none of a case, by its name; omitted if it is empty."""


class Status(StrEnum):
    """How an evaluation ended."""

    OK = "ok"
    FAILED = "failed"
    TIMEOUT = "timeout"
    EXCLUDED = "excluded"


STATUS = tuple(Status)
"""Evaluations store a status as its index here."""
OK, FAILED, TIMEOUT, EXCLUDED = range(4)
FLAKY = "succeeded when tried again; at first: "
"""How the reason of an evaluation begins that is ok, but only after a call of it failed."""
MethodKind = Literal["global", "local", "random", "multi"]
"""How a search method searches."""
Worse = Literal["low", "high"]
"""Which end of a criterion is sought."""


def ending(statuses: Collection[Status]) -> str:
    """The words for what evaluations of these statuses do that have no value: they fail, are excluded, or either."""
    fail = any(status not in (Status.OK, Status.EXCLUDED) for status in statuses)
    return " or ".join(["fail"] * fail + ["are excluded"] * (Status.EXCLUDED in statuses))


class Result(Documented):
    """Part of what a run found. Unknown fields are ignored: a later version may have stored more."""

    model_config = ConfigDict(frozen=True, extra="ignore", json_schema_serialization_defaults_required=True)


class Described(Result):
    """A result with a sentence."""

    statement: Spans = ()
    """The sentence."""

    @computed_field  # type: ignore[prop-decorator]
    @property
    def text(self) -> str:
        """The sentence as plain text."""
        return spans.words(self.statement)

    @model_validator(mode="before")
    @classmethod
    def _worded(cls, stored: Any) -> Any:
        """Results of earlier versions have only text; `campaigns.claims.earlier` finds the symbols in it."""
        return with_spans(stored, "text", "statement")


def with_spans(stored: Any, words: str, statement: str) -> Any:
    """A stored result whose sentence `words` has no spans yet, with the sentence as one span."""
    if not isinstance(stored, Mapping):
        return stored
    stored = earlier.renamed(dict(stored))
    return stored if statement in stored or not stored.get(words) else {**stored, statement: say(stored[words])}


class Claim(Described):
    """A sentence that follows from numbers: what it is about, and those numbers by their names."""

    @computed_field  # type: ignore[prop-decorator]
    @property
    def values(self) -> dict[str, float]:
        """The numbers from which it follows."""
        return spans.values(self.statement)


class Stop(Claim):
    """How a search ended: by its own rule or its budget, which rule, and a sentence."""

    kind: Literal["rule", "budget"]
    code: StopCode | str = Field(StopCode.OTHER, union_mode="left_to_right")
    """The rule; of a method from another package it may be any string."""
