"""One service: how long to try, and what scripts do with it (send, pause, listen), blocking or awaited."""

from __future__ import annotations

import logging
import math
import random
import threading
import time
from collections.abc import AsyncGenerator, Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx

from clearance.client.calls import Call
from clearance.client.drivers import Awaiting, Blocking, written
from clearance.client.errors import InvalidRequestError
from clearance.client.replies import Reply

NOTICE = 2.0
"""Without an answer for so long, a notice states it [s]."""
SILENCE = 40.0
"""A stream of events that is silent for longer has ended; the service sends a heartbeat every 15 s [s]."""
SOON = 0.05
"""The least time that a request is given [s]."""
_BROKEN = (httpx.TransportError, httpx.StreamError)


@dataclass
class Session:
    """The service: its address; patience: how long to repeat a request that it does not answer [s], 0 for one try.

    notify: called with a sentence, in another thread, if a request has no answer after `notice` seconds. until: the
    time of the clock after which everything raises `TimeoutError` with the sentence `late`.
    """

    address: str
    patience: float
    driver: Blocking | Awaiting
    notify: Callable[[str], object] = field(default=logging.getLogger("clearance.client").warning)
    notice: float = NOTICE
    clock: Callable[[], float] = field(default=time.monotonic)
    jitter: Callable[[], float] = field(default=random.random)
    until: float = math.inf
    late: str = ""

    @contextmanager
    def noticed(self) -> Iterator[None]:
        """State that there is no answer, once, if this is not left in time."""
        repeated = f", waiting up to {self.patience:g} s" if self.patience > self.notice else ""
        text = f"no answer from {self.address} for {self.notice:g} s{repeated}"
        timer = threading.Timer(self.notice, self.notify, (text,))
        timer.daemon = True
        timer.start()
        try:
            yield
        finally:
            timer.cancel()

    def check_time(self) -> None:
        """Raise `TimeoutError` if it is too late."""
        if self.clock() > self.until:
            raise TimeoutError(self.late)

    async def pause(self, seconds: float) -> None:
        """Wait [s]."""
        self.check_time()
        await self.driver.sleep(min(seconds, self._left()))

    async def send(self, call: Call[Any], file: Path | None = None, most: float = math.inf) -> Reply:
        """The answer to a request; a success without its content if that is written to a file.

        most: how long to wait for the next part of the answer [s], unless the request states that it takes longer.
        """
        self.check_time()
        try:
            answer = await self.driver.send(self._request(call, call.timeout, max(SOON, most)))
            try:
                chunks = self.driver.chunks(answer)
                if file is None or not answer.is_success:
                    return _reply(answer, b"".join([chunk async for chunk in chunks]))
                with written(file) as part:
                    async for chunk in chunks:
                        part.write(chunk)
                return _reply(answer, b"")
            finally:
                await self.driver.close(answer)
        except _BROKEN as error:
            return Reply(0, "", {}, (str(error) or type(error).__name__).encode())

    async def lines(self, call: Call[Any]) -> AsyncGenerator[str]:
        """The lines of a stream of events until it ends; none if there is no stream."""
        self.check_time()
        try:
            timeout = min(SILENCE, self._left())
            answer = await self.driver.send(self._request(call, SILENCE))
            try:
                kind = answer.headers.get("content-type", "")
                if answer.status_code == 200 and kind.startswith("text/event-stream"):
                    async for line in self.driver.lines(answer):
                        yield line
                        self.check_time()
                        if self._left() < timeout:  # silence would last beyond the limit: it is opened again with less
                            return
            finally:
                await self.driver.close(answer)
        except _BROKEN:
            return

    def _left(self) -> float:
        """The time until it is too late [s]; never 0, which would be no limit."""
        return max(SOON, self.until - self.clock())

    def _request(self, call: Call[Any], timeout: float | None, most: float = math.inf) -> httpx.Request:
        headers = {} if call.key is None else {"Idempotency-Key": call.key}
        how: dict[str, Any] = {"params": dict(call.query)} if call.query else {}
        how |= {} if call.body is None else {"json": call.body}
        usual = self.driver.client.timeout.read
        left = min(self._left(), math.inf if timeout is not None else most)
        if timeout is not None or left < (math.inf if usual is None else usual):
            how["timeout"] = min(timeout or math.inf, left)
        try:
            return self.driver.client.build_request(call.method, call.address, headers=headers, **how)
        except UnicodeEncodeError as error:
            detail = f"{str(error.object)[max(0, error.start - 20) : error.end + 20]!r} has characters that are no text"
            raise InvalidRequestError(0, "not-text", detail) from None


def _reply(answer: httpx.Response, content: bytes) -> Reply:
    return Reply(answer.status_code, answer.reason_phrase, answer.headers, content)
