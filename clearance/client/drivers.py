"""Performs the effects of scripts over HTTP: `Blocking` with httpx.Client, `Awaiting` with httpx.AsyncClient.

Both do the same, effect by effect; what they share is here as functions.
"""

from __future__ import annotations

import time
from collections.abc import AsyncIterator, Iterator, Mapping
from pathlib import Path
from typing import Any, TypeVar
from urllib.parse import urlsplit

import anyio
import httpx

from clearance.client.calls import Call
from clearance.client.effects import Effect, Emit, Line, Listen, Pause, Reply, Save, Script, Send
from clearance.client.errors import InvalidAddressError
from clearance.client.scripts import SILENCE

T = TypeVar("T")
TIMEOUT = 30.0
"""For an answer, unless the request states another time [s]."""
_BROKEN = (httpx.TransportError, httpx.StreamError)


def settings(address: str, token: str, how: Mapping[str, Any]) -> dict[str, Any]:
    """The arguments of httpx's clients, with further ones; raises `InvalidAddressError`."""
    if not token or not token.isascii() or not token.isprintable() or " " in token:
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


def _request(client: httpx.Client | httpx.AsyncClient, call: Call[Any], timeout: float | None = None) -> httpx.Request:
    headers = {} if call.key is None else {"Idempotency-Key": call.key}
    how: dict[str, Any] = {"params": dict(call.query)} if call.query else {}
    how |= {} if call.body is None else {"json": call.body}
    limit = timeout or call.timeout
    how |= {} if limit is None else {"timeout": limit}
    return client.build_request(call.method, call.address, headers=headers, **how)


def _reply(answer: httpx.Response, content: bytes) -> Reply:
    headers = {name.lower(): value for name, value in answer.headers.items()}
    return Reply(answer.status_code, answer.reason_phrase, headers, content)


def _lost(error: Exception) -> Reply:
    return Reply(0, "", {}, (str(error) or type(error).__name__).encode())


def _streams(answer: httpx.Response) -> bool:
    kind = answer.headers.get("content-type", "")
    return answer.status_code == 200 and kind.startswith("text/event-stream")


class Part:
    """A file that exists under its name only once it is complete."""

    def __init__(self, file: Path) -> None:
        self.file, self.part = file, file.with_name(f"{file.name}.part")

    def __enter__(self) -> Part:
        self._out = self.part.open("wb")
        return self

    def write(self, chunk: bytes) -> None:
        self._out.write(chunk)

    def __exit__(self, failed: object, *_: object) -> None:
        self._out.close()
        if failed is None:
            self.part.replace(self.file)
        self.part.unlink(missing_ok=True)


class Blocking:
    """Runs scripts to their end in the caller's thread."""

    def __init__(self, address: str, token: str, **how: Any) -> None:
        self._client = httpx.Client(**settings(address, token, how))

    def close(self) -> None:
        """Close the connections of the driver."""
        self._client.close()

    def run(self, script: Script[T]) -> T:
        """The result of a script; what it emits is left out."""
        iterator = self.iterate(script)
        while True:
            try:
                next(iterator)
            except StopIteration as ended:
                result: T = ended.value
                return result

    def iterate(self, script: Script[T]) -> Any:
        """Yield what a script emits; the iterator's value is its result."""
        streams: list[tuple[httpx.Response, Iterator[str]]] = []
        reply: Any = None
        try:
            while True:
                try:
                    effect = script.send(reply)
                except StopIteration as ended:
                    return ended.value
                reply = None
                if isinstance(effect, Emit):
                    yield effect.value
                else:
                    if not isinstance(effect, Line):
                        self._close(streams)
                    reply = self._perform(effect, streams)
        finally:
            script.close()
            self._close(streams)

    def _perform(self, effect: Effect, streams: list[tuple[httpx.Response, Iterator[str]]]) -> Any:
        if isinstance(effect, Pause):
            return time.sleep(effect.seconds)
        try:
            if isinstance(effect, Line):
                return next(streams[-1][1], None)
            if isinstance(effect, Listen):
                answer = self._client.send(_request(self._client, effect.call, SILENCE), stream=True)
                streams.append((answer, answer.iter_lines()))
                return _streams(answer)
            if isinstance(effect, Save):
                return self._save(effect)
            assert isinstance(effect, Send)
            answer = self._client.send(_request(self._client, effect.call))
            return _reply(answer, answer.content)
        except _BROKEN as error:
            return {Line: None, Listen: False}.get(type(effect), _lost(error))

    def _save(self, effect: Save) -> Reply:
        answer = self._client.send(_request(self._client, effect.call), stream=True)
        try:
            if not answer.is_success:
                return _reply(answer, answer.read())
            with Part(effect.file) as part:
                for chunk in answer.iter_bytes():
                    part.write(chunk)
            return _reply(answer, b"")
        finally:
            answer.close()

    def _close(self, streams: list[tuple[httpx.Response, Iterator[str]]]) -> None:
        while streams:
            streams.pop()[0].close()


class Awaiting:
    """The same with `await`; writing to files blocks for the time of the write."""

    def __init__(self, address: str, token: str, **how: Any) -> None:
        self._client = httpx.AsyncClient(**settings(address, token, how))

    async def close(self) -> None:
        """Close the connections of the driver."""
        await self._client.aclose()

    async def run(self, script: Script[T]) -> T:
        """The result of a script; what it emits is left out."""
        ended: list[T] = []
        async for _ in self.iterate(script, ended):
            pass
        return ended[0]

    async def iterate(self, script: Script[T], ended: list[T] | None = None) -> AsyncIterator[Any]:
        """Yield what a script emits; its result is added to `ended`."""
        streams: list[tuple[httpx.Response, AsyncIterator[str]]] = []
        reply: Any = None
        try:
            while True:
                try:
                    effect = script.send(reply)
                except StopIteration as stopped:
                    if ended is not None:
                        ended.append(stopped.value)
                    return
                reply = None
                if isinstance(effect, Emit):
                    yield effect.value
                else:
                    if not isinstance(effect, Line):
                        await self._close(streams)
                    reply = await self._perform(effect, streams)
        finally:
            script.close()
            await self._close(streams)

    async def _perform(self, effect: Effect, streams: list[tuple[httpx.Response, AsyncIterator[str]]]) -> Any:
        if isinstance(effect, Pause):
            return await anyio.sleep(effect.seconds)
        try:
            if isinstance(effect, Line):
                return await anext(streams[-1][1], None)
            if isinstance(effect, Listen):
                answer = await self._client.send(_request(self._client, effect.call, SILENCE), stream=True)
                streams.append((answer, answer.aiter_lines()))
                return _streams(answer)
            if isinstance(effect, Save):
                return await self._save(effect)
            assert isinstance(effect, Send)
            answer = await self._client.send(_request(self._client, effect.call))
            return _reply(answer, answer.content)
        except _BROKEN as error:
            return {Line: None, Listen: False}.get(type(effect), _lost(error))

    async def _save(self, effect: Save) -> Reply:
        answer = await self._client.send(_request(self._client, effect.call), stream=True)
        try:
            if not answer.is_success:
                return _reply(answer, await answer.aread())
            with Part(effect.file) as part:
                async for chunk in answer.aiter_bytes():
                    part.write(chunk)
            return _reply(answer, b"")
        finally:
            await answer.aclose()

    async def _close(self, streams: list[tuple[httpx.Response, AsyncIterator[str]]]) -> None:
        while streams:
            await streams.pop()[0].aclose()
