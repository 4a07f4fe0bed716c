"""Discovers the kinds of stages, and combines their results in one type."""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache, reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field, TypeAdapter, WithJsonSchema

import campaigns.stages
from campaigns.results.stage import StageResult
from campaigns.stages.declared import Declared

OTHERS = ("found", "plan")
"""Modules of the folder that declare no kind and need all kinds."""


@cache
def declared() -> dict[str, Declared]:
    """Every kind of stage in the order of a run; a duplicate kind is an error."""
    found: list[Declared] = []
    for name in sorted({info.name for info in pkgutil.iter_modules(campaigns.stages.__path__)}.difference(OTHERS)):
        stage = getattr(importlib.import_module(f"campaigns.stages.{name}"), "stage", None)
        if isinstance(stage, Declared):
            found.append(stage)
    kinds = [stage.kind for stage in found]
    if len(set(kinds)) < len(kinds):
        raise ValueError(f"two modules of campaigns.stages declare the same kind of stage: {', '.join(sorted(kinds))}")
    return {stage.kind: stage for stage in sorted(found, key=lambda stage: stage.order)}


if TYPE_CHECKING:
    AnyResult = StageResult
    StageKind = str
else:
    AnyResult = Annotated[reduce(or_, (s.result for s in declared().values())), Field(discriminator="stage")]
    """A discriminated union by kind, so that the API describes every result."""
    StageKind = Annotated[str, WithJsonSchema({"type": "string", "enum": list(declared())})]

_ADAPTER: TypeAdapter[StageResult] = TypeAdapter(AnyResult)


def stage_result(stored: Any) -> StageResult:
    """A stored result as its type; raises pydantic's `ValidationError` if it is invalid."""
    return _ADAPTER.validate_python(stored)
