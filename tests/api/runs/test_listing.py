"""The run list: search, filters, counts, orders, and stable pages."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from tests.api.conftest import running
from tests.given.databases import KINDS, Fresh
from tests.given.full_databases import fill
from tests.given.problem_documents import problem
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.submissions import submit


@pytest.fixture(scope="module", params=KINDS)
def crowd(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    """A client of a service with fifty runs, read-only."""
    fresh: Fresh = request.getfixturevalue(f"fresh_{request.param}")
    with running(fresh, tmp_path_factory.mktemp("crowd")) as service:
        service.publish()
        fill(service, 50)
        with service.signed_in() as guest:
            yield guest


def walk(client: httpx.Client, **query: Any) -> list[dict[str, Any]]:
    """Every page of a list, one after the other."""
    found: list[dict[str, Any]] = []
    cursor: dict[str, str] = {}
    while True:
        page = client.get("/api/v1/runs", params={**query, **cursor}).json()
        found += page["items"]
        if page["next_cursor"] is None:
            return found
        cursor = {"cursor": page["next_cursor"]}


COLUMNS = {
    "created": "created", "started": "started", "finished": "finished", "name": "name", "campaign": "campaign_name",
    "owner": "owner", "tags": "tags", "state": "state", "verdict": "verdict", "method": "worst_method",
    "margin": "margin", "worst": "worst_cost", "nominal": "nominal_cost", "criterion": "threshold",
    "bound": "upper_bound", "evaluations": "evaluations", "failed": "failed_evaluations",
}  # fmt: skip
SORTS = (*COLUMNS, "duration")


ORDERS = (*SORTS, *(f"-{s}" for s in SORTS))
BY_DAY = ("created", "name", "tags", "-margin", "-duration")
"""On PostgreSQL: numbers with and without values, text, lists, and what is computed."""
ONE_WAY = [f"{'-' * (k % 2)}{column}" for k, column in enumerate(SORTS)]


def _orders() -> Iterator[Any]:
    """By day every column is sorted in one of the two orders."""
    for kind in KINDS:
        for order in ORDERS:
            at_night = order not in (BY_DAY if kind != KINDS[0] else ONE_WAY)
            yield pytest.param(kind, order, marks=[pytest.mark.nightly] if at_night else [])


@pytest.mark.by_day(8)
@pytest.mark.parametrize(("crowd", "sort"), list(_orders()), indirect=["crowd"])
def test_pages_together_are_the_whole_list_in_order(crowd: httpx.Client, sort: str) -> None:
    runs = walk(crowd, sort=sort, limit=17)
    assert sorted(r["id"] for r in runs) == [f"R-{i:04d}" for i in range(1, 51)]
    if sort.endswith("duration"):
        values = [None if r["finished"] is None else r["finished"] - r["started"] for r in runs]
    else:
        values = [r[COLUMNS[sort.lstrip("-")]] for r in runs]
    told = [v for v in values if v is not None]
    assert told == sorted(told, reverse=sort.startswith("-"))
    assert values == told + [None] * (len(values) - len(told))


def test_pinned_runs_come_first_in_every_order(service: Service, client: httpx.Client) -> None:
    fill(service, 20, pinned=(3, 8))
    for sort, first in (("-created", ["R-0009", "R-0004"]), ("created", ["R-0004", "R-0009"]), ("-margin", ["R-0009"])):
        runs = walk(client, sort=sort, limit=3)
        assert len({r["id"] for r in runs}) == len(runs) == 20
        assert [r["id"] for r in runs][: len(first)] == first
        assert [r["pinned"] for r in runs] == [True] * 2 + [False] * 18
    assert len(walk(client, pinned=True)) == 2


def test_a_page_keeps_its_position_while_runs_are_submitted(service: Service, client: httpx.Client) -> None:
    fill(service, 10)
    first = client.get("/api/v1/runs", params={"limit": 5}).json()
    submit(client, seed=7)
    second = client.get("/api/v1/runs", params={"limit": 5, "cursor": first["next_cursor"]}).json()
    assert [r["id"] for r in first["items"] + second["items"]] == [f"R-{i:04d}" for i in range(10, 0, -1)]


def test_filters_select_runs_and_counts_follow(service: Service, client: httpx.Client) -> None:
    fill(service, 50)
    page = client.get("/api/v1/runs", params={"state": "done", "verdict": "violated", "tag": "odd"}).json()
    assert len(page["items"]) == 5
    assert {r["verdict"] for r in page["items"]} == {"violated"}
    assert (page["counts"]["total"], page["counts"]["violated"], page["counts"]["cleared"]) == (25, 5, 5)
    several = client.get("/api/v1/runs", params={"state": ["queued", "failed"]}).json()["items"]
    assert {r["state"] for r in several} == {"queued", "failed"}


@pytest.mark.by_day(6)
@pytest.mark.parametrize(
    ("query", "count"),
    [
        ({"owner": "bob"}, 17),
        ({"owner": ["bob", "ada"]}, 50),
        ({"campaign": "Unicycle past a pillar"}, 50),
        ({"campaign": "Unicycle past a pilla"}, 0),
        ({"method": "sqp"}, 10),
        ({"tag": ["odd", "even"]}, 50),
        ({"tag": "od"}, 0),
        ({"q": "50%_", "owner": "bob", "tag": "odd"}, 8),
        ({"pinned": True}, 0),
    ],
)
def test_filters_by_campaign_owner_method_and_tag(crowd: httpx.Client, query: dict[str, Any], count: int) -> None:
    page = crowd.get("/api/v1/runs", params={**query, "limit": 200}).json()
    assert (len(page["items"]), page["counts"]["total"]) == (count, count)


def test_dates_select_runs(crowd: httpx.Client) -> None:
    created = [r["created"] for r in walk(crowd, sort="created")]
    assert [r["created"] for r in walk(crowd, sort="created", since=created[30])] == created[30:]
    assert [r["created"] for r in walk(crowd, sort="created", since=created[10], until=created[30])] == created[10:30]


def test_facets_say_what_the_list_can_be_narrowed_to(crowd: httpx.Client) -> None:
    facets = crowd.get("/api/v1/runs/facets").json()
    assert facets["campaigns"] == [{"value": campaign()["name"], "runs": 50}]
    assert facets["owners"] == [{"value": "ada", "runs": 33}, {"value": "bob", "runs": 17}]
    assert facets["tags"] == [
        {"value": "50%_", "runs": 50},
        {"value": "even", "runs": 25},
        {"value": "odd", "runs": 25},
    ]
    assert facets["methods"] == [{"value": "direct", "runs": 10}, {"value": "sqp", "runs": 10}]


@pytest.mark.parametrize(
    ("q", "count"),
    [
        ("run R-0007", 1),
        ("R-0007", 1),
        ("BOB", 17),
        ("even ada", 16),
        ("pillar", 50),
        ("50%_", 50),
        ("5%_%", 0),
        ("zzz", 0),
    ],
)
def test_search_words_are_all_to_be_found(crowd: httpx.Client, q: str, count: int) -> None:
    page = crowd.get("/api/v1/runs", params={"q": q, "limit": 200}).json()
    assert len(page["items"]) == count
    assert page["counts"]["total"] == count


@pytest.mark.parametrize("cursor", ["x", "eA", "W10", "WyJuYW1lIiwgMSwgMV0", "é", "A" * 900])
def test_a_bad_cursor_is_refused(crowd: httpx.Client, cursor: str) -> None:
    document = problem(crowd.get("/api/v1/runs", params={"cursor": cursor}), 422)
    assert "cursor" in str(document["detail"])


def test_a_cursor_of_another_order_is_refused(crowd: httpx.Client) -> None:
    cursor = crowd.get("/api/v1/runs", params={"limit": 2}).json()["next_cursor"]
    problem(crowd.get("/api/v1/runs", params={"sort": "name", "cursor": cursor}), 422)


@pytest.mark.parametrize(
    "query", [{"limit": 0}, {"limit": 1000}, {"sort": "colour"}, {"state": "odd"}, {"q": "x" * 999}]
)
def test_a_bad_query_is_refused(crowd: httpx.Client, query: dict[str, Any]) -> None:
    errors = problem(crowd.get("/api/v1/runs", params=query), 422)["errors"]
    assert isinstance(errors, list)
    assert errors[0]["field"].startswith(next(iter(query)))


QUERIES: tuple[dict[str, Any], ...] = (
    {},
    {"sort": "-margin"},
    {"sort": "campaign"},
    {"q": "pillar bob"},
    {"q": "run 3"},
    {"tag": "odd", "state": "done"},
    {"campaign": "Unicycle past a pillar", "since": 1.0},
    {"sort": "name", "limit": 200},
)
WIDE = {"summary": {"scope": "x" * 6000}, "best_so_far": [[i + 1, 10.0 / (i + 1)] for i in range(32)]}
"""As wide as a real run's, which a scan of the table would have to read."""
STEPS = 200
"""Of SQLite's machine a run, for one response: the same everywhere, which the time is not."""


