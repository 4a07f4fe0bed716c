"""The types of a run's results: what stages have in common, findings, the verdict with its checks, trace headers.

The worker builds them, the store writes them as JSON, the API declares them; report, command line and pages read them.
"""

from __future__ import annotations

from campaigns.results.finding import Finding
from campaigns.results.search import SearchResult
from campaigns.results.stage import StageResult
from campaigns.results.trace import TraceHead
from campaigns.results.validate import ValidateResult
from campaigns.results.verdict import Verdict

__all__ = [
    "Finding",
    "SearchResult",
    "StageResult",
    "TraceHead",
    "ValidateResult",
    "Verdict",
]
