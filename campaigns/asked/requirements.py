"""The requirements that a criterion is evidence for, and the digest by which a campaign that states them has changed.

An id names a requirement in the tool that it was written in.
"""

from __future__ import annotations

from collections.abc import Mapping
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


def definition(document: Any) -> str:
    """SHA-256 of a stored campaign without the baseline, which is added at launch: equal for every launch of a file.

    document: also a damaged one, which is no mapping.
    """
    if not isinstance(document, Mapping):
        return digest_of({"damaged": document})
    return digest_of({key: value for key, value in document.items() if key != "baseline"})
