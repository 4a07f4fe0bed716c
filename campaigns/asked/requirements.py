"""The requirements that a criterion is evidence for, and the digest of the question that a campaign asks of them.

An id names a requirement in the tool that it was written in.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Field

from campaigns.asked.reading import repeated
from campaigns.asked.values import Notes, Strict
from campaigns.documented import UNSTATED
from campaigns.documents import digest_of

MOST = 200
"""Requirements of one criterion."""
LONGEST_ID = 120
"""Characters."""

_ASKED = ("scenario", "simulator", "uncertain", "criterion")
"""What a violation depends on. Seed, methods, budgets and correlations decide whether it is found and how often, not
whether it is there."""

_UNASKED = {
    "scenario": ("realisations",),
    "simulator": ("repeats", "retries"),
    "criterion": ("requirements", "threshold", "from_centre"),
}
"""Of these, what removes no case: what an evaluation draws, calls and combines, and what is stated of its value."""


def _id(text: str) -> str:
    if text != text.strip() or not text.isprintable():
        raise ValueError("expected the id of a requirement: one line of readable text without spaces at its ends")
    return text


def _named(reference: Any) -> Any:
    """`REQ-1` is short for `{id: REQ-1}`."""
    return {"id": reference} if isinstance(reference, str) else reference


def _once(references: list[RequirementRef]) -> list[RequirementRef]:
    if twice := repeated(one.id for one in references):
        raise ValueError(f"{twice} is given twice; name a requirement once")
    return references


RequirementId = Annotated[str, Field(min_length=1, max_length=LONGEST_ID), AfterValidator(_id)]


class RequirementRef(Strict):
    """A requirement, by the id that it has where it was written."""

    id: RequirementId
    text: Annotated[Notes, UNSTATED] = ""
    """Its text when the campaign was written; omitted from the canonical form if not given."""


Requirements = Annotated[
    list[Annotated[RequirementRef, BeforeValidator(_named, json_schema_input_type=RequirementRef | RequirementId)]],
    Field(max_length=MOST),
    AfterValidator(_once),
]


def question(document: Mapping[str, Any]) -> str:
    """SHA-256 of what a stored campaign asks: system, bounds and criterion, without all that removes no violation.

    Without the threshold as well: a value that violates a threshold violates every higher one.
    """
    content = {key: _without(document[key], _UNASKED.get(key, ())) for key in _ASKED if document.get(key)}
    content["uncertain"] = {
        path: _without(one, ("distribution",)) for path, one in content.get("uncertain", {}).items()
    }
    return digest_of(content)


def _without(part: Mapping[str, Any], names: Collection[str]) -> Mapping[str, Any]:
    return {name: value for name, value in part.items() if name not in names}


def definition(document: Any) -> str:
    """SHA-256 of a stored campaign without the baseline, which is added at launch: equal for every launch of a file.

    document: also a damaged one, which is no mapping.
    """
    if not isinstance(document, Mapping):
        return digest_of({"damaged": document})
    return digest_of({key: value for key, value in document.items() if key != "baseline"})
