"""The bases of the types in `clearance.client.answers`: the JSON as it was sent, and what is derived from a state."""

from __future__ import annotations

from typing import Any, Self

from pydantic import AwareDatetime, ConfigDict, ModelWrapValidatorHandler, PrivateAttr, model_validator

from campaigns.documented import Documented
from campaigns.documents import JsonObject
from campaigns.runs import ACTIVE


class Answer(Documented):
    """A part of an answer; `document` is its JSON as it was sent."""

    model_config = ConfigDict(frozen=True, extra="ignore")
    _document: JsonObject = PrivateAttr(default_factory=dict)

    @model_validator(mode="wrap")
    @classmethod
    def _kept(cls, document: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        made = handler(document)
        if isinstance(document, dict):
            made._document = document
        return made

    @property
    def document(self) -> JsonObject:
        """The JSON as the service sent it."""
        return self._document


class RunAnswer(Answer):
    """What follows from the state of a run."""

    state: str
    started: AwareDatetime | None = None
    finished: AwareDatetime | None = None

    @property
    def ended(self) -> bool:
        """Whether it no longer changes."""
        return self.state not in ACTIVE

    @property
    def seconds(self) -> float | None:
        """The time from start to end [s]; None before the end."""
        if self.started is None or self.finished is None:
            return None
        return (self.finished - self.started).total_seconds()


class SweepAnswer(Answer):
    """What follows from the states of the runs of a sweep."""

    states: dict[str, int]

    @property
    def ended(self) -> bool:
        """Whether every run of it has ended."""
        return not set(self.states) & set(ACTIVE)
