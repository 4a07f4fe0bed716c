"""The messages that a page may send to its viewer: camera, panel values, clicks; limited in size and rate.

viser itself would also accept files, messages for unused features, and new values for any attribute of a panel element.
A frame holds one msgpack message (viser 1.1.1, `WebsocketClientWorker.ts`).
"""

from __future__ import annotations

import asyncio
import functools
import math
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from viser import _messages

from backend.access.rates import Bucket

LARGEST = 65_536
"""Maximum size of a message; a camera has 0.3 kB [bytes]."""

LARGEST_NUMBER = 1e9
"""Maximum size of a number of a message, such as a coordinate [m] or a size [px]."""

SOUND = f"its vectors must be complete, its numbers finite and at most {LARGEST_NUMBER:g}"

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
    return "" if _sound(content) else f"{type(content).__name__}: {SOUND}"


def _sound(content: _messages.Message) -> bool:
    """Whether every field has the type and length that viser declares, which viser does not check."""
    hints = _hints(type(content))
    if not all(_fits(value, hints[name]) for name, value in vars(content).items() if name in hints):
        return False
    return not isinstance(content, _messages.ViewerCameraMessage) or _looks(content)


def _looks(camera: _messages.ViewerCameraMessage) -> bool:
    """Whether the camera has a direction of view: viser raises an exception for one that is at its target."""
    away = math.dist(camera.position, camera.look_at)
    return min(away, math.hypot(*camera.up_direction), math.hypot(*camera.wxyz)) > 0.0


@functools.cache
def _hints(kind: type) -> dict[str, Any]:
    return get_type_hints(kind)


def _fits(value: object, hint: Any) -> bool:
    """Whether a decoded value has the declared type; numbers are finite and of limited size."""
    kinds, origin = get_args(hint), get_origin(hint)
    if origin is Union:
        return any(_fits(value, kind) for kind in kinds)
    if origin is tuple:
        if not isinstance(value, list | tuple):
            return False
        of = (kinds[0],) * len(value) if kinds[-1] is Ellipsis else kinds
        return len(value) == len(of) and all(map(_fits, value, of))
    if origin is Literal:
        return isinstance(value, str) and value in kinds
    if hint in (int, float):
        return isinstance(value, int | float) and abs(value) <= LARGEST_NUMBER  # false of NaN
    return not isinstance(hint, type) or isinstance(value, hint)
