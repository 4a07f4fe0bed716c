"""Messages when a run ends: signed, stored, repeated under the same id, never to where they must not go."""

from __future__ import annotations

import asyncio
import base64
import hashlib
import hmac
import json
import logging
import socket
import ssl
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
import sqlalchemy as sa
from pydantic import SecretStr

from backend.db import queue
from backend.db.engine import connect, now
from backend.db.tables import Run, WebhookDelivery, WebhookTarget
from backend.settings import Settings
from backend.webhooks import dispatcher, outbox
from backend.webhooks.addresses import is_public
from backend.webhooks.configuration import Configured, Target, configured
from backend.webhooks.outbox import Outbox
from backend.webhooks.sending import Message, Sent, send
from backend.webhooks.service import deliveries
from campaigns import Campaign
from campaigns.runs import run_name
from tests.api.conftest import running
from tests.given.databases import BOTH, Fresh
from tests.given.finished_runs import finish
from tests.given.problem_documents import problem
from tests.given.reported_runs import SEARCHED, finish_fully
from tests.given.service import Service, until
from tests.given.small_catalogue import campaign
from tests.given.submissions import submit
from tests.given.webhook_receiver import Receiver, receiving

KEY = b"thirty-two bytes of a secret key"
SECRET = "whsec_" + base64.b64encode(KEY).decode()


@pytest.fixture
def receiver() -> Iterator[Receiver]:
    with receiving() as receiver:
        yield receiver


@pytest.fixture(autouse=True)
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dispatcher, "PERIOD", 0.02)


def hooked(fresh: Fresh, folder: Path, url: str) -> Any:
    given = {"webhooks": SecretStr(url), "webhook_secret": SecretStr(SECRET), "webhook_private": True}
    return running(fresh, folder, **given, public_url="https://clearance.example/")


def registered(service: Service) -> None:
    """Wait until the service knows since when its runs are reported."""
    until(lambda: service.rows()["webhook_targets"])


def delivered(client: httpx.Client, count: int) -> list[dict[str, Any]]:
    def there() -> Any:
        found = client.get("/api/v1/webhooks/deliveries").json()
        return len(found) >= count and all(item["state"] == "delivered" for item in found) and found

    return list(until(there))


def test_a_run_that_ends_is_reported_once_and_signed(fresh: Fresh, tmp_path: Path, receiver: Receiver) -> None:
    with hooked(fresh, tmp_path, receiver.url) as service, service.signed_in() as client:
        service.publish()
        registered(service)
        runs = [submit(client) for _ in range(3)]
        client.post(f"/api/v1/runs/{runs[2]}/cancel")
        finish_fully(service, "cleared", statistics=SEARCHED)
        finish(service)  # violated
        delivered(client, 3)
        reported = {request.document["data"]["run"]: request for request in receiver.requests}
        assert sorted(reported) == runs
        assert len(receiver.requests) == 3
        (target,) = client.get("/api/v1/webhooks").json()["targets"]
        assert target["origin"] == f"http://127.0.0.1:{receiver.port}"
        assert (target["pending"], target["delivered"], target["failed"]) == (0, 3, 0)
        assert target["last"]["status"] == 200
        assert "token-in-the-path" not in client.get("/api/v1/webhooks").text
    first, second, third = (reported[run].document["data"] for run in runs)
    assert reported[runs[0]].document["type"] == "run.ended"
    assert (first["state"], first["verdict"], first["worst_cost"], first["unit"]) == ("done", "cleared", 1.3, "m")
    assert (first["upper_bound"], first["bound_source"]) == (SEARCHED.upper_bound, "search")
    assert (second["upper_bound"], second["bound_source"]) == (None, None)
    assert (first["before"], first["verdict_changed"]) == (None, False)
    assert first["address"] == f"https://clearance.example/runs/{runs[0]}"
    assert second["verdict_changed"] is True
    assert second["before"]["run"] == runs[0]
    assert second["before"]["verdict"] == "cleared"
    assert (third["state"], third["verdict"], third["worst_cost"], third["verdict_changed"]) == (
        "cancelled",
        None,
        None,
        False,
    )
    for request in receiver.requests:
        sent = request.headers
        signed = f"{sent['webhook-id']}.{sent['webhook-timestamp']}.{request.body}".encode()
        assert sent["webhook-signature"] == "v1," + base64.b64encode(hmac.digest(KEY, signed, hashlib.sha256)).decode()
        assert abs(int(sent["webhook-timestamp"]) - time.time()) < 60
        assert sent["clearance-attempt"] == "1"
        assert sent["content-type"] == "application/json"


