"""Methods and budgets proposed for a simulator from what its evaluations took in earlier runs."""

from __future__ import annotations

import time
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.catalog.service import required
from backend.db import workers
from backend.db.tables import Run
from campaigns.asked.proposal import Cost, lasting
from campaigns.catalogue import Catalogue
from campaigns.checked.expected import confirmation
from tests.given.openapi_document import conforms
from tests.given.problem_documents import problem
from tests.given.service import Service
from tests.given.timed_simulators import ENTRY, measured, publish, run

ASKED = "/api/v1/simulators/two_basins/proposal"


def asked(client: httpx.Client, **query: Any) -> dict[str, Any]:
    answer = client.get(ASKED, params={"parameters": 2} | query)
    assert answer.status_code == 200, answer.text
    conforms(answer.json(), {"$ref": "#/components/schemas/Proposal"})
    return dict(answer.json())


@pytest.fixture
def client(bare: Service) -> Any:
    publish(bare)
    with bare.signed_in() as client:
        yield client


def test_the_newest_run_of_the_same_files_is_named(bare: Service, client: httpx.Client) -> None:
    unknown = asked(client)
    assert (unknown["measured"], unknown["searches"], unknown["sentence"]) == (None, [], "")
    assert unknown["known"] == (
        "The time of an evaluation is not measured yet: the first stage of a run measures it, and so does "
        "`clearance check-simulator two_basins --data DIR` for the service of that folder."
    )
    run(bare, "aa", None)  # of a version that did not measure it
    assert asked(client)["measured"] is None
    run(bare, "aa", measured())
    found = asked(client)
    assert found["measured"].pop("at") == pytest.approx(time.time(), abs=60)
    counts = {"seconds": 0.42, "slots": 2, "evaluations": 15, "failed": 0}
    assert found["measured"] == {"run": "R-0002", "source": "R-0002", "host": ""} | counts
    cost = Cost("R-0002", 0.42, 2, 15)
    assert found["known"] == f"{cost.sentence()}."
    with bare.engine.connect() as reader:
        methods = required(reader).methods
    assert found["sentence"] == f"{cost.proposed(methods, 2, 3600.0).sentence}. {confirmation(cost, 1)}"
    assert found["searches"][0] == {"method": "auto", "evaluations": 10_000, "options": {"at_once": 2, "seconds": 0.42}}
    assert found["seconds"] == pytest.approx(5000 * 0.42)
    run(bare, "aa", measured(call_seconds=12.0, failed=3))
    assert asked(client)["known"] == "One evaluation took 12 s (R-0003, 15 evaluations, of which 3 failed)."


def test_the_start_of_processes_counts(bare: Service, client: httpx.Client) -> None:
    """That of the slots once, the replacements, and the fresh processes that confirm results."""
    run(bare, "aa", measured(call_seconds=10.0, slots=2, start_seconds=30.0, recycle=10))
    found = asked(client)
    cost = Cost("R-0001", 10.0, 2, 15, start=30.0, recycle=10)
    assert found["known"] == f"{cost.sentence()}."
    assert found["seconds"] <= 3600.0
    each, asked_for = 13.0, sum(s["evaluations"] for s in found["searches"])
    assert found["seconds"] == pytest.approx(30.0 + asked_for / 2 * each)
    assert " 550 " in found["sentence"]
    assert found["sentence"].endswith(f" {confirmation(cost, 1)}")
    assert f" {lasting(100 * 40.0)} " in confirmation(cost, 1)


def test_what_other_files_took_is_not_what_these_take(bare: Service, client: httpx.Client) -> None:
    run(bare, "aa", measured(call_seconds=1.0))
    run(bare, "bb", measured(call_seconds=3.0))
    # The second run began after the digest was published, so that it has seen newer files than that.
    assert asked(client)["measured"]["run"] == "R-0002"
    publish(bare, "aa")
    assert asked(client)["measured"]["run"] == "R-0001"
    publish(bare, "cc")
    found = asked(client)
    assert (found["measured"], found["searches"]) == (None, [])
    assert "R-0002" in found["known"]
    assert " 3 s" in found["known"]
    publish(bare, None)  # of a package that opens its simulator itself no digest is known
    assert asked(client)["measured"]["run"] == "R-0002"
    publish(bare, "bb", ENTRY.model_copy(update={"results": ENTRY.results[:1]}))
    assert asked(client)["measured"] is None


def test_the_digests_of_other_live_workers_stay(bare: Service, client: httpx.Client) -> None:
    none = Catalogue(version="1", components=[], methods=[])
    with bare.engine.begin() as connection:
        workers.arrive(connection, "with")
        workers.beat(connection, "with", None, [ENTRY.version])
        workers.publish(connection, none)
    found = client.get("/api/v1/components").json()
    assert (found["digests"], [s["name"] for s in found["simulators"]]) == ({ENTRY.name: "aa"}, [ENTRY.name])
    with bare.engine.begin() as connection:
        workers.leave(connection, "with")
        workers.publish(connection, none)
    assert "digests" not in client.get("/api/v1/components").json()


def test_a_removed_run_is_not_named(bare: Service, client: httpx.Client) -> None:
    run(bare, "aa", measured())
    with bare.engine.begin() as connection:
        connection.execute(sa.update(Run).values(removed=1.0))
    assert asked(client)["measured"] is None


def test_calls_of_an_evaluation_share_the_slots(bare: Service, client: httpx.Client) -> None:
    run(bare, "aa", measured(call_seconds=10.0, slots=4))
    found = asked(client, calls=5)
    assert found["known"] == f"{Cost('R-0001', 10.0, 4, 15).sentence(5)}."
    assert " 180 " in found["sentence"]
    assert {s["evaluations"] for s in found["searches"]} == {180}


def test_too_little_time_is_reported(bare: Service, client: httpx.Client) -> None:
    run(bare, "aa", measured(call_seconds=100.0))
    found = asked(client, patience=60)
    assert (found["searches"], found["seconds"]) == ([], None)
    assert all(f" {lasting(seconds)}" in found["sentence"] for seconds in (100, 60))


@pytest.mark.parametrize(
    "query",
    [{"parameters": 0}, {"patience": 0}, {"patience": "nan"}, {"patience": "inf"}, {"calls": 0}, {"parameters": "x"}],
)
def test_impossible_questions_are_refused(guest: httpx.Client, query: dict[str, Any]) -> None:
    problem(guest.get(ASKED, params={"parameters": 2} | query), 422)


def test_an_unknown_simulator_is_not_found(client: httpx.Client) -> None:
    answer = client.get("/api/v1/simulators/none/proposal", params={"parameters": 2})
    assert "'none'" in str(problem(answer, 404, "not-found")["detail"])
