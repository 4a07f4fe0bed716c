"""Texts of a record are judged as the version of its sentences wrote numbers."""

from __future__ import annotations

import pytest

from campaigns.claims.say import probability, say
from campaigns.claims.spans import words
from campaigns.claims.wording import WORDING
from worker.evidence.audit import limits
from worker.evidence.audit.sentences import unlike, worded

NEARLY = say("at ", probability(4095 / 4096), " of all, and ", probability(0.25))
BEFORE = "at 100 % of all, and 25 %"


@pytest.mark.parametrize(
    ("text", "version", "agrees"),
    [
        (words(NEARLY), WORDING, True),
        (words(NEARLY), limits.GRANTED - 1, True),  # read again by this version
        (BEFORE, limits.GRANTED - 1, True),
        (BEFORE, 0, True),
        (BEFORE, WORDING, False),
        ("at 100 % of all, and 26 %", limits.GRANTED - 1, False),
    ],
)
def test_nearly_all_is_100_percent_only_in_records_of_versions_that_wrote_it_so(
    text: str, version: int, agrees: bool
) -> None:
    document = {"checks": [{"statement": [span.model_dump() for span in NEARLY], "text": text}]}
    assert ([*unlike(document, version)] == []) == agrees
    assert (worded(text, NEARLY, version) == text) == agrees
