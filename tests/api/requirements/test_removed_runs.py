"""What the sentence of a requirement states on removed runs: by the rule, and in the words, of runs that count."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db import purge
from backend.db.tables import Run
from backend.requirements.against import REMOVED
from tests.given.requirement_rows import AT, ran, row, sign
from tests.given.row_changes import changed
from tests.given.service import Service

VIOLATED = {"state": "done", "verdict": "violated"}
CANCELLED = {"state": "cancelled", "verdict": None}
LOWERED = "t a higher threshold, which was lowered since, R-0001 violated it"
CASES: list[tuple[Mapping[str, Any], str | None, str | None]] = [
    ({**VIOLATED, "threshold": 3.5, "worst_cost": 2.6}, LOWERED, LOWERED),
    ({**VIOLATED, "threshold": 3.5, "worst_cost": 0.4}, "R-0001 violates it", "asked the same, R-0001 violated it"),
    ({**VIOLATED, "threshold": 0.4, "worst_cost": 0.3}, "R-0001 violates it", "asked the same, R-0001 violated it"),
    ({**VIOLATED, "question": "other"}, "another model violated it: R-0001", "another model violated it: R-0001"),
    (
        {**VIOLATED, "flown": {"code": "b", "model": "b"}},
        "another model violated it: R-0001",
        "another model violated it: R-0001",
    ),
    (
        {**CANCELLED, "threshold": 3.5, "worst_cost": 0.4},
        "R-0001 found a value",
        "R-0001 found a value at or below the",
    ),
    ({**CANCELLED, "threshold": 3.5, "worst_cost": 2.6}, None, "a higher threshold, R-0001 found a value at or below"),
    ({"threshold": 0.3, "worst_cost": 0.4}, "R-0001 found a value", "R-0001 found a value at or below the"),
    ({"threshold": 0.3, "worst_cost": 0.9}, None, None),
    (
        {"verdict": "inconclusive", "later": 0.9},
        "R-0001 saw beyond the horizon",
        "asked the same, R-0001 saw beyond the horizon",
    ),
    ({"verdict": "inconclusive", "later": 2.0}, None, None),
]
"""Changes of the older run, and what is stated while it counts and once it is removed. The newer one has 0.5."""


def removed_and_purged(service: Service, client: httpx.Client, run: str) -> list[str]:
    """The sentences after its removal and after its purge."""
    assert client.delete(f"/api/v1/runs/{run}", params={"reason": "A trial."}).status_code == 200
    first = row(client, "REQ-1")["sentence"]
    assert purge.purge(service.engine, int(run[2:]), 0.0, "operator")
    return [str(first), str(row(client, "REQ-1")["sentence"])]


@pytest.mark.parametrize("case", CASES, ids=lambda case: str(sorted(case[0].items())))
def test_a_removed_run_is_stated_as_while_it_counted(
    service: Service, client: httpx.Client, case: tuple[Mapping[str, Any], str | None, str | None]
) -> None:
    changes, before, after = case
    ran(service, client, "REQ-1")
    sign(client, ran(service, client, "REQ-1"))
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == 1).values(**changes))
    sentence = str(row(client, "REQ-1")["sentence"])
    assert (before is None and "R-0001" not in sentence) or (before is not None and before in sentence), sentence
    for sentence in removed_and_purged(service, client, "R-0001"):
        assert (after is None and "R-0001" not in sentence) or (after is not None and after in sentence), sentence
    for name in ("requirements.csv", "requirements.reqif", "argument.gsn.yaml"):
        assert (after is None) or "R-0001" in client.get(f"{AT}/export/{name}").text


def test_a_removed_newer_run_met_a_higher_threshold_that_was_not_lowered_since(
    service: Service, client: httpx.Client
) -> None:
    sign(client, ran(service, client, "REQ-1"))
    ran(service, client, "REQ-1", verdict="violated")
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == 2).values(threshold=3.5, worst_cost=2.6))
    for sentence in removed_and_purged(service, client, "R-0002"):
        assert f"; {REMOVED['higher'].format('R-0002')}." in sentence


def test_removed_runs_are_compared_with_the_newest_of_them_where_none_counts(
    service: Service, client: httpx.Client
) -> None:
    ran(service, client, "REQ-1", verdict="violated")
    ran(service, client, "REQ-1")
    values = sa.update(Run).where(Run.id == 1).values(threshold=3.5, worst_cost=2.6)
    with changed(service.engine, values), changed(service.engine, sa.update(Run).values(removed=1.0)):
        found = row(client, "REQ-1")
        assert (found["status"], found["removed"]) == ("no evidence", 2)
        assert LOWERED in found["sentence"]
    with changed(service.engine, sa.update(Run).values(removed=1.0)):
        assert REMOVED["violated"].format("R-0001") in row(client, "REQ-1")["sentence"]
