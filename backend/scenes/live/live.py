"""Live simulations in a child process, one case at a time, so that none runs in the service itself.

One process serves all viewers. It starts with the first request and restarts after a failure; requests and responses
are one line of JSON each (`worker/running/processes/live.py`).
"""

from __future__ import annotations

import contextlib
import itertools
import json
import logging
import os
import subprocess
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field
from pathlib import Path
from queue import SimpleQueue
from typing import IO, Any

from campaigns.stored.replies import FieldReply, FlightReply

ROOT = Path(__file__).parents[3]
COMMAND = (sys.executable, "-P", "-m", "worker.running.processes.live")

LIMIT = 5.0
"""Time limit of a simulation [s]."""

MOST_STARTS = 3
"""Number of times that one request is retried in a new process because the code has changed."""

FIRST_LIMIT = 20.0
"""Time limit of a campaign's first simulation, which may include compilation [s]."""

START_LIMIT = 180.0
"""Time limit of the start of the process: it loads the physics, which takes minutes on an overloaded machine [s]."""

_log = logging.getLogger(__name__)


class LiveError(RuntimeError):
    """A simulation is not possible; the message is shown in the viewer."""


class _StaleError(LiveError):
    """The process ended before simulating, because its code was outdated."""


class FlightRefusedError(LiveError):
    """The simulation process rejected this case."""


@dataclass
class _OpenRequest:
    campaign: str
    limit: float
    sent: float = field(default_factory=time.monotonic)
    answer: Future[Any] = field(default_factory=Future)


class Live:
    """The interface to the child process; thread-safe."""

    def __init__(
        self, command: Sequence[str] = COMMAND, limit: float = LIMIT, first_limit: float = FIRST_LIMIT, grace: float = 0
    ) -> None:
        """grace: time for the process to end after SIGTERM before it is killed [s]; 0: it is killed at once."""
        self._grace = grace
        self._command, self._limit, self._first_limit = command, limit, first_limit
        self._lock = threading.Lock()
        self._child: _Child | None = None
        self._closed = False

    def simulate(
        self,
        campaign: Mapping[str, Any],
        digest: str,
        parameters: Mapping[str, float],
        rows: int,
        seed: int | None = None,
    ) -> FlightReply:
        """Simulate with these parameters, the others nominal: status, cost, columns, data, meta. Raises `LiveError`.

        digest: of the campaign, to recognise its first simulation. seed: of one noise realisation; None for those of
        the campaign.
        """
        request = {"campaign": campaign, "parameters": parameters, "rows": rows, "seed": seed}
        found: FlightReply = self.ask(digest, request)
        return found

    def field(
        self,
        campaign: Mapping[str, Any],
        digest: str,
        parameters: Mapping[str, float],
        time: float,
        places: Sequence[tuple[float, float]],
        seed: int | None = None,
    ) -> FieldReply:
        """The avoider's demand at positions in the plane at the vehicle's height, at a time [s] of that flight.

        All in the flight's axes; the response is described in `worker/running/processes/live.py`. Raises `LiveError`.
        """
        request = {"kind": "field", "campaign": campaign, "parameters": parameters, "time": time, "seed": seed}
        found: FieldReply = self.ask(digest, request | {"places": list(places)})
        return found

    def ask(self, digest: str, request: Mapping[str, Any]) -> Any:
        """The response to a request of the command, on the campaign of that digest. Raises `LiveError`."""
        for _ in range(MOST_STARTS):
            try:
                return self._asked_once(digest, request)
            except _StaleError:
                _log.info("the code has changed: a new simulation process loads it")
        raise LiveError("the code of this installation keeps changing; ask again once it is installed")

    def _asked_once(self, digest: str, request: Mapping[str, Any]) -> Any:
        with self._lock:
            if self._closed:
                raise LiveError("the service is stopping")
            if self._child is None or self._child.over:
                self._child = _Child(self._command, self._grace)
            child = self._child
            limit = self._limit if digest in child.simulated else self._first_limit
            pending = child.ask(request, _OpenRequest(digest, limit))
        return child.wait(pending)

    def close(self) -> None:
        """End the child; later requests are refused."""
        with self._lock:
            self._closed = True
            if self._child is not None:
                self._child.end("the service is stopping")


