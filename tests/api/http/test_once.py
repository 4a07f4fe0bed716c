"""Every write of the API is safe to repeat: by nature, or once for each Idempotency-Key.

The tables of `tests.given.repeated_writes` name all operations that are not GET; the test fails for one that is in
neither.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import httpx
import pytest
import sqlalchemy as sa
from pydantic import SecretStr

from backend.db.tables import Base
from backend.http import keys
from backend.settings import Settings
from tests.api.conftest import Fresh, running
from tests.given.busy_service import occupied
from tests.given.databases import BOTH
from tests.given.openapi_document import OPERATIONS
from tests.given.problem_documents import problem
from tests.given.repeated_writes import API, DRAFT, FILE, KEYED, NATURAL, ONWARD, SECRET_ONES, SWEEP, Sent, signing
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.small_catalogue import campaign

TRAIL = ("audit", "audit_head")
"""Tables that note requests, those that change nothing as well."""


@pytest.fixture(scope="module")
def service(fresh_sqlite: Fresh, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """R-0001 has ended, R-0002 can be signed off; a webhook that nobody answers."""
    hooks = {
        "webhooks": SecretStr("http://127.0.0.1:9/"),
        "webhook_secret": SecretStr("whsec_" + "A" * 44),
        "webhook_private": True,
    }
    with occupied(fresh_sqlite, tmp_path_factory.mktemp("once"), **hooks) as service:
        finish_fully(service)
        yield service


@pytest.fixture
def client(service: Service) -> Iterator[httpx.Client]:
    with service.signed_in() as client:
        yield client


def state(service: Service) -> dict[str, list[Any]]:
    """Every row of the database; of messages, which are made and sent in the background, those that were asked for."""
    with service.engine.connect() as reader:
        tables = [t for t in Base.metadata.sorted_tables if t.name not in TRAIL]
        found = {t.name: reader.execute(sa.select(t).order_by(*t.primary_key.columns)).all() for t in tables}
    asked_for = [row.id for row in found["webhook_deliveries"] if row.type == "test"]
    targets = [row.id for row in found["webhook_targets"]]
    return found | {"webhook_deliveries": asked_for, "webhook_targets": targets}


def test_every_write_is_safe_to_repeat() -> None:
    writes = {(method, path.removeprefix(API)): operation for path, method, operation in OPERATIONS if method != "get"}
    assert writes.keys() == NATURAL.keys() | KEYED.keys()
    assert not NATURAL.keys() & KEYED.keys()
    for name, operation in writes.items():
        headers = [one["name"] for one in operation.get("parameters", ()) if one["in"] == "header"]
        assert ("Idempotency-Key" in headers) == (name in KEYED.keys() | ONWARD), name


@pytest.mark.parametrize("write", NATURAL, ids=" ".join)
def test_repeated_by_nature_it_changes_nothing(service: Service, client: httpx.Client, write: tuple[str, str]) -> None:
    prepare, statuses = NATURAL[write]
    with service.signed_in():  # a second session
        sent = prepare(client)
        first = sent.to(client, write[0])
        assert first.status_code == statuses[0], first.text
        before = state(service)
        again = sent.to(client, write[0])
        assert again.status_code == statuses[1], again.text
        assert state(service) == before


@pytest.mark.parametrize("write", KEYED, ids=" ".join)
def test_repeated_with_its_key_it_makes_nothing(service: Service, client: httpx.Client, write: tuple[str, str]) -> None:
    sent = KEYED[write](client)
    first = sent.to(client, "post", "k")
    assert first.status_code in (201, 202), first.text
    before = state(service)
    again = sent.to(client, "post", "k")
    assert state(service) == before
    if write in SECRET_ONES:
        document = problem(again, 409)
        assert document["type"] == "urn:clearance:problem:already-made"
        assert "with another" in str(document["detail"])
        answer = first.json()
        secret = answer.get("secret") or answer["path"].partition("code=")[2]
        assert len(secret) > 20
        assert secret not in str(before)
    else:
        assert (again.status_code, again.json()) == (first.status_code, first.json())
    other = Sent(sent.path, content=sent.content or b" ", query=sent.query and {**sent.query, "name": "other"})
    if sent.json is not None:
        other = Sent(sent.path, {**sent.json, "name": "zoe"}, query=sent.query)
    refused = problem(other.to(client, "post", "k"), 422)
    assert refused["type"] == "urn:clearance:problem:idempotency-key-reused"
    assert state(service) == before


def test_what_is_refused_leaves_its_key(client: httpx.Client) -> None:
    problem(Sent("/tokens", {"name": "local", "scope": "run"}).to(client, "post", "left"), 409)
    assert Sent("/tokens", {"name": "left", "scope": "run"}).to(client, "post", "left").status_code == 201


def test_a_repeated_sign_off_says_that_it_was_withdrawn(client: httpx.Client) -> None:
    sent = signing(client)
    for one in client.get(f"{API}{sent.path}").json()["items"]:  # the same person signs once
        client.post(f"{API}{sent.path}/{one['id']}/withdraw", json={"reason": "To sign again."})
    number = sent.to(client, "post", "withdrawn").json()["id"]
    client.post(f"{API}{sent.path}/{number}/withdraw", json={"reason": "Overlooked."})
    again = sent.to(client, "post", "withdrawn").json()
    assert (again["id"], again["withdrawn_reason"]) == (number, "Overlooked.")


def test_a_key_is_of_its_user(service: Service, client: httpx.Client) -> None:
    mine = Sent("/drafts", DRAFT).to(client, "post", "shared").json()
    with service.visitor(authorization=f"Bearer {service.token('program')}") as program:
        theirs = Sent("/drafts", DRAFT).to(program, "post", "shared").json()
        assert theirs["id"] != mine["id"]
        assert (theirs["owner"], theirs["saved_by"]) == ("local", "program")


@pytest.mark.parametrize(
    ("key", "status"),
    [
        ("k" * 128, 201),
        ("k" * 10_000, 422),
        ("", 422),
        ("a, b", 201),
        (b"\xfcber \xff", 201),
        (b"a\tb", 201),
    ],
)
def test_keys_of_every_kind(client: httpx.Client, key: str | bytes, status: int) -> None:
    as_bytes = key if isinstance(key, bytes) else key.encode()
    found = [client.post(f"{API}/drafts", json=DRAFT, headers=[(b"Idempotency-Key", as_bytes)]) for _ in range(2)]
    assert [answer.status_code for answer in found] == [status, status]
    assert status != 201 or found[0].json() == found[1].json()


@pytest.mark.nightly  # by day a small file: `post /requirements/files` of `KEYED`
def test_a_large_request_is_done_once(client: httpx.Client) -> None:
    content = b"id,text\n" + b"".join(b"BIG-%d,%s\n" % (i, b"x" * 100) for i in range(10_000))
    sent = Sent("/requirements/files", content=content, query={**FILE, "name": "big.csv"})
    first, again = (sent.to(client, "post", "big") for _ in range(2))
    assert first.status_code == 201, first.text
    assert len(first.json()["added"]) == 10_000
    assert again.json() == first.json()


def test_answers_are_forgotten_before_they_fill_the_disk(client: httpx.Client, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(keys, "KEPT", 2)
    made = [Sent("/drafts", DRAFT).to(client, "post", f"many-{i}").json()["id"] for i in range(3)]
    told = problem(Sent("/drafts", DRAFT).to(client, "post", "many-0"), 409)
    assert made[0] in str(told["detail"])
    assert Sent("/drafts", DRAFT).to(client, "post", "many-2").json()["id"] == made[2]


def test_a_request_is_not_done_again_after_a_restart(fresh: Fresh, tmp_path: Path) -> None:
    found = []
    for number in range(2):
        settings = Settings(data=tmp_path / "data", database=fresh(tmp_path / "data") if not number else "")
        service = Service(settings)
        service.start()
        try:
            with service.signed_in() as client:
                found.append(Sent("/drafts", DRAFT).to(client, "post", "k"))
        finally:
            service.stop()
    assert [answer.status_code for answer in found] == [201, 201]
    assert found[0].json() == found[1].json()


@BOTH
def test_answers_are_forgotten_by_requests_at_the_same_time(
    fresh: Fresh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(keys, "KEPT", 1)
    with running(fresh, tmp_path) as service, service.signed_in() as client, ThreadPoolExecutor(6) as pool:
        found = pool.map(lambda i: Sent("/drafts", DRAFT).to(client, "post", f"k{i}").status_code, range(24))
        assert list(found) == [201] * 24
        assert service.rows()["drafts"] == 24


@BOTH
def test_of_requests_at_the_same_time_one_is_done(fresh: Fresh, tmp_path_factory: pytest.TempPathFactory) -> None:
    with running(fresh, tmp_path_factory.mktemp("at once")) as service, service.signed_in() as client:
        service.publish()
        for sent in (Sent("/drafts", DRAFT), Sent("/runs", {"campaign": campaign()}), Sent("/sweeps", SWEEP)):
            before = service.rows()
            with ThreadPoolExecutor(6) as pool:
                found = list(pool.map(lambda _, s=sent: s.to(client, "post", "k"), range(6)))
            assert [answer.status_code for answer in found] == [201] * 6, [answer.text for answer in found]
            assert len({json.dumps(answer.json()) for answer in found}) == 1
            assert service.rows()["request_keys"] == before["request_keys"] + 1
        rows = service.rows()
        assert (rows["drafts"], rows["runs"], rows["sweeps"]) == (1, 4, 1)
        token = Sent("/tokens", {"name": "one", "scope": "run"})
        with ThreadPoolExecutor(6) as pool:
            statuses = sorted(a.status_code for a in pool.map(lambda _: token.to(client, "post", "k"), range(6)))
        assert statuses == [201] + [409] * 5
