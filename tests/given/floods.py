"""Floods of connections on a service, each in a process of its own, and somebody who asks meanwhile.

`python -m tests.given.floods` reads its orders as JSON from standard input; `flooded` starts it.
"""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import json
import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field

RENEWED = 1.0
"""A connection that was closed is opened again after this time [s]."""
PACE = 0.1
"""Time between two bytes of whoever sends slowly, and between two questions [s]."""

_HOST = "Host: localhost\r\n"
_FORM = f"{_HOST}Content-Type: application/x-www-form-urlencoded\r\n"
_UPGRADE = (
    f"Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {'A' * 22}==\r\n"
)
_POST = f"POST /login HTTP/1.1\r\n{_FORM}"
_HALF = "Content-Length: 1000\r\n\r\nname="

STRANGERS = {
    "idle": "",
    "half a head": f"GET /api/v1/health HTTP/1.1\r\n{_HOST}X-A: ",
    "half a body of /login": _POST + _HALF,
    "half a body of /invite": f"POST /invite HTTP/1.1\r\n{_FORM}{_HALF}",
    "a body in chunks without an end": f"{_POST}Transfer-Encoding: chunked\r\n\r\n5\r\nname=\r\n",
    "Expect: 100-continue": f"{_POST}Expect: 100-continue\r\nContent-Length: 1000\r\n\r\n",
    "half a body after a request": f"GET /api/v1/health HTTP/1.1\r\n{_HOST}\r\n{_POST}{_HALF}",
    "many requests at once": f"GET /api/v1/health HTTP/1.1\r\n{_HOST}\r\n" * 50,
    "a socket with a long path": f"GET /view/{'x' * 9000} HTTP/1.1\r\n{_HOST}{_UPGRADE}\r\n",
    "a socket with a long header": f"GET /view/R-0001/ HTTP/1.1\r\n{_HOST}{_UPGRADE}X-A: {'x' * 9000}\r\n\r\n",
    "a socket whose page does not come": (
        f"GET /view/R-0001/key/0b6c1e0e-4f5a-4a3b-9d1c-2f8e7a6b5c4d/ HTTP/1.1\r\n{_HOST}{_UPGRADE}Origin: null\r\n"
        "Sec-WebSocket-Protocol: viser-v1.1.1\r\n\r\n"
    ),
    "half a head of a socket": f"GET /view/R-0001/ HTTP/1.1\r\n{_HOST}{_UPGRADE}",
    "a byte every 0.1 s": f"GET /api/v1/health HTTP/1.1\r\n{_HOST}X-A: {'x' * 10_000}",
}
"""What visitors without a login send, by name."""

VIEWERS = {
    "event streams": f"GET /api/v1/events HTTP/1.1\r\n{_HOST}",
    "3D views": f"GET /view/R-0001/ HTTP/1.1\r\n{_HOST}{_UPGRADE}Sec-WebSocket-Protocol: viser-v1.1.1\r\n",
    "pages that wait for a view": (
        f"GET /api/v1/runs/R-0001/view/0b6c1e0e-4f5a-4a3b-9d1c-2f8e7a6b5c4d?wait=10 HTTP/1.1\r\n{_HOST}"
    ),
    "runs": f"GET /api/v1/runs HTTP/1.1\r\n{_HOST}",
}
"""What a viewer sends with tokens in turn, by name."""


@dataclass(frozen=True)
class Flood:
    """So many connections from these addresses, all open at the same time, each opened again when it is closed."""

    port: int
    kind: str
    sent: str
    """Its request up to where it stops."""
    tokens: tuple[str, ...] = ()
    """Sent in turn; then the request is complete."""
    connections: int = 1000
    sources: tuple[str, ...] = ("127.0.0.1",)
    """Addresses of this machine, in turn."""
    reads: bool = True


@dataclass
class Asked:
    """How long the answers to one question took, each on a connection of its own [s]."""

    path: str
    seconds: list[float] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)
    """The answers that were not 200, and broken connections."""


@contextmanager
def flooded(flood: Flood) -> Iterator[None]:
    """The flood, once each of its connections was opened."""
    command = [sys.executable, "-m", "tests.given.floods"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            process.stdin.write(json.dumps(asdict(flood)) + "\n")
            process.stdin.flush()
            assert process.stdout.readline() == "open\n"
            yield
        finally:
            process.kill()


def ask(port: int, path: str, seconds: float, token: str = "", source: str = "127.0.0.1") -> Asked:
    """Ask again and again for that time, each time as a new client."""
    found, end = Asked(path), time.monotonic() + seconds
    head = f"GET {path} HTTP/1.1\r\n{_HOST}{_bearer(token)}Connection: close\r\n\r\n".encode()
    while time.monotonic() < end:
        began = time.monotonic()
        try:
            with socket.create_connection(("127.0.0.1", port), 20, (source, 0)) as connection:
                connection.sendall(head)
                answer = b""
                while part := connection.recv(65536):
                    answer += part
            if not answer.startswith(b"HTTP/1.1 200 "):
                found.failed.append(answer[:40].decode("latin-1") or "closed without an answer")
        except OSError as error:
            found.failed.append(type(error).__name__)
        found.seconds.append(time.monotonic() - began)
        time.sleep(PACE)
    return found


def _bearer(token: str) -> str:
    return f"Authorization: Bearer {token}\r\n" if token else ""


async def _flood(flood: Flood) -> None:
    tokens, sources = itertools.cycle(flood.tokens or ("",)), itertools.cycle(flood.sources)
    each = [asyncio.Event() for _ in range(flood.connections)]
    loops = [asyncio.create_task(_renewed(flood, next(tokens), next(sources), opened)) for opened in each]
    for opened in each:
        await opened.wait()
    print("open", flush=True)
    await asyncio.gather(*loops)


async def _renewed(flood: Flood, token: str, source: str, opened: asyncio.Event) -> None:
    end = f"{_bearer(token)}\r\n" if token else ""
    sent = (flood.sent + end).encode()
    while True:
        writer = None
        with contextlib.suppress(OSError):
            reader, writer = await asyncio.open_connection("127.0.0.1", flood.port, local_addr=(source, 0))
            opened.set()
            slow = flood.kind == "a byte every 0.1 s"
            sending = asyncio.create_task(_dripped(writer, sent)) if slow else None
            if sending is None:
                writer.write(sent)
            while flood.reads and await reader.read(65536):
                pass
            if not flood.reads:
                await asyncio.Event().wait()
            if sending is not None:
                sending.cancel()
        if writer is not None:
            writer.transport.abort()
        opened.set()
        await asyncio.sleep(RENEWED)


async def _dripped(writer: asyncio.StreamWriter, sent: bytes) -> None:
    with contextlib.suppress(OSError):
        for byte in sent:
            writer.write(bytes([byte]))
            await asyncio.sleep(PACE)


if __name__ == "__main__":
    os.nice(5)  # a flood comes from other machines, whose processors are not the service's
    asyncio.run(_flood(Flood(**json.loads(sys.stdin.readline()))))
