"""What comes out of a run, as types: the result of each stage, findings, the verdict with its checks, heads of flights.

The worker builds them, the store keeps them as JSON, the API declares them, report, command line and pages read them.
Start reading at `StageResult`.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, TypeAdapter

from campaigns.results.finding import Finding
from campaigns.results.nominal import NominalResult
from campaigns.results.sample import CertifyResult
from campaigns.results.search import SearchResult
from campaigns.results.sensitivity import SensitivityResult
from campaigns.results.trace import TraceHead
from campaigns.results.validate import ValidateResult
from campaigns.results.verdict import Verdict

__all__ = [
    "CertifyResult",
    "Finding",
    "NominalResult",
    "SearchResult",
    "SensitivityResult",
    "StageResult",
    "TraceHead",
    "ValidateResult",
    "Verdict",
    "stage_result",
]

StageResult = Annotated[
    NominalResult | SensitivityResult | SearchResult | CertifyResult | ValidateResult, Field(discriminator="stage")
]

_ADAPTER: TypeAdapter[StageResult] = TypeAdapter(StageResult)


def stage_result(stored: Any) -> StageResult:
    """A stored result as its type; raises pydantic's `ValidationError` where it is none."""
    return _ADAPTER.validate_python(stored)
