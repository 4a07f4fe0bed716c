"""How a slot starts and speaks to a process: framed JSON on pipes of its own, or JSON lines on standard streams.

A framed process is Python of ours around somebody's function (`child`): the function may print whatever it wants. A
process of JSON lines is any program. Start reading at `Program`.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from worker.systems.simulators.slots.outcome import Request

LENGTH = struct.Struct("<I")


@dataclass(frozen=True)
class Program:
    """A command line, how it is spoken to, its environment besides ours, and its folder; `{slot}` is the slot's number.

    protocol "framed": each message is its length (4 bytes, little-endian) and JSON; the first one from the process says
    that it is ready. "lines": one JSON object a line on standard input and output; other lines are ordinary output.
    """

    command: Sequence[str]
    protocol: Literal["framed", "lines"]
    environment: Mapping[str, str] = field(default_factory=dict)
    folder: str = "."

    def placed(self, slot: int) -> Program:
        """The same for one slot."""

        def at(text: str) -> str:
            return text.replace("{slot}", str(slot))

        return Program(
            [at(word) for word in self.command],
            self.protocol,
            {name: at(value) for name, value in self.environment.items()},
            at(self.folder),
        )


def framed(message: Request) -> bytes:
    """A message with its length."""
    text = json.dumps(message).encode()
    return LENGTH.pack(len(text)) + text


def line(message: Request) -> bytes:
    """A message as a line."""
    return json.dumps(message).encode() + b"\n"


class TooLong(ValueError):
    """An answer is longer than allowed."""


def unframed(buffer: bytearray, longest: int) -> list[Any]:
    """Take the whole messages off the front of a buffer; raises ValueError for what is not JSON, TooLong."""
    found, at = [], 0
    while len(buffer) - at >= LENGTH.size:
        (size,) = LENGTH.unpack_from(buffer, at)
        if size > longest:
            raise TooLong
        if len(buffer) - at - LENGTH.size < size:
            break
        at += LENGTH.size
        found.append(json.loads(bytes(buffer[at : at + size])))
        at += size
    del buffer[:at]
    return found


def unlined(buffer: bytearray, longest: int) -> tuple[list[Any], bytes]:
    """Take the whole lines off a buffer: those that are JSON objects, and the others as they are; raises TooLong."""
    *lines, rest = bytes(buffer).split(b"\n")
    if len(rest) > longest or any(len(text) > longest for text in lines):
        raise TooLong
    buffer[:] = rest
    found, other = [], []
    for text in lines:
        value = _object(text)
        if value is None:
            other.append(text + b"\n")
        else:
            found.append(value)
    return found, b"".join(other)


def _object(text: bytes) -> dict[str, Any] | None:
    if not text.lstrip().startswith(b"{"):
        return None
    try:
        value = json.loads(text)
    except (ValueError, RecursionError):  # also text that is not UTF-8, and deep nesting
        return None
    return value if isinstance(value, dict) else None
