"""What the address of a submission adds to its body: labels, baseline, reuse. A YAML body has no place for them."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Query
from pydantic import ValidationError

from backend.http.errors import mismatch, problem_of
from backend.runs.requests import RunSubmit
from campaigns import CampaignError, Problem
from campaigns.labels import MOST, parsed


@dataclass(frozen=True)
class AddressParts:
    """The parts of a submission that its address gives; empty if it gives none."""

    parts: Mapping[str, object]

    def with_body(self, body: RunSubmit) -> RunSubmit:
        """The submission with both; raises `CampaignError` for a part that is given twice."""
        twice = [name for name in self.parts if name in body.model_fields_set]
        if twice:
            message = "given in the address and in the body: give it once"
            raise CampaignError("request", [Problem(name, "", message) for name in twice])
        return body.model_copy(update=self.parts)

    def digest(self, body: bytes) -> str:
        """The digest of the whole request: it distinguishes a repeated request from another one with the same key."""
        address = b"\0" + json.dumps(self.parts, sort_keys=True).encode() if self.parts else b""
        return hashlib.sha256(body + address).hexdigest()


def address_parts(
    label: Annotated[
        list[str] | None,
        Query(max_length=MOST, description="Labels as KEY=VALUE, such as branch=main; repeat it for each."),
    ] = None,
    baseline: Annotated[
        str | None, Query(description="The run with which this one is compared: R-0001, or label:branch=main.")
    ] = None,
    reuse: Annotated[
        bool, Query(description="Answer with an earlier run of the same campaign and code that has a verdict.")
    ] = False,
    sample_seed: Annotated[
        int | None, Query(description="Repeats the independent sample of an earlier run, which states its seed.")
    ] = None,
    group: Annotated[
        str | None,
        Query(
            description="A concurrency group: runs of the same group that have not ended are cancelled, if the "
            "submitter may cancel them."
        ),
    ] = None,
    priority: Annotated[int | None, Query(ge=-10, le=10, description="Runs with a higher one start first.")] = None,
) -> AddressParts:
    """The parts of a submission that its address gives; 422 with a sentence for what is not allowed."""
    try:
        labels = parsed(label) if label else None
    except ValueError as error:
        raise mismatch([Problem("label", "", f"{error}")]) from None
    query_parameters: Mapping[str, object] = {
        "labels": labels,
        "baseline": baseline,
        "reuse": reuse or None,
        "sample_seed": sample_seed,
        "group": group,
        "priority": priority,
    }
    parts = {name: value for name, value in query_parameters.items() if value is not None}
    try:
        RunSubmit.model_validate({"campaign": {}, **parts})
    except ValidationError as error:
        raise mismatch([problem_of(e, e["loc"]) for e in error.errors(include_url=False)]) from None
    return AddressParts(parts)


FromAddress = Annotated[AddressParts, Depends(address_parts)]
