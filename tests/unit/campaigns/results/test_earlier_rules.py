"""Which stored verdicts are cleared by earlier rules, and how a verdict in large states it."""

from __future__ import annotations

from typing import NamedTuple

import pytest

from campaigns.claims.wording import CLEARING, WORDING
from campaigns.results.verdict import Provenance, VerdictWord, earlier_rules, headline
from tests import results
from worker.evidence.audit import limits


def test_the_audit_has_the_same_version() -> None:
    assert CLEARING == limits.CLEARING <= limits.RULES <= WORDING


@pytest.mark.parametrize("version", [None, *range(WORDING + 2)])
@pytest.mark.parametrize("word", VerdictWord)
def test_what_earlier_rules_cleared(word: VerdictWord, version: int | None) -> None:
    earlier = word == VerdictWord.CLEARED and (version is None or version < limits.CLEARING)
    assert earlier_rules(word, version) == earlier
    verdict = results.verdict(word, provenance=Provenance(wording=version), checks=[])
    assert verdict.earlier_rules == earlier
    assert ("earlier rules" in verdict.headline) == earlier
    assert "earlier_rules" not in verdict.model_dump(), "it is no part of a result: that is of one version"


class Marks(NamedTuple):
    not_sampled: bool | None = None
    earlier_rules: bool | None = None


@pytest.mark.parametrize(
    ("marks", "policy", "stated"),
    [
        (Marks(), None, "cleared"),
        (Marks(True), None, "cleared: not sampled"),
        (Marks(False, True), "holds", "cleared: earlier rules"),
        (Marks(True, True), "fails", "cleared: not sampled, earlier rules, policy fails"),
        (Marks(), "fails", "cleared, policy fails"),
    ],
)
def test_a_verdict_in_large(marks: Marks, policy: str | None, stated: str) -> None:
    assert headline("cleared", marks, policy) == stated
