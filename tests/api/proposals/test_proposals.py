"""Methods and budgets proposed for a simulator from what its evaluations took in earlier runs."""

from __future__ import annotations

import time
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db import workers
from backend.db.tables import Run
from campaigns.asked.proposal import lasting
from campaigns.catalogue import Catalogue
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
    assert found["known"] == "One evaluation took 420 ms (R-0002, 15 evaluations)."
    assert found["sentence"] == (
        "In 60 min on 2 slots: about 17,000 evaluations. "
        "Proposed: lq-CMA-ES, DIRECT and CMA-ES with 5,000 each, about 52 min in all. Up to 200 random evaluations are "
        "made again to confirm results: about 42 s more."
    )
    assert found["searches"][0] == {"method": "lq_cma_es", "evaluations": 5000, "options": {"at_once": 2}}
    assert found["seconds"] == pytest.approx(3 * 2500 * 0.42)
    run(bare, "aa", measured(call_seconds=12.0, failed=3))
    assert asked(client)["known"] == "One evaluation took 12 s (R-0003, 15 evaluations, 3 of them failed)."


def test_the_start_of_processes_counts(bare: Service, client: httpx.Client) -> None:
    """That of the slots once, the replacements, and the fresh processes that confirm results."""
    run(bare, "aa", measured(call_seconds=10.0, slots=2, start_seconds=30.0, recycle=10))
    found = asked(client)
    assert found["known"] == "One evaluation took 10 s (R-0001, 15 evaluations) and the start of a process 30 s."
    assert found["seconds"] <= 3600.0
    each, asked_for = 13.0, sum(s["evaluations"] for s in found["searches"])
    assert found["seconds"] == pytest.approx(30.0 + asked_for / 2 * each)
    assert found["sentence"].startswith("In 60 min on 2 slots: about 550 evaluations. ")
    assert found["sentence"].endswith(f"each in a fresh process, to confirm results: about {lasting(100 * 40.0)} more.")


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
    assert found["known"].endswith("Its files have changed since R-0002, in which one call took 3 s.")
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
    assert found["known"] == ("One call took 10 s (R-0001, 15 evaluations); an evaluation of 5 calls takes about 20 s.")
    assert found["sentence"].startswith("In 60 min on 4 slots: about 180 evaluations. Proposed: ")
    assert {s["evaluations"] for s in found["searches"]} == {90}


def test_too_little_time_is_reported(bare: Service, client: httpx.Client) -> None:
    run(bare, "aa", measured(call_seconds=100.0))
    found = asked(client, patience=60)
    assert (found["searches"], found["seconds"]) == ([], None)
    assert found["sentence"] == (
        f"One evaluation takes about {lasting(100)}, longer than the 60 s that are available: allow more time."
    )


@pytest.mark.parametrize(
    "query",
    [{"parameters": 0}, {"patience": 0}, {"patience": "nan"}, {"patience": "inf"}, {"calls": 0}, {"parameters": "x"}],
)
def test_impossible_questions_are_refused(guest: httpx.Client, query: dict[str, Any]) -> None:
    problem(guest.get(ASKED, params={"parameters": 2} | query), 422)


def test_an_unknown_simulator_is_not_found(client: httpx.Client) -> None:
    assert "no simulator called 'none'" in str(
        problem(client.get("/api/v1/simulators/none/proposal", params={"parameters": 2}), 404)["detail"]
    )
