"""A stage that began and did not end is stated as such: a report infers nothing from a missing result."""

from __future__ import annotations

import re

import httpx
import pytest
import sqlalchemy as sa

from backend.db.queue import Queue
from backend.db.store import RunStore
from backend.db.tables import Run
from tests.given.reported_runs import PLAN
from tests.given.service import Service
from tests.given.submissions import submit
from tests.given.ways_to_store import WAYS

NO_BOUND = "no bound on the probability of a violation is claimed."
NO_SAMPLE = f"No independent random sample was simulated: {NO_BOUND}"
NO_CASE = "No case was validated: the numbers of this report are not confirmed independently."
DRAWN = "The independent sample is not finished: 2 of 3 000 planned draws were simulated"
SAMPLED = f"{DRAWN}, the lowest of which has {{}} m; {NO_BOUND}"
BEGUN = "Validation is not finished: 2 evaluations of it were made. The numbers of this report are not confirmed"
ONE_DRAWN = "The independent sample is not finished: 1 of 3 000 planned draws was simulated, and has 0.2 m; no bound"
ONE_MADE = "Validation is not finished: 1 evaluation of it was made. The numbers of this report are not confirmed"
CASES = [
    (2, [0.9, 0.2], "in order", [NO_SAMPLE, NO_CASE, "Nothing was validated."]),
    (3, [0.9, 0.2], "in order", [SAMPLED.format("0.2"), NO_CASE]),
    (3, [0.9, 0.4999999999], "counted", [SAMPLED.format("0.4999999999"), NO_CASE]),
    (3, [0.2], "in order", [ONE_DRAWN, NO_CASE]),
    (4, [0.9, 0.2], "in order", [NO_SAMPLE, BEGUN, "Validation is not finished."]),
    (4, [0.2], "in order", [NO_SAMPLE, ONE_MADE]),
]
"""The stage that ran, its values, the way they were stored, what the report states."""


@pytest.mark.parametrize(("position", "costs", "way", "stated"), CASES)
def test_the_state_of_a_stage_decides(
    service: Service, client: httpx.Client, position: int, costs: list[float], way: str, stated: list[str]
) -> None:
    run = submit(client)
    claim = Queue(service.engine).claim("w")
    assert claim is not None
    store = RunStore(service.engine, claim)
    store.plan(PLAN)
    store.begin(position)
    WAYS[way](store, position, costs)
    for state in ("running", "cancelled", "failed"):
        with service.engine.begin() as writer:
            writer.execute(sa.update(Run).values(state=state, finished=1.0))
        report = re.sub("<[^>]*>", "", client.get(f"/api/v1/runs/{run}/report.html").text)
        found = " ".join(report.replace("\u202f", " ").split())
        assert [one for one in stated if one not in found] == []
        assert (NO_SAMPLE in found, NO_CASE in found) == (NO_SAMPLE in stated, NO_CASE in stated)
