"""Messages allowed from a page to its 3D view, the limit of views per visitor, and their end after signing out."""

from __future__ import annotations

import asyncio
import contextlib
import math
import time
from contextlib import suppress
from typing import Any

import httpx
import msgspec
import pytest
import websockets
from viser import _messages
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection

from backend.access.rates import Bucket
from backend.db.access import revoke_token
from backend.scenes.control import relay
from backend.scenes.control.messages import BURST, LARGEST, RATE, SOUND, paced, refusal
from tests.given.finished_runs import finish
from tests.given.joined_users import joined
from tests.given.problem_documents import problem
from tests.given.service import Service, until
from tests.given.submissions import submit
from tests.given.viewer_clients import CAMERA, KEY, frames_until, viewing

packed = msgspec.msgpack.encode
UPLOAD = {
    "type": "FileTransferStartUpload",
    "source_component_uuid": "x",
    "transfer_uuid": "y",
    "filename": "f",
    "mime_type": "a/b",
    "part_count": 1000,
    "size_bytes": 800_000_000,
}
PART = {"type": "FileTransferPart", "source_component_uuid": "x", "transfer_uuid": "y", "part_index": 0}
GUI = {"type": "GuiUpdateMessage", "uuid": "x"}
POINTER = {"event_type": "click", "ray_origin": None, "ray_direction": None, "screen_pos": [[0.1, 0.2]]}


@pytest.mark.parametrize(
    "message",
    [
        {"type": "ViewerCameraMessage", **CAMERA},
        GUI | {"updates": {"value": 3.5}},
        GUI | {"updates": {"value": [1, 2]}},
        {"type": "ScenePointerMessage", **POINTER, "modifier": None},
    ],
    ids=lambda message: str(message["type"]),
)
def test_what_the_viewers_page_sends_is_passed_on(message: dict[str, object]) -> None:
    assert refusal(packed(message)) == ""


@pytest.mark.parametrize(
    ("message", "why"),
    [
        (packed(UPLOAD), "FileTransferStartUpload is not allowed"),
        (packed(PART | {"content": b"x" * 100}), "FileTransferPart is not allowed"),
        (packed({"type": "ShareUrlRequest"}), "ShareUrlRequest is not allowed"),
        (packed({"type": "ShareUrlDisconnect"}), "ShareUrlDisconnect is not allowed"),
        (packed({"type": "RunJavascriptMessage", "source": "alert(1)"}), "RunJavascriptMessage is not allowed"),
        (packed({"type": "CommandTriggerMessage", "uuid": "x"}), "CommandTriggerMessage is not allowed"),
        (packed(GUI | {"updates": {"sync_cb": 1}}), "only the value"),
        (packed(GUI | {"updates": {"value": 1, "removed": True}}), "only the value"),
        (packed(GUI | {"updates": {}}), "only the value"),
        (packed(GUI | {"updates": {"value": "x" * LARGEST}}), "at most 65536 bytes"),
        (packed([{"type": "ViewerCameraMessage", **CAMERA}]), "not a message"),
        (packed([UPLOAD]), "not a message"),
        (packed({"type": "ViewerCameraMessage", **CAMERA, "more": 1}), "not a message"),
        (packed({"type": "ViewerCameraMessage", **CAMERA}) + packed(UPLOAD), "not a message"),
        (packed({"type": "Unheard"}), "not a message"),
        (packed({"type": 5}), "not a message"),
        (packed({"type": ["ViewerCameraMessage"]}), "not a message"),
        (packed(None), "not a message"),
        (b"", "not a message"),
        (b"\xc1" * 50, "not a message"),
        (b"\x91" * 60_000, "not a message"),
        ('{"type": "ViewerCameraMessage"}', "not text"),
    ],
)
def test_anything_else_is_refused_in_a_sentence(message: bytes | str, why: str) -> None:
    assert why in refusal(message)
    assert len(refusal(message).encode()) <= 123, "the room for a reason (RFC 6455, section 5.5)"


CLICK = {"name": "/x", "instance_index": None, "ray_origin": (0.0,) * 3, "ray_direction": (0.0, 0.0, 1.0)}
CLICK |= {"type": "SceneNodeClickMessage", "screen_pos": (0.5, 0.5), "modifier": None}
VECTORS = ("wxyz", "position", "look_at", "up_direction")
WRONG = (math.nan, math.inf, -math.inf, 1.1e9, -1e308, "x", None)


