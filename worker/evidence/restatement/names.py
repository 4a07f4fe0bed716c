"""Names in the files of a run that no record has, which another reader shows and nothing compares; and names that every
record has and one lacks."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any

from pydantic import TypeAdapter, ValidationError

from campaigns.results.finding import Finding
from campaigns.results.likelihood import LikelyFinding, MostLikely
from campaigns.results.search import Minimum
from campaigns.results.verdict import Verdict
from campaigns.results.verdicts import DescribedCheck
from campaigns.stages.found import AnyResult
from worker.evidence.audit.record import Record

OF_VERDICT = ("statistics", "nominal", "worst", "evaluations", "regression", "sureness")
Form = Any
"""A type that pydantic reads values as."""
FORMS: dict[str, Form] = {
    "checks": list[DescribedCheck],
    "findings": list[LikelyFinding | Finding],
    "most_likely_violation": MostLikely,
    **{name: Verdict.model_fields[name].annotation for name in OF_VERDICT},
}
"""By its name, the form of a part of result.json."""
LABEL = {"finding": ""}
"""Of the worst case, which in a folder is found by its values."""
GRANTED = "granted"
"""Of a finding in a folder, the value to state for it, which otherwise follows from its validation."""
STAGE = {"kind", "method", "best", "evaluations", "failed", "excluded", "seconds", "stop", "minima"}
FAILURE = {"status", "reason", "stage", "index", "output", "evaluations"}


def beyond(record: Record) -> list[str]:
    """The paths of names in a folder that no record has, and of those that are absent; in a database nothing reads or
    shows what has no name.

    Parts of another form are not looked at: the audit reports them.
    """
    claims = record.claims
    if "versions" not in claims:
        return []
    found: list[str] = []
    stated = claims | ({"worst": LABEL | claims["worst"]} if isinstance(claims.get("worst"), dict) else {})
    each = [one for one in claims.get("findings") or () if isinstance(one, dict)]
    stated |= {"findings": [{name: value for name, value in one.items() if name != GRANTED} for one in each]}
    for name, form in FORMS.items():
        found += _unknown(name, stated.get(name), form)
    for k, result in enumerate(claims.get("results") or ()):
        found += _unknown(f"results.{k}", result, AnyResult)
    for k, stage in enumerate(claims.get("stages") or ()):
        found += [f"stages.{k}.{name}" for name in sorted(stage.keys() - STAGE)]
        found += _unknown(f"stages.{k}.minima", stage.get("minima"), list[Minimum])
    for k, lost in enumerate(claims.get("failures") or ()):
        found += [f"failures.{k}.{name}" for name in sorted(lost.keys() - FAILURE)]
    return found


@cache
def _adapter(form: Form) -> TypeAdapter[Any]:
    return TypeAdapter(form)


def _unknown(name: str, stated: Any, form: Form) -> list[str]:
    if stated is None:
        return []
    try:
        written = _adapter(form).dump_python(_adapter(form).validate_python(stated), mode="json")
    except ValidationError:
        return []
    return [*_beside(stated, written, name), *(f"no {absent}" for absent in _beside(written, stated, name))]


def _beside(stated: Any, written: Any, path: str) -> Iterator[str]:
    """What is stated under a name that is not written; the other way round, what is absent. What is equal has the same
    names: most of a record."""
    if stated == written:
        return
    if isinstance(stated, dict) and isinstance(written, dict):
        yield from (f"{path}.{name}" for name in sorted(stated.keys() - written.keys()))
        for name in stated.keys() & written.keys():
            yield from _beside(stated[name], written[name], f"{path}.{name}")
    elif isinstance(stated, list) and isinstance(written, list):
        for k, (one, other) in enumerate(zip(stated, written, strict=False)):
            yield from _beside(one, other, f"{path}.{k}")
