"""The event stream as a client reads it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import httpx
import pytest


class Stream:
    """The events of one connection, as they come."""

    def __init__(self, response: httpx.Response) -> None:
        self._lines = response.iter_lines()

    def blocks(self) -> Iterator[list[str]]:
        block: list[str] = []
        for line in self._lines:
            if line:
                block.append(line)
            else:
                yield block
                block = []

    def next(self, name: str) -> Any:
        """The data of the next event of that name."""
        for block in self.blocks():
            if f"event: {name}" in block:
                return json.loads(block[1].removeprefix("data: "))
        pytest.fail(f"the stream ended without an event {name!r}")

    def until(self, name: str, **expected: Any) -> None:
        """Read on to an event of that name with these values: those before it may state what was."""
        data = self.next(name)
        while any(data[key] != value for key, value in expected.items()):
            data = self.next(name)


@contextmanager
def streaming(client: httpx.Client, **query: str) -> Iterator[Stream]:
    with client.stream("GET", "/api/v1/events", params=query) as response:
        assert response.status_code == 200
        assert response.headers["content-type"].startswith("text/event-stream")
        assert response.headers["cache-control"] == "no-store"
        yield Stream(response)
