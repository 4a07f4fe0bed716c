"""What scripts ask of a driver (send, pause, listen), and the answers that they receive."""

from __future__ import annotations

import json
import logging
import random
import threading
import time
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime
from pathlib import Path
from typing import Any, TypeAlias, TypeVar

from clearance.client.calls import Call

T = TypeVar("T")
BUSY = (429, 502, 503, 504)
NOTICE = 2.0
"""Without an answer for so long, a notice states it [s]."""


@dataclass
class Session:
    """The service: its address; patience: how long to repeat a request that it does not answer [s].

    notify: called with a sentence, in another thread, if a request has no answer after `notice` seconds.
    """

    address: str
    patience: float
    notify: Callable[[str], object] = field(default=logging.getLogger("clearance.client").warning)
    notice: float = NOTICE
    clock: Callable[[], float] = field(default=time.monotonic)
    jitter: Callable[[], float] = field(default=random.random)

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


@dataclass(frozen=True)
class Send:
    """Send a request; results in a `Reply`."""

    call: Call[Any]


@dataclass(frozen=True)
class Save:
    """Send a request and write its answer to a file; results in a `Reply` without content."""

    call: Call[Any]
    file: Path


@dataclass(frozen=True)
class Pause:
    """Wait [s]."""

    seconds: float


@dataclass(frozen=True)
class Listen:
    """Open a stream of events; results in whether there is one."""

    call: Call[Any]


@dataclass(frozen=True)
class Line:
    """Results in the next line of the stream, None once it has ended."""


@dataclass(frozen=True)
class Emit:
    """Hand a value to the caller."""

    value: Any


@dataclass(frozen=True)
class Reply:
    """An answer; status 0: there was none, and content is the reason."""

    status: int
    phrase: str
    headers: Mapping[str, str]
    content: bytes

    @property
    def problem(self) -> Mapping[str, Any]:
        """The problem document; empty if there is none or it is incomplete."""
        if not str(self.headers.get("content-type", "")).startswith("application/problem+json"):
            return {}
        try:
            document = json.loads(self.content)
        except ValueError:
            return {}
        return document if isinstance(document, dict) else {}

    @property
    def retry_after(self) -> float | None:
        """Seconds, from either form of the header (RFC 9110, 10.2.3)."""
        header = str(self.headers.get("retry-after", "")).strip()
        if header.isascii() and header.isdigit():
            return float(header)
        try:
            return max(0.0, (parsedate_to_datetime(header) - datetime.now(UTC)).total_seconds())
        except (ValueError, TypeError):
            return None

    @property
    def again(self) -> bool:
        """Whether the same request may be answered later: nothing was answered, or the service is busy."""
        final = self.problem and self.retry_after is None  # such as a report that cannot be printed
        return self.status == 0 or (self.status in BUSY and not final)

    @property
    def message(self) -> str:
        """What was answered, in words."""
        if self.status == 0:
            return self.content.decode(errors="replace")
        return str(self.problem.get("detail") or f"it responded with {self.status}")


Effect: TypeAlias = Send | Save | Pause | Listen | Line | Emit
Script: TypeAlias = Generator[Effect, Any, T]