def test_a_refused_message_is_repeated_under_its_id(
    fresh: Fresh, tmp_path: Path, receiver: Receiver, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(outbox, "FIRST", 0.01)
    caplog.set_level(logging.INFO)
    receiver.answers = [500, 302]
    with hooked(fresh, tmp_path, receiver.url) as service, service.signed_in() as client:
        answer = client.post("/api/v1/webhooks/test")
        assert answer.status_code == 202
        (item,) = delivered(client, 1)
    assert [item["id"] for item in answer.json()] == [item["id"]]
    assert (item["attempts"], item["status"], item["error"], item["type"]) == (3, 200, None, "test")
    assert {request.headers["webhook-id"] for request in receiver.requests} == {item["id"]}
    assert [request.headers["clearance-attempt"] for request in receiver.requests] == ["1", "2", "3"]
    assert {request.path for request in receiver.requests} == {"/hook/token-in-the-path"}  # no redirect was followed
    statement = [record.getMessage() for record in caplog.records if "webhook" in record.getMessage()]
    assert " 500 Internal Server Error" in statement[0]
    assert " 302 Found, a redirect" in statement[1]
    assert "token-in-the-path" not in caplog.text
    assert SECRET not in caplog.text


def test_a_receiver_that_hangs_holds_nothing_up(fresh: Fresh, tmp_path: Path, receiver: Receiver) -> None:
    go_on = threading.Event()
    receiver.hold = lambda: go_on.wait(120)
    with hooked(fresh, tmp_path, receiver.url) as service, service.signed_in() as client:
        (asked,) = client.post("/api/v1/webhooks/test").json()
        until(lambda: receiver.requests)
        again = [client.post("/api/v1/webhooks/test").json()[0]["id"] for _ in range(3)]
        assert again == [asked["id"]] * 3
        assert client.get("/api/v1/health", timeout=15).status_code == 200
        (item,) = client.get("/api/v1/webhooks/deliveries").json()
        assert (item["state"], item["attempts"], item["delivered"]) == ("pending", 1, None)
    # The service has stopped, although an attempt is under way.
    go_on.set()


class Stored:
    """A database without a service."""

    def __init__(self, engine: sa.Engine) -> None:
        self.engine = engine

    def submit(self) -> int:
        asked = Campaign.model_validate(campaign())
        with self.engine.begin() as writer:
            return queue.submit(writer, asked, name="a run", tags=[], owner="", planned=1)

    def test(self) -> None:
        with self.engine.begin() as writer:
            outbox.test(writer, "t")


@pytest.fixture
def stored(fresh: Fresh, tmp_path: Path) -> Iterator[Any]:
    engine = connect(fresh(tmp_path / "data"))
    yield Stored(engine)
    engine.dispose()


def registered_box(stored: Stored) -> Outbox:
    box = Outbox(stored.engine, "t", "")
    box.register()
    return box


def told(message: Message | None) -> dict[str, Any]:
    assert message is not None
    return dict(json.loads(message.body)["data"])


def test_only_runs_that_end_from_then_on(stored: Any) -> None:
    stored.submit()
    after = stored.submit()
    finish(stored)
    box = registered_box(stored)
    finish(stored)
    box.register()  # a restart
    assert box.fill() == 1
    assert box.fill() == 0
    found = told(box.claim())
    assert (found["run"], found["before"]["run"], found["address"]) == (run_name(after), "R-0001", None)


def test_runs_that_end_while_no_service_runs(stored: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(outbox, "NEAR", 0)
    registered_box(stored)
    runs = [stored.submit() for _ in range(4)]
    with stored.engine.begin() as writer:
        queue.request_cancel(writer, runs[3])
    box = Outbox(stored.engine, "t", "")
    assert box.fill() == 1
    finish(stored)  # older than one that is reported already
    finish(stored)
    assert box.fill() == 2
    assert Outbox(stored.engine, "t", "").fill() == 0
    assert Outbox(stored.engine, "u", "").fill() == 0  # not registered


def test_the_second_end_of_a_run_that_is_retried_after_newer_ones(stored: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(outbox, "NEAR", 0)
    box = registered_box(stored)
    first, runs = stored.submit(), queue.Queue(stored.engine)
    claimed = runs.claim("w")
    assert claimed is not None
    runs.fail(claimed, "the disk is full")
    for _ in range(3):
        stored.submit()
        finish(stored)
    assert (box.fill(), box.fill()) == (4, 0)
    with stored.engine.begin() as writer:
        queue.resume(writer, first)
    assert box.fill() == 0
    finish(stored)
    assert box.fill() == 1


@BOTH
def test_a_run_that_is_queued_again_while_messages_are_made_is_reported_at_its_end(
    stored: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    box, read = registered_box(stored), Outbox._unreported
    run, runs = stored.submit(), queue.Queue(stored.engine)
    claimed = runs.claim("w")
    assert claimed is not None
    runs.fail(claimed, "the disk is full")

    def retried(box: Outbox) -> Any:
        found = read(box)
        with stored.engine.begin() as writer:
            queue.resume(writer, run)
        return found

    with monkeypatch.context() as meanwhile:
        meanwhile.setattr(Outbox, "_unreported", retried)
        assert box.fill() == 0
    finish(stored)
    assert (box.fill(), box.fill()) == (1, 0)


@pytest.mark.parametrize("restarted", [False, True])
@BOTH
def test_a_target_configured_before_the_clock_was_put_back_misses_no_run(stored: Any, restarted: bool) -> None:
    for _ in range(2):
        stored.submit()
    finish(stored)
    box = registered_box(stored)
    with stored.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == 1).values(finished=now(writer) - 1000.0))
        writer.execute(sa.update(WebhookTarget).values(since=now(writer) + 86_400.0))
    if restarted:
        box = registered_box(stored)
    else:
        assert box.fill() == 0
    finish(stored)
    assert box.fill() == 1
    assert told(box.claim())["run"] == run_name(2)


@BOTH
def test_a_message_put_off_before_the_clock_was_put_back_is_due(stored: Any) -> None:
    box = registered_box(stored)
    stored.submit()
    finish(stored)
    assert box.fill() == 1

    def put_off(seconds: float) -> None:
        with stored.engine.begin() as writer:
            writer.execute(sa.update(WebhookDelivery).values(not_before=now(writer) + seconds))

    put_off(outbox.LONGEST - 1.0)
    assert box.claim() is None
    put_off(86_400.0)
    assert box.claim() is not None
    assert box.claim() is None


@pytest.mark.by_day(1)
@BOTH
def test_a_kill_loses_no_message(stored: Any) -> None:
    one, other = registered_box(stored), Outbox(stored.engine, "t", "")
    stored.submit()
    finish(stored)
    assert (one.fill(), other.fill()) == (1, 0)
    first = one.claim()
    assert first is not None
    assert other.claim() is None  # not while the attempt may be under way
    with stored.engine.begin() as writer:  # the process was killed; the time passes
        writer.execute(sa.update(WebhookDelivery).values(not_before=now(writer) - 1))
    second = other.claim()
    assert second == Message(first.id, first.body, 2)
    one.record(first, Sent(None, "too late"))  # was only slow, and may not overwrite its successor
    other.record(second, Sent(200, None))
    with stored.engine.connect() as reader:
        row = reader.execute(sa.select(WebhookDelivery.__table__)).one()
    assert (row.state, row.attempts, row.error) == ("delivered", 2, None)
    assert one.claim() is None
    assert one.fill() == 0


def test_a_message_has_failed_after_the_last_attempt(stored: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(outbox, "FIRST", 0.0)
    monkeypatch.setattr(outbox, "MOST", 3)
    box = registered_box(stored)
    stored.test()
    attempts = []
    while (message := box.claim()) is not None:
        attempts.append(message.attempt)
        box.record(message, Sent(503, "no"))
    assert attempts == [1, 2, 3]
    with stored.engine.connect() as reader:
        assert reader.scalar(sa.select(WebhookDelivery.state)) == "failed"


def test_the_pauses_double_up_to_an_hour() -> None:
    pauses = [outbox.pause(attempts) for attempts in range(1, outbox.MOST)]
    assert pauses[:3] == [10.0, 20.0, 40.0]
    assert pauses[-1] == 3600.0
    assert sum(pauses) > 6 * 3600


def test_messages_to_an_address_that_is_not_configured_wait(stored: Any) -> None:
    target = Target("https://hooks.example/", False)
    Outbox(stored.engine, target.id, "").register()
    with stored.engine.begin() as writer:
        outbox.test(writer, target.id)
    with stored.engine.connect() as reader:
        (known,) = deliveries(reader, Configured((target,), KEY), 10)
        (unknown,) = deliveries(reader, Configured(), 10)
    assert (known.state, known.configured, known.next_attempt is None) == ("pending", True, False)
    assert (unknown.state, unknown.configured, unknown.next_attempt) == ("pending", False, None)


def test_a_run_that_cannot_be_read_holds_no_other_up(stored: Any) -> None:
    box = registered_box(stored)
    strange, plain = stored.submit(), stored.submit()
    finish(stored)
    finish(stored)
    with stored.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == strange).values(verdict="perhaps"))
    assert box.fill() == 2
    found = [told(box.claim()), told(box.claim())]
    assert sorted(item["run"] for item in found) == [run_name(strange), run_name(plain)]
    assert "another version" in str([item["error"] for item in found])


def test_without_a_webhook_no_message_is_stored(still: Service, guest: httpx.Client) -> None:
    assert guest.get("/api/v1/webhooks").json() == {"targets": []}
    answer = problem(guest.post("/api/v1/webhooks/test"), 409)
    assert "CLEARANCE_WEBHOOKS" in str(answer["detail"])
    rows = still.rows()
    assert rows["webhook_deliveries"] == rows["webhook_targets"] == 0


def attempt(url: str, private: bool = True, limit: float = 5.0) -> Sent:
    tls = ssl.create_default_context()
    return asyncio.run(send(Target(url, private), KEY, Message("msg_1", "{}", 1), 1, tls, limit))


def test_a_private_address_is_refused_before_anything_is_sent(receiver: Receiver) -> None:
    for host in ("127.0.0.1", "localhost"):
        sent = attempt(receiver.url.replace("127.0.0.1", host), private=False)
        assert sent.status is None
        assert "CLEARANCE_WEBHOOK_PRIVATE" in str(sent.error)
    assert receiver.requests == []
    assert attempt(receiver.url) == Sent(200, None)


@pytest.mark.parametrize(
    "address",
    [
        *("10.0.0.1", "127.0.0.1", "169.254.169.254", "192.168.1.1", "100.64.0.1", "0.0.0.0", "224.0.0.251", "::1"),
        *("::", "fe80::1%eth0", "fd00::1", "::ffff:10.0.0.1", "64:ff9b::a00:1", "2002:a00:1::", "2001:0:a00:1::"),
        *("ff02::1", "::127.0.0.1", "::ffff:0:127.0.0.1", "fec0::1", "64:ff9b:1::a00:1", "2001:db8::1", "4000::1"),
    ],
)
def test_addresses_that_are_not_public(address: str) -> None:
    assert not is_public(address)


def test_a_public_address_is_recognised() -> None:
    assert is_public("93.184.215.14")
    assert is_public("2606:4700:4700::1111")


def test_a_receiver_that_drips_is_cut_off() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        stop = threading.Event()

        def drip() -> None:
            connection, _ = server.accept()
            with connection:
                connection.sendall(b"HTTP/1.1 200 OK\r\n")
                while not stop.wait(0.05):
                    try:
                        connection.sendall(b"x-more: 1\r\n")
                    except OSError:
                        return

        thread = threading.Thread(target=drip, daemon=True)
        thread.start()
        sent = attempt(f"http://127.0.0.1:{server.getsockname()[1]}/", limit=0.4)  # which ends, as the drip does not
        stop.set()
        thread.join()
    assert str(sent.error).endswith(" 0.4 s")


@pytest.mark.parametrize("url", ["http://127.0.0.1:9/", "http://no-such-host.invalid/"])
def test_a_receiver_that_is_not_there(url: str) -> None:
    sent = attempt(url)
    assert sent.status is None
    assert url.split("/")[2].partition(":")[0] in str(sent.error)


ADDRESS = "https://user:hidden-password@hooks.example/services/hidden-path"


@pytest.mark.parametrize(
    ("addresses", "secret", "private", "statement"),
    [
        (ADDRESS, "", "", "a secret that signs the messages is required"),
        (ADDRESS, "hidden-secret", "", "not a secret"),
        (ADDRESS, "whsec_" + base64.b64encode(b"hidden").decode(), "", "at least 24 bytes"),
        (ADDRESS, "whsec_hidden*", "", "in base64"),
        (ADDRESS.replace("https", "http"), SECRET, "", "http://hooks.example) is not encrypted"),
        ("hidden", SECRET, "", "address 1 is not an address"),
        ("ftp://hidden/", SECRET, "", "address 1 is not an address"),
        ("https://[hidden/", SECRET, "", "address 1 is not an address"),
        ("https://hidden:99999/", SECRET, "", "address 1 is not an address"),
        (" ".join(f"{ADDRESS}{i}" for i in range(11)), SECRET, "", "at most 10"),
        (ADDRESS, SECRET, "perhaps", "CLEARANCE_WEBHOOK_PRIVATE"),
    ],
)
def test_wrong_settings_are_refused_without_their_secrets(
    addresses: str, secret: str, private: str, statement: str
) -> None:
    given = {"CLEARANCE_WEBHOOKS": addresses, "CLEARANCE_WEBHOOK_SECRET": secret, "CLEARANCE_WEBHOOK_PRIVATE": private}
    with pytest.raises(ValueError, match="CLEARANCE_WEBHOOK") as error:
        Settings.load(given)
    assert statement in str(error.value)
    assert "hidden" not in str(error.value)


def test_right_settings_do_not_show_their_secrets() -> None:
    given = {"CLEARANCE_WEBHOOKS": f"{ADDRESS} {ADDRESS} {ADDRESS}2", "CLEARANCE_WEBHOOK_SECRET": SECRET}
    settings = Settings.load(given)
    hooks = settings.hooks
    assert [target.origin for target in hooks.targets] == ["https://hooks.example"] * 2
    assert hooks.key == KEY
    assert "hidden" not in f"{settings!r} {hooks!r} {settings.model_dump_json()}"
    assert SECRET not in f"{settings!r} {hooks!r} {settings.model_dump_json()}"
    assert configured("", "", False).targets == ()
