"""What a page may send to its viewer: camera, values of the panel, clicks in the scene; and nothing large.

viser would also take files into memory, messages for features that the viewer does not use, and new values for any
attribute of a panel's element. A frame holds one message of msgpack (viser 1.1.1, `WebsocketClientWorker.ts`). Start
reading at `refusal`.
"""

from __future__ import annotations

from viser import _messages

LARGEST = 65_536
"""Of one message; a camera has 0.3 kB [bytes]."""

ALLOWED = (
    _messages.ViewerCameraMessage,
    _messages.GuiUpdateMessage,
    _messages.ScenePointerMessage,
    _messages.SceneNodeClickMessage,
)


def refusal(message: bytes | str) -> str:
    """Why the relay must not pass this on, at most 123 bytes as a socket's close reason; empty where it may."""
    if isinstance(message, str):
        return "messages are msgpack, not text"
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
