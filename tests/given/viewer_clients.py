"""A client of a viewer's socket in place of a browser, and its panel."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import httpx
import msgspec
import numpy as np
import viser
import websockets
import zstandard
from websockets.sync.client import ClientConnection, connect

from tests.given.service import Service

CAMERA = {
    "wxyz": (1.0, 0.0, 0.0, 0.0),
    "position": (0.0, 0.0, 20.0),
    "fov": 0.7,
    "near": 0.01,
    "far": 1000.0,
    "image_height": 500,
    "image_width": 800,
    "look_at": (0.0, 0.0, 0.0),
    "up_direction": (0.0, 0.0, 1.0),
}
KEY = "0b6c1e0e-4f5a-4a3b-9d1c-2f8e7a6b5c4d"
"""By which a page steers the viewer that it has opened."""
PROTOCOL = f"viser-v{viser.__version__}"


@contextmanager
def viewing(service: Service, client: httpx.Client, path: str, **changes: str | None) -> Iterator[ClientConnection]:
    """A viewer's socket, as a browser on our own page opens it, but for the changed headers."""
    headers = {
        "Cookie": f"{service.settings.cookie}={client.cookies[service.settings.cookie]}",
        "Origin": service.url,
        **changes,
    }
    with connect(
        f"ws://127.0.0.1:{service.port}{path}",
        additional_headers={k: v for k, v in headers.items() if v is not None},
        subprotocols=[websockets.Subprotocol(PROTOCOL)],
        compression=None,
        max_size=None,
        max_queue=None,  # unread data must not delay closing
        proxy=None,
    ) as connection:
        yield connection


def frames(connection: ClientConnection, seconds: float = 30.0) -> Iterator[bytes]:
    """What arrives within the time, unpacked."""
    deadline = time.monotonic() + seconds
    while True:
        message = connection.recv(timeout=max(0.0, deadline - time.monotonic()))
        assert isinstance(message, bytes)
        packed = int.from_bytes(message[8:16], "little")
        yield zstandard.ZstdDecompressor().decompress(message[16 : 16 + packed])


def frames_until(connection: ClientConnection, *wanted: bytes, seconds: float = 30.0) -> bytes:
    """Everything that arrives until all of these texts did."""
    received = b""
    for frame in frames(connection, seconds):
        received += frame
        if all(text in received for text in wanted):
            break
    return received


def steer(client: httpx.Client, run: str, key: str = KEY, **change: Any) -> dict[str, Any]:
    """Change the open view as its page does; returns the reported state."""
    answer = client.patch(f"/api/v1/runs/{run}/views/{key}", json=change, params={"wait": 10})
    assert answer.status_code == 200, answer.text
    return dict(answer.json())


Node = dict[str, Any]
"""The last sent position and wxyz."""


class Panel:
    """The viewer's panel, as the page fills it: elements by their label."""

    def __init__(self, connection: ClientConnection, last: str) -> None:
        """Reads until the element with the label `last`, or the tab of this name, is there."""
        self._connection = connection
        self._elements: dict[str, str] = {}
        self.nodes: dict[str, Node] = {}
        for frame in frames(connection):
            messages = msgspec.msgpack.decode(frame)["messages"]
            self._hear(messages)
            for message in messages:
                label = message.get("props", {}).get("label")
                if message["type"].startswith("Gui") and label is not None:
                    self._elements.setdefault(str(label), message["uuid"])
            if last in self._elements or any(last in m.get("props", {}).get("_tab_labels", ()) for m in messages):
                break
        # The page first reports its camera; viser ignores other messages before that.
        self.look(CAMERA["position"], CAMERA["look_at"])

    def look(self, position: Any, look_at: Any) -> None:
        """Report a camera movement to the viewer."""
        moved = {"position": tuple(map(float, position)), "look_at": tuple(map(float, look_at))}
        self._say(type="ViewerCameraMessage", **(CAMERA | moved))

    def told(self, seconds: float = 10.0) -> tuple[Any, Any]:
        """The next camera position and target sent to the page."""
        position = look_at = None
        for frame in frames(self._connection, seconds):
            for message in msgspec.msgpack.decode(frame)["messages"]:
                if message.get("initial"):  # the initial camera, also used for the reset
                    continue
                if message["type"] == "SetCameraPositionMessage":
                    position = np.array(message["position"])
                if message["type"] == "SetCameraLookAtMessage":
                    look_at = np.array(message["look_at"])
            if position is not None and look_at is not None:
                break
        assert position is not None
        assert look_at is not None
        return position, look_at

    def places(self, go: Callable[[], object], *nodes: str) -> dict[str, Node]:
        """Nodes of the scene after the view has applied a change, with their new positions."""
        go()
        missing = set(nodes)
        for frame in frames(self._connection):
            missing -= self._hear(msgspec.msgpack.decode(frame)["messages"])
            if not missing:
                break
        return {node: self.nodes[node] for node in nodes}

    def _hear(self, messages: list[dict[str, Any]]) -> set[str]:
        """Record the positions of nodes; returns those that were set."""
        placed = set()
        for message in messages:
            if message["type"] == "SetPositionMessage":
                self.nodes.setdefault(message["name"], {})["position"] = np.array(message["position"])
                placed.add(message["name"])
            if message["type"] == "SetOrientationMessage":
                self.nodes.setdefault(message["name"], {})["wxyz"] = np.array(message["wxyz"])
        return placed

    def _say(self, **message: object) -> None:
        self._connection.send(msgspec.msgpack.encode(message))
