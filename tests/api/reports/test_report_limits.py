"""What the report says of validation and of the time after the horizon is what was done."""

from __future__ import annotations

import html
import re
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db import rows
from backend.db.tables import Run, Stage
from campaigns.results.finding import Calls, Neighbours
from campaigns.results.validate import Beyond
from campaigns.results.verdict import Check
from tests import results
from tests.given import declared_traces, reported_runs
from tests.given.service import Service
from tests.given.submissions import submit
from tests.given.verdict_evidence import encountered

SEEN = Neighbours(flown=300, failed=0, lowest=1.31, lower_by=0.0)


def report(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch, seen: tuple[bool, bool] = (True, True),
    **validated: Any,
) -> str:  # fmt: skip
    """The text of the report of a run with two findings; seen: of which the neighbours were evaluated."""
    made = reported_runs.validated().model_copy(update=validated)
    monkeypatch.setattr(reported_runs, "validated", lambda: made)
    found = [
        results.finding(
            f"F{k + 1}", 1.3, 0.8, reported_runs.PARAMETERS,
            validation=results.validation(f"F{k + 1}", neighbours=SEEN if by else None),
        )
        for k, by in enumerate(seen)
    ]  # fmt: skip
    run = submit(client)
    reported_runs.finish_fully(service, found=found)
    return plain(client, run)


def plain(client: httpx.Client, run: str) -> str:
    text = client.get(f"/api/v1/runs/{run}/report.html").text
    return html.unescape(re.sub(r"<[^>]+>", "", text.replace("</li>", "\n")))


@pytest.mark.parametrize("seen", [(True, True), (True, False), (False, True), (False, False)])
def test_only_neighbourhoods_that_were_evaluated_are_stated(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch, seen: tuple[bool, bool]
) -> None:
    (stated,) = re.findall(r"Validation covers .*", report(service, client, monkeypatch, seen))
    assert ("neighbourhood of each" in stated) == any(seen)
    without = [f"F{k + 1}" for k, by in enumerate(seen) if not by]
    assert re.findall(r"F\d", stated) == (without if any(seen) else [])


@pytest.mark.parametrize(
    ("numbers", "examined"),
    [
        (None, ["15"]),
        ({"flights": 1424, "not_continued": 56789}, ["15", "1424", "9", "56789"]),
        ({"flights": 302, "not_continued": 0}, ["15", "302", "9"]),
        ({"flights": 302, "not_continued": None}, ["15", "302", "9"]),
    ],
    ids=["none", "some left out", "all", "earlier version"],
)
def test_how_many_flights_are_examined_after_the_horizon_is_what_was_simulated_on(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch, numbers: dict[str, Any] | None,
    examined: list[str],
) -> None:  # fmt: skip
    beyond = None if numbers is None else Beyond(times=2.0, closer=0, lowest=None, **numbers)
    text = report(service, client, monkeypatch, encounter=encountered(beyond=beyond))
    (stated,) = re.findall(r"Every evaluation ends at .*", text)
    assert re.findall(r"\d+", stated.replace("\u202f", "")) == examined
    assert ("the sample only" in stated) == (numbers is not None and numbers["not_continued"] is None)


def test_what_a_violation_requires_of_independent_calls_is_no_value_of_the_search(
    bare: Service,
) -> None:
    """A finding above the criterion of which a call violates is a violation."""
    calls = Calls(statement=(), values=[1.3] * 10, violating=0, failed=0, confidence=0.95, low=0.0, high=0.3)
    validated = results.validated().model_copy(update={"nominal": results.validation("nominal", repeats=calls)})
    check = Check(code="nominal", ok=True, statement=results.statement("it holds"))
    with bare.signed_in() as client:
        run = declared_traces.declared(bare, client, plan=reported_runs.PLAN)
        with bare.engine.begin() as writer:
            ended = sa.update(Stage).where(Stage.kind == "validate")
            writer.execute(ended.values(state="done", result=rows.plain(validated)))
            summary = writer.execute(sa.select(Run.summary)).scalar_one() | {"checks": [rows.plain(check)]}
            writer.execute(sa.update(Run).values(summary=summary))
        text = plain(client, run)
    (requires,) = re.findall(r"“violated” requires (.*?);", text)
    assert "independent calls" in requires
    assert "at or below" not in requires