@contextmanager
def watched(service: Service) -> Iterator[tuple[list[int], list[str]]]:
    """The steps of SQLite's machine while the block lasts, in hundreds, and how it finds and counts runs."""
    steps: list[int] = [0]
    plans: list[str] = []
    connected = set[Any]()

    def count() -> None:
        steps[0] += 1

    def watch(connection: Any, *_: object) -> None:
        connected.add(connection)
        connection.set_progress_handler(count, 100)

    def plan(_: object, cursor: Any, statement: str, parameters: Any, *__: object) -> None:
        if re.match("SELECT.* runs.*(LIMIT|GROUP BY)|SELECT count", statement, re.DOTALL):
            shown = cursor.connection.execute(f"explain query plan {statement}", parameters)
            plans.extend(row[-1] for row in shown.fetchall())

    sa.event.listen(service.engine, "checkout", watch)
    sa.event.listen(service.engine, "before_cursor_execute", plan)
    try:
        yield steps, plans
    finally:
        sa.event.remove(service.engine, "checkout", watch)
        sa.event.remove(service.engine, "before_cursor_execute", plan)
        for connection in connected:
            connection.set_progress_handler(None, 0)


def found_by(plans: list[str]) -> set[str]:
    """The indices by which runs are found; empty for a scan of the table. By number they are read in any case."""
    others = [plan for plan in plans if re.match(r"(SCAN|SEARCH) runs\b", plan) and "PRIMARY KEY" not in plan]
    return {re.sub(r".* INDEX (\w+).*|.*", r"\1", plan) for plan in others}