class _Child:
    """One instance of the process. Its thread starts it and reads from it until it ends.

    The reading thread must also start it: Linux sends the parent-death signal to the child when the starting thread
    ends.
    """

    def __init__(self, command: Sequence[str], grace: float = 0) -> None:
        self._grace = grace
        self.over, self._why = False, ""
        self._failure: type[LiveError] = LiveError
        self.simulated: set[str] = set()
        self._command = command
        self._numbers = itertools.count(1)
        self._open_requests: dict[int, _OpenRequest] = {}
        self._lines: SimpleQueue[bytes | None] = SimpleQueue()
        """The requests to be written; None at the end."""
        self._left: set[int] = set()
        """Requests that timed out while the process started; it answers them nevertheless."""
        self._ready = False
        self._begun = self._heard = time.monotonic()
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._started = threading.Event()
        threading.Thread(target=self._run, name="live flights", daemon=True).start()
        self._started.wait()

    def ask(self, request: Mapping[str, Any], pending: _OpenRequest) -> _OpenRequest:
        number = next(self._numbers)
        line = json.dumps({"id": number, **request}, allow_nan=False).encode() + b"\n"
        with self._lock:
            if self.over:
                pending.answer.set_exception(self._failure(self._why))
                return pending
            self._open_requests[number] = pending
            self._lines.put(line)
        return pending

    def _write(self, requests: IO[bytes]) -> None:
        """A thread of its own: a large request waits until the process reads, and nothing else waits with it."""
        try:
            while (line := self._lines.get()) is not None:
                requests.write(line)
                requests.flush()
        except (OSError, ValueError):  # it has ended
            self.end(_ENDED)

    def wait(self, pending: _OpenRequest) -> Any:
        """The response; ends the child if the current request exceeds its time limit."""
        while True:
            remaining = self._remaining()
            if remaining <= 0 and not pending.answer.done():
                self._exceeded(pending)
            try:
                return pending.answer.result(max(remaining, 0.01))
            except TimeoutError:
                continue

    def _exceeded(self, pending: _OpenRequest) -> None:
        """The time limit of the oldest request is exceeded. A process that still starts is not ended for that.

        It would never start where that takes longer than the limit.
        """
        if self._ready or time.monotonic() - self._begun > START_LIMIT:
            self.end("the simulation timed out; the next one starts a new simulation process")
            return
        if time.monotonic() < pending.sent + pending.limit:
            return  # it is an older one, which its own thread gives up
        with self._lock:
            left = {number for number, one in self._open_requests.items() if one is pending}
            self._open_requests = {number: one for number, one in self._open_requests.items() if number not in left}
            self._left |= left
        if left:
            pending.answer.set_exception(LiveError("the simulation process is still starting: ask again in a moment"))

    def end(self, why: str, failure: type[LiveError] = LiveError) -> None:
        """End it and fail all pending requests."""
        with self._lock:
            if not self.over:
                self.over, self._why, self._failure = True, why, failure
            pending, self._open_requests = list(self._open_requests.values()), {}
            self._lines.put(None)
        if self._process is not None:
            if self._grace:
                self._process.terminate()
                with contextlib.suppress(subprocess.TimeoutExpired):
                    self._process.wait(self._grace)
            self._process.kill()
        for one in pending:
            one.answer.set_exception(failure(why))

    def _remaining(self) -> float:
        """Remaining time of the oldest request; the child responds in order [s]."""
        with self._lock:
            oldest = next(iter(self._open_requests.values()), None)
            return 0.05 if oldest is None else max(self._heard, oldest.sent) + oldest.limit - time.monotonic()

    def _run(self) -> None:
        path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH", ""))))
        try:
            self._process = subprocess.Popen(
                self._command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                env={**os.environ, "PYTHONPATH": path},
                process_group=0,
            )
        except OSError as error:
            _log.error("%s could not be started: %s", self._command, error)
            self.end(f"the simulation process could not be started: {error.strerror}")
            return
        finally:
            self._started.set()
        # Closing it sends what a request has left unsent, to a process that may have ended.
        with contextlib.suppress(BrokenPipeError), self._process:
            assert self._process.stdin is not None
            assert self._process.stdout is not None
            threading.Thread(target=self._write, args=(self._process.stdin,), name="live requests", daemon=True).start()
            for line in self._process.stdout:
                if not self._received(line):
                    _log.error("the simulation process sent %r", line[:200])
                    self.end(
                        "the simulation process gave an unreadable answer; it will be restarted for the next simulation"
                    )
            self.end(_ENDED)

    def _received(self, line: bytes) -> bool:
        """Process one line; False if it is invalid."""
        try:
            message = json.loads(line)
            if message.get("ready"):
                with self._lock:
                    self._ready, self._heard = True, time.monotonic()
                return True
            if message.get("stale"):
                self.end(_STALE, _StaleError)
                return True
            with self._lock:
                self._heard = time.monotonic()
                pending = self._open_requests.pop(message["id"], None)
                given_up = message["id"] in self._left
        except (ValueError, AttributeError, KeyError, TypeError):
            return False
        if pending is None:
            return self.over or given_up
        if "error" in message:
            pending.answer.set_exception(FlightRefusedError(str(message["error"])))
        else:
            self.simulated.add(pending.campaign)
            pending.answer.set_result(message)
        return True


_STALE = "the code of this installation has changed; the next simulation starts a new process"
_ENDED = "the simulation process ended unexpectedly; it will be restarted for the next simulation"
