"""What `clearance check-simulator` stored is used by the service's proposals and estimates, with machine and time."""

from __future__ import annotations

import re
import socket
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db import costs
from backend.db.tables import SimulatorMeasurement
from campaigns.catalogue import SimulatorEntry
from tests.given.service import Service
from tests.given.timed_simulators import ENTRY, measured, publish, run
from tests.simulators import package

ASKED = "/api/v1/simulators/two_basins/proposal"


def check(service: Service, digest: str, entry: SimulatorEntry = ENTRY, **values: Any) -> None:
    """What the command stores."""
    with service.engine.begin() as writer:
        costs.store(writer, entry, digest, measured(**values))


@pytest.fixture
def client(bare: Service) -> Any:
    publish(bare)
    with bare.signed_in() as client:
        yield client


def proposed(client: httpx.Client) -> dict[str, Any]:
    return dict(client.get(ASKED, params={"parameters": 2}).json())


def test_a_proposal_rests_on_it_and_names_machine_and_time(bare: Service, client: httpx.Client) -> None:
    check(bare, "aa", call_seconds=0.42, failed=1)
    found = proposed(client)
    source = found["measured"]["source"]
    when = r"\d{4}-\d\d-\d\d \d\d:\d\d UTC"
    assert re.fullmatch(rf"clearance check-simulator on {re.escape(socket.gethostname())}, {when}", source)
    assert (found["measured"]["run"], found["measured"]["host"]) == (None, socket.gethostname())
    assert found["known"] == f"One evaluation took 420 ms ({source}, 15 evaluations, of which 1 failed)."
    assert found["searches"]


def test_the_estimate_of_a_campaign_rests_on_it(
    bare: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("backend.catalog.service.check", lambda campaign, catalogue: [])  # it has no methods
    check(bare, "aa", call_seconds=0.5, slots=2)
    told = client.post("/api/v1/campaigns/check", json={"campaign": package.campaign()}).json()["estimate"]
    assert " 500 ms (clearance check-simulator on " in told["time_statement"]
    assert ", 15 evaluations), on 2 slots; " in told["time_statement"]
    assert told["seconds"] == 0.5 * (-(-told["evaluations"] // 2) + 101)


def test_of_a_run_and_the_command_the_newer_one_counts(bare: Service, client: httpx.Client) -> None:
    check(bare, "aa", call_seconds=1.0)
    run(bare, "aa", measured(call_seconds=2.0))
    assert proposed(client)["measured"]["run"] == "R-0001"
    check(bare, "aa", call_seconds=3.0)
    assert (proposed(client)["measured"]["run"], proposed(client)["measured"]["seconds"]) == (None, 3.0)


def test_only_the_same_files_and_declaration_count(bare: Service, client: httpx.Client) -> None:
    check(bare, "bb", call_seconds=3.0)  # newer than what the worker published, but perhaps of another folder
    found = proposed(client)
    assert (found["measured"], found["searches"]) == (None, [])
    assert " clearance check-simulator on " in found["known"]
    assert " 3 s;" in found["known"]
    publish(bare, "bb")
    assert proposed(client)["measured"]["seconds"] == 3.0
    wider = [each.model_copy(update={"high": each.high + 1.0}) for each in ENTRY.parameters]
    check(bare, "bb", ENTRY.model_copy(update={"parameters": wider}), call_seconds=9.0)
    assert proposed(client)["measured"]["seconds"] == 3.0
    check(bare, "bb", ENTRY.model_copy(update={"title": "The same in other words"}), call_seconds=4.0)
    assert proposed(client)["measured"]["seconds"] == 4.0


def test_the_newest_of_the_same_files_replaces_the_earlier_one(bare: Service, client: httpx.Client) -> None:
    for seconds in (1.0, 2.0):
        check(bare, "aa", call_seconds=seconds)
    check(bare, "bb")
    assert proposed(client)["measured"]["seconds"] == 2.0
    with bare.engine.connect() as reader:
        assert reader.scalar(sa.select(sa.func.count()).select_from(SimulatorMeasurement)) == 2


def test_one_without_a_time_or_of_another_version_is_passed_over(bare: Service, client: httpx.Client) -> None:
    check(bare, "aa", call_seconds=None, slots=None)
    assert proposed(client)["measured"] is None
    with bare.engine.begin() as writer:
        writer.execute(sa.update(SimulatorMeasurement).values(result={"of": "a later version"}))
    assert proposed(client)["measured"] is None
