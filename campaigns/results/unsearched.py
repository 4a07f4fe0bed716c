"""Who found a case that no search found, in words: outside the code of a run, which they do not change."""

from __future__ import annotations

from collections.abc import Iterable

from campaigns.claims.stages.sample import STATED_SEED
from campaigns.results.finding import Validation
from campaigns.results.sample import Certificate
from campaigns.results.stage import StageResult


def certificate_of(results: Iterable[StageResult]) -> Certificate | None:
    """The sample of the certify stage, and where its seed came from."""
    return next((result.certificate for result in results if result.certificate is not None), None)


def unsearched(case: Validation | None, certificate: Certificate | None) -> str:
    """What to name as the finder of a case that no search found: only the sample draws noise for an evaluation."""
    if case is None or case.realisation is None:
        return "no search"
    stated = certificate is not None and not certificate.drawn_at_launch
    return f"a random sample{STATED_SEED}" if stated else "the independent sample"
