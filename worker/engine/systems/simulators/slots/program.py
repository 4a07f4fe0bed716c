"""How a slot starts and speaks to a process: framed JSON on pipes of its own, or JSON lines on standard streams.

A framed process is our Python around a user's function (`child`), which may print. A process of JSON lines is any
program.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from worker.engine.systems.simulators.slots.answers import of_line
from worker.engine.systems.simulators.slots.outcome import Request

LENGTH = struct.Struct("<I")


@dataclass(frozen=True)
class Program:
    """A command line, how it is spoken to, its environment besides ours, and its folder; `{slot}` is the slot's number.

    protocol "framed": each message is its length (4 bytes, little-endian) and JSON; the first one from the process says
    that it is ready. "lines": one JSON object a line on standard input and output; other lines are ordinary output.
    ids: with "lines", each request has an `id`, and its answer must have the same one.
    """

    command: Sequence[str]
    protocol: Literal["framed", "lines"]
    environment: Mapping[str, str] = field(default_factory=dict)
    folder: str = "."
    ids: bool = False

    def placed(self, slot: int) -> Program:
        """The program for one slot."""

        def at(text: str) -> str:
            return text.replace("{slot}", str(slot))

        return replace(
            self,
            command=[at(word) for word in self.command],
            environment={name: at(value) for name, value in self.environment.items()},
            folder=at(self.folder),
        )


def framed(message: Request) -> bytes:
    """A message with its length."""
    text = json.dumps(message).encode()
    return LENGTH.pack(len(text)) + text


def line(message: Request) -> bytes:
    """A message as a line."""
    return json.dumps(message).encode() + b"\n"


def identified(message: Request, number: int) -> Request:
    """A request with its id, which comes first: a program that searches the text of the line finds it before any
    parameter of that name."""
    return {"id": number, **message}


def misidentified(answer: object, number: int) -> str:
    """Why an answer is not that of the request with this id; empty if it is."""
    fields = answer if isinstance(answer, dict) else {}
    found, but = fields.get("id"), f"; it reports: {fields['error']}" if "error" in fields else ""
    if found is None:
        expected = f"its descriptor states ids, so the id of the request, {number}, is expected in it"
        return f"its answer has no id; {expected}{but}"
    if isinstance(found, bool) or found != number:
        shown = f"{json.dumps(found):.40}" if isinstance(found, (str, int, float)) else "[...] or {...}"
        how = "it answered twice, too late or in another order"
        return f"its answer has the id {shown}, and the request has {number}: {how}{but}"
    return ""


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
        found.append(_message(bytes(buffer[at : at + size])))
        at += size
    del buffer[:at]
    return found


def _message(text: bytes) -> Any:
    try:
        return json.loads(text)
    except RecursionError:
        raise ValueError("nested too deeply") from None


def unlined(buffer: bytearray, longest: int) -> tuple[list[Any], bytes]:
    """Take the whole lines off a buffer: those that are objects, and the others as they are; raises TooLong."""
    *lines, rest = bytes(buffer).split(b"\n")
    if len(rest) > longest or any(len(text) > longest for text in lines):
        raise TooLong
    buffer[:] = rest
    found, other = [], []
    for text in lines:
        value = of_line(text)
        if value is None:
            other.append(text + b"\n")
        else:
            found.append(value)
    return found, b"".join(other)
