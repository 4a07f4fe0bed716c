"""What a page may send to its viewer: camera, values of the panel, clicks in the scene; nothing large, no flood.

viser would also take files into memory, messages for features that the viewer does not use, and new values for any
attribute of a panel's element. A frame holds one message of msgpack (viser 1.1.1, `WebsocketClientWorker.ts`). Start
reading at `refusal`.
"""

from __future__ import annotations

import asyncio
import time

from viser import _messages

LARGEST = 65_536
"""Of one message; a camera has 0.3 kB [bytes]."""

ALLOWED = (
    _messages.ViewerCameraMessage,
    _messages.GuiUpdateMessage,
    _messages.ScenePointerMessage,
    _messages.SceneNodeClickMessage,
)

RATE, BURST = 200.0, 400.0
"""Messages a second, and at once; a page sends at most about 120 a second (viser's own throttles)."""


class Pace:
    """Has a sender wait who sends faster than that, so that the service's event loop is free for others."""

    def __init__(self, rate: float = RATE, burst: float = BURST) -> None:
        """rate: in 1/s."""
        self._rate, self._burst = rate, burst
        self._left, self._at = burst, time.monotonic()

    async def wait(self) -> None:
        """Returns when one more message may be taken."""
        now = time.monotonic()
        self._left, self._at = min(self._burst, self._left + (now - self._at) * self._rate) - 1, now
        if self._left < 0:
            await asyncio.sleep(-self._left / self._rate)


def refusal(message: bytes | str) -> str:
    """Why the relay must not pass this on, at most 123 bytes as a socket's close reason; empty where it may."""
    if isinstance(message, str):
        return "messages must be msgpack, not text"
    if len(message) > LARGEST:
        return f"a message has at most {LARGEST} bytes"
    try:
        given = _messages.Message.deserialize(message)
    except Exception:  # whatever a reader of arbitrary bytes may raise
        return "not a message of viser"
    if not isinstance(given, ALLOWED):
        return f"{type(given).__name__[:60]} is not allowed here"
    if isinstance(given, _messages.GuiUpdateMessage) and set(given.updates) != {"value"}:
        return "only the value of an element can be changed"
    return ""
