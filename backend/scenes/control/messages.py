"""The messages that a page may send to its viewer: camera, panel values, clicks; limited in size and rate.

viser itself would also accept files, messages for unused features, and new values for any attribute of a panel element.
A frame holds one msgpack message (viser 1.1.1, `WebsocketClientWorker.ts`).
"""

from __future__ import annotations

import asyncio

from viser import _messages

from backend.access.rates import Bucket

LARGEST = 65_536
"""Maximum size of a message; a camera has 0.3 kB [bytes]."""

ALLOWED = (
    _messages.ViewerCameraMessage,
    _messages.GuiUpdateMessage,
    _messages.ScenePointerMessage,
    _messages.SceneNodeClickMessage,
)

RATE, BURST = 200.0, 400
"""Maximum message rate and burst; a page sends at most about 120 per second (viser's own throttling)."""


async def paced(bucket: Bucket) -> None:
    """Delay a sender that exceeds the rate, so that the event loop stays responsive."""
    while missing := bucket.wait():
        await asyncio.sleep(missing)


def refusal(message: bytes | str) -> str:
    """The reason to refuse a message, at most 123 bytes as in a socket's close frame; empty if it is allowed."""
    if isinstance(message, str):
        return "messages must be msgpack, not text"
    if len(message) > LARGEST:
        return f"a message has at most {LARGEST} bytes"
    try:
        content = _messages.Message.deserialize(message)
    except Exception:  # decoding arbitrary bytes may raise any exception
        return "not a message of viser"
    if not isinstance(content, ALLOWED):
        return f"{type(content).__name__[:60]} is not allowed here"
    if isinstance(content, _messages.GuiUpdateMessage) and set(content.updates) != {"value"}:
        return "only the value of an element can be changed"
    return ""