def with_wrong_numbers() -> list[dict[str, Any]]:
    """Messages of which one vector or number is not one."""
    camera = {"type": "ViewerCameraMessage", **CAMERA}
    vectors: dict[str, Any] = {name: CAMERA[name] for name in VECTORS}
    found = [camera | {name: value} for name in CAMERA if name not in VECTORS for value in WRONG]
    found += [camera | {name: (value, *vector[1:])} for name, vector in vectors.items() for value in WRONG]
    lengths = [(name, vector[:-1]) for name, vector in vectors.items()]
    lengths += [(name, (*vector, 1.0)) for name, vector in vectors.items()]
    lengths += [(name, changed) for name in VECTORS for changed in ((), None, "abc", 1.0)]
    found += [camera | {name: changed} for name, changed in lengths]
    found += [camera | {"position": (1.0, 2.0), "look_at": (0.0, 0.0)}, camera | {"position": CAMERA["look_at"]}]
    found += [camera | {"up_direction": (0.0, 0.0, 0.0)}, camera | {"wxyz": (0.0, 0.0, 0.0, 0.0)}]
    pointer = {"type": "ScenePointerMessage", **POINTER, "modifier": None}
    found += [pointer | {"ray_direction": (math.nan, 0.0, 0.0)}, pointer | {"ray_origin": (1.0,)}]
    found += [pointer | {"screen_pos": [[0.1]]}, pointer | {"event_type": "x"}]
    return [*found, CLICK | {"name": 5}, CLICK | {"ray_origin": None}, CLICK | {"screen_pos": 3}]


@pytest.mark.filterwarnings("ignore:.viser.")
def test_messages_with_vectors_of_another_length_or_numbers_that_are_none_are_refused() -> None:
    assert [message for message in with_wrong_numbers() if not refusal(packed(message))] == []
    assert all(len(refusal(packed(message)).encode()) <= 123 for message in with_wrong_numbers())
    assert refusal(packed(CLICK)) == ""


def test_of_all_messages_of_viser_only_those_are_passed_on() -> None:
    known = {kind.__name__ for kind in _messages.Message.get_subclasses()}
    assert len(known) > 100
    told = {name: refusal(packed({"type": name})) for name in known}
    assert "" not in told.values(), "none is taken without its fields"
    without_fields = {"ShareUrlRequest", "ShareUrlDisconnect", "ReplayDoneMessage", "LocalStorageClearMessage"}
    assert {name for name, why in told.items() if "is not allowed" in why} >= without_fields


def test_whoever_sends_too_fast_waits() -> None:
    async def sent(number: int) -> float:
        begun = time.monotonic()
        bucket = Bucket(10, 1.0 / 1000.0)
        for _ in range(number):
            await paced(bucket)
        return time.monotonic() - begun

    assert asyncio.run(sent(110)) >= 0.09
    assert BURST >= 2 * RATE >= 240, "a page's own rate is not slowed"


def closed(connection: ClientConnection) -> tuple[int, str]:
    """How the service closed the socket."""
    with contextlib.suppress(websockets.ConnectionClosed):
        for _ in connection:
            pass
    assert connection.close_code is not None
    return connection.close_code, connection.close_reason or ""


@pytest.mark.parametrize(
    ("message", "codes", "reason"),
    [
        (packed(UPLOAD), {1008}, "FileTransferStartUpload is not allowed here"),
        # 1006 where what was not yet sent meets a closed socket: TCP then drops the reason.
        (packed(PART | {"content": bytes(3_000_000)}), {1009, 1006}, ""),
        ("text", {1008}, "messages must be msgpack, not text"),
        (packed({"type": "ViewerCameraMessage", **CAMERA, "position": (math.nan,) * 3}), {1008}, SOUND),
    ],
    ids=["upload", "large", "text", "no numbers"],
)
def test_the_socket_is_closed_with_the_reason_and_nothing_is_left(
    service: Service, client: httpx.Client, message: bytes | str, codes: set[int], reason: str
) -> None:
    run = submit(client)
    finish(service)
    with viewing(service, client, f"/view/{run}/") as connection:
        frames_until(connection, b"/flights/nominal/path")
        connection.send(packed(GUI | {"updates": {"value": 1}}))  # of no element: passed on, and then ignored
        with suppress(ConnectionClosed):  # a large one may be refused before all of it is sent
            connection.send(message)
        found = closed(connection)
        assert found[0] in codes
        assert reason in found[1]
    until(lambda: service.app.state.viewers.open == 0)


def test_a_revoked_token_loses_its_view(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(relay, "CHECK_PERIOD", 0.05)
    run = submit(client)
    headers = {"Cookie": None, "Origin": None, "Authorization": f"Bearer {service.token('ci')}"}
    with (
        viewing(service, client, f"/view/{run}/", **headers) as ends,
        viewing(service, client, f"/view/{run}/") as lasts,
    ):
        until(lambda: service.app.state.viewers.open == 2)
        with service.engine.begin() as connection:
            revoke_token(connection, "ci")
        assert closed(ends) == (1008, "signed out")
        assert lasts.ping().wait(5)
    until(lambda: service.app.state.viewers.open == 0)


def test_one_visitor_leaves_room_for_others(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    service.app.state.viewers.most_each = 1
    with viewing(service, client, f"/view/{run}/"):
        with pytest.raises(websockets.InvalidStatus), viewing(service, client, f"/view/{run}/"):
            pass
        waiting = client.get(f"/api/v1/runs/{run}/views/{KEY}")
        assert "1 3D view" in str(problem(waiting, 503, "busy")["detail"])
        with joined(service, client, "engineer") as (_, other), viewing(service, other, f"/view/{run}/"):
            assert service.app.state.viewers.open == 2
    until(lambda: service.app.state.viewers.open == 0)
    with viewing(service, client, f"/view/{run}/"):
        pass