def test_a_page_is_found_without_reading_the_table(service: Service, client: httpx.Client) -> None:
    runs = 2_000
    fill(service, runs, pinned=(5,), **WIDE)
    for query in QUERIES:
        with watched(service) as (steps, plans):
            assert client.get("/api/v1/runs", params=query).json()["next_cursor"]
        assert 0 < 100 * steps[0] < STEPS * runs, query
        counts = set() if query.keys() & {"q", "tag", "campaign"} else {"ix_runs_counts"}
        assert found_by(plans) == {"ix_runs_list", "ix_runs_removed", *counts}, query
    with watched(service) as (steps, plans):
        assert client.get("/api/v1/runs/facets").json()["owners"][0]["runs"] == 1333
    assert 0 < 100 * steps[0] < STEPS * runs
    assert found_by(plans) == {"ix_runs_list"}


@pytest.mark.nightly  # it measures times, which depend on what else the machine does
def test_the_list_stays_fast_with_ten_thousand_runs(service: Service, client: httpx.Client) -> None:
    fill(service, 10_000, pinned=(5,), **WIDE)
    for query in QUERIES:
        used = []
        for _ in range(3):
            begun = time.process_time()
            page = client.get("/api/v1/runs", params=query).json()
            used.append(time.process_time() - begun)
        assert page["next_cursor"]
        assert min(used) < 0.2, query
    begun = time.process_time()
    assert client.get("/api/v1/runs/facets").json()["owners"][0]["runs"] == 6666
    assert time.process_time() - begun < 0.2
