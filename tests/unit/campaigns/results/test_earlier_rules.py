"""Which stored verdicts are cleared by earlier rules, and how a verdict in large states it."""

from __future__ import annotations

import pytest

from campaigns.claims.wording import CLEARING, WORDING
from campaigns.results.verdict import Provenance, VerdictWord, earlier_rules, headline
from tests import results
from tests.results import Marks
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


@pytest.mark.parametrize(
    ("marks", "policy", "rest"),
    [
        (Marks(), None, []),
        (Marks(True), None, ["not sampled"]),
        (Marks(False, True), "holds", ["earlier rules"]),
        (Marks(True, True), "fails", ["not sampled", "earlier rules", "policy fails"]),
    ],
)
def test_a_verdict_in_large(marks: Marks, policy: str | None, rest: list[str]) -> None:
    assert headline("cleared", marks, policy, "") == ": ".join(filter(None, ["cleared", ", ".join(rest)]))


def test_a_verdict_in_large_that_another_run_contradicts() -> None:
    stated = headline("cleared", Marks(True), "fails", "R-0002 violates the criterion.")
    assert stated.split(", ")[1:] == ["contradicted", "policy fails"]
