"""The types of a run's results: the result of each stage, findings, the verdict with its checks, trace headers.

The worker builds them, the store writes them as JSON, the API declares them; report, command line and pages read them.
"""

from __future__ import annotations

from campaigns.results.finding import Finding
from campaigns.results.nominal import NominalResult
from campaigns.results.sample import CertifyResult
from campaigns.results.search import SearchResult
from campaigns.results.sensitivity import SensitivityResult
from campaigns.results.stage import StageResult
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
]
