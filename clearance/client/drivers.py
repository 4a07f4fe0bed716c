"""Where a blocking client and an asynchronous one differ: `Blocking` with httpx.Client, `Awaiting` with
httpx.AsyncClient.

Scripts are coroutines for both: over a driver that blocks they never wait, so that `finished` and `each` run them
without an event loop.
"""

from __future__ import annotations

import secrets
import time
from collections.abc import AsyncGenerator, AsyncIterator, Coroutine, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO, TypeVar
from urllib.parse import urlsplit

import anyio
import httpx

from clearance.client.errors import InvalidAddressError

T = TypeVar("T")
TIMEOUT = 30.0
"""For an answer, unless the request states another time [s]."""


def settings(address: str, token: str, how: Mapping[str, Any]) -> dict[str, Any]:
    """The arguments of httpx's clients, with further ones; raises `InvalidAddressError`."""
    if not token:
        raise InvalidAddressError(
            "no API token: set CLEARANCE_TOKEN, or give one (`token` in Python, --token-file on the command line); "
            "`clearance token create ci` makes one"
        )
    if not token.isascii() or not token.isprintable() or " " in token:
        raise InvalidAddressError(
            "invalid API token: it must be one ASCII word; `clearance token create ci` prints one"
        )
    try:
        base, url = urlsplit(address), httpx.URL(f"{address}/api/v1/")
        known = base.scheme in ("http", "https") and bool(base.hostname) and not (base.query or base.fragment)
    except (httpx.InvalidURL, UnicodeEncodeError, ValueError):
        known = False
    if not known:
        raise InvalidAddressError(
            f"{address!r} is not the address of a service; give one such as http://127.0.0.1:8000"
        )
    headers = {**(how.get("headers") or {}), "Authorization": f"Bearer {token}"}
    return {"timeout": TIMEOUT, **how, "base_url": url, "headers": headers}


@contextmanager
def written(file: Path) -> Iterator[BinaryIO]:
    """A file that exists under its name only once it is complete; its folder is made if there is none."""
    part = file.with_name(f".{file.name}.{secrets.token_hex(4)}.part")
    part.parent.mkdir(parents=True, exist_ok=True)
    with part.open("xb") as out:
        try:
            yield out
            out.close()
            part.replace(file)
        finally:
            part.unlink(missing_ok=True)


class Blocking:
    """In the caller's thread: nothing is waited for but by blocking."""

    def __init__(self, client: httpx.Client) -> None:
        self.client = client

    async def send(self, request: httpx.Request) -> httpx.Response:
        return self.client.send(request, stream=True)

    async def chunks(self, answer: httpx.Response) -> AsyncIterator[bytes]:
        for chunk in answer.iter_bytes():
            yield chunk

    async def lines(self, answer: httpx.Response) -> AsyncIterator[str]:
        for line in answer.iter_lines():
            yield line

    async def close(self, answer: httpx.Response) -> None:
        answer.close()

    async def sleep(self, seconds: float) -> None:
        time.sleep(seconds)


class Awaiting:
    """The same with `await`; writing to files blocks for the time of the write."""

    def __init__(self, client: httpx.AsyncClient) -> None:
        self.client = client

    async def send(self, request: httpx.Request) -> httpx.Response:
        return await self.client.send(request, stream=True)

    def chunks(self, answer: httpx.Response) -> AsyncIterator[bytes]:
        return answer.aiter_bytes()

    def lines(self, answer: httpx.Response) -> AsyncIterator[str]:
        return answer.aiter_lines()

    async def close(self, answer: httpx.Response) -> None:
        await answer.aclose()

    async def sleep(self, seconds: float) -> None:
        await anyio.sleep(seconds)


def finished(script: Coroutine[Any, Any, T]) -> T:
    """The result of a script over `Blocking`."""
    try:
        script.send(None)
    except StopIteration as ended:
        result: T = ended.value
        return result
    raise RuntimeError("a script has waited although its driver blocks")


def each(script: AsyncGenerator[T]) -> Iterator[T]:
    """What a script over `Blocking` yields."""
    try:
        while True:
            try:
                value = finished(script.__anext__())
            except StopAsyncIteration:
                return
            yield value
    finally:
        finished(script.aclose())
