"""A client for a Clearance service: its REST API with a token (RFC 6750).

Refusals are reported with the service's own message (RFC 9457). The client waits for a service that restarts.
"""

from __future__ import annotations

import json
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Self

import httpx

from campaigns import CampaignError, Problem
from campaigns.documents import JsonObject
from campaigns.runs import ACTIVE
from worker.cli import UnreachableError, WrongInputError

PAUSE = 1.0
"""Time between two requests [s]."""
_BUSY = (429, 502, 503, 504)
SILENCE = 40.0
"""A stream of events that is silent for longer has ended; the service sends a heartbeat every 15 s [s]."""
LONGEST = 300.0
"""For a file that the service has to make first, such as a report [s]."""


class Remote:
    """The runs of a service."""

    def __init__(self, address: str, token: str, patience: float) -> None:
        self.address, self.patience = address.rstrip("/"), patience
        try:
            self._client = httpx.Client(
                base_url=f"{self.address}/api/v1/", headers={"Authorization": f"Bearer {token}"}, timeout=30.0
            )
        except (httpx.InvalidURL, UnicodeEncodeError, ValueError):
            raise _no_address(address) from None
        if self._client.base_url.scheme not in ("http", "https") or not self._client.base_url.host:
            raise _no_address(address)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._client.close()

    def submit(self, body: Mapping[str, Any], source: str, key: str, what: str = "runs") -> JsonObject:
        """Queue a run, or launch a sweep; a repeated request with the same key returns the same one. Raises
        `CampaignError` for a refused one."""
        answer = self._ask("POST", what, json=body, headers={"Idempotency-Key": key})
        errors = _problem(answer).get("errors")
        if answer.status_code == 422 and errors:
            problems = (Problem(e["field"].removeprefix("campaign."), e["given"], e["message"]) for e in errors)
            raise CampaignError(source, list(problems))
        return self._read(answer)

    def run(self, run: str) -> JsonObject:
        """The present state of a run."""
        return self._read(self._ask("GET", f"runs/{run}"))

    def cancel(self, run: str) -> JsonObject:
        """Cancel a run; one that has ended is unchanged."""
        return self._read(self._ask("POST", f"runs/{run}/cancel"))

    def followed(self, run: str) -> Iterator[JsonObject]:
        """The state of the run after every change until it has ended: its details at first and last, else its summary.

        Changes are events of the service; while there is no stream of them, the run is read every `PAUSE`.
        """
        while (document := self.run(run))["state"] in ACTIVE:
            yield document
            ended = False
            for summary in self._events(run):
                ended = summary is not None and summary["state"] not in ACTIVE
                if ended or summary is None:  # after a heartbeat it is read again, should an event be missing
                    break
                yield summary
            if not ended:
                time.sleep(PAUSE)
        yield document

    def _events(self, run: str) -> Iterator[JsonObject | None]:
        """The summaries of the run as the service sends them; None at a heartbeat, and nothing once the stream ends."""
        try:
            with self._client.stream("GET", "events", params={"run": run}, timeout=SILENCE) as answer:
                kind = answer.headers.get("content-type", "")
                if answer.status_code != 200 or not kind.startswith("text/event-stream"):
                    return
                name = ""
                for line in answer.iter_lines():
                    if line.startswith(":"):
                        yield None
                    elif line.startswith("event:"):
                        name = line.removeprefix("event:").strip()
                    elif line.startswith("data:") and name == "run":
                        yield json.loads(line.removeprefix("data:"))
        except (httpx.TransportError, httpx.StreamError, ValueError):
            return

    def sweep_followed(self, sweep: str) -> Iterator[JsonObject]:
        """The state of a sweep, repeatedly until every run of it has ended."""
        while set((document := self._read(self._ask("GET", f"sweeps/{sweep}")))["states"]) & set(ACTIVE):
            yield document
            time.sleep(PAUSE)
        yield document

    def save(self, path: str, file: Path) -> None:
        """Download a path of the API into a file; an incomplete download leaves no file."""
        part = file.with_name(f"{file.name}.part")
        answer = self._ask("GET", path, stream=True, timeout=LONGEST)
        try:
            if answer.is_error:
                answer.read()
                raise self._refused(answer)
            with part.open("wb") as out:
                for chunk in answer.iter_bytes():
                    out.write(chunk)
            part.replace(file)
        except httpx.TransportError as error:
            raise UnreachableError(f"{path} could not be read from {self.address}: {_message(error)}") from None
        except OSError as error:
            raise WrongInputError(f"{file} cannot be written: {error.strerror}") from None
        finally:
            answer.close()
            part.unlink(missing_ok=True)

    def _ask(self, method: str, path: str, *, stream: bool = False, **how: Any) -> httpx.Response:
        """Retry until there is an answer, at most for `patience`."""
        until = time.monotonic() + self.patience
        while True:
            try:
                answer = self._client.send(self._client.build_request(method, path, **how), stream=stream)
                if answer.status_code not in _BUSY:
                    return answer
                answer.read()
                detail = _problem(answer).get("detail") or f"it responded with {answer.status_code}"
            except httpx.TransportError as error:
                detail = _message(error)
            if time.monotonic() > until:
                raise UnreachableError(f"{self.address} did not respond for {self.patience:g} s: {detail}")
            time.sleep(PAUSE)

    def _read(self, answer: httpx.Response) -> JsonObject:
        if answer.is_error:
            raise self._refused(answer)
        try:
            document = answer.json()
        except ValueError:
            document = None
        if not isinstance(document, dict) or "id" not in document:
            raise WrongInputError(f"{self.address} is not a Clearance service: unexpected response")
        return document

    def _refused(self, answer: httpx.Response) -> WrongInputError:
        detail = _problem(answer).get("detail") or f"it responded with {answer.status_code} {answer.reason_phrase}"
        return WrongInputError(f"{self.address}: {detail}")


def _problem(answer: httpx.Response) -> JsonObject:
    """The problem document of an answer; empty if there is none or it is incomplete."""
    if not answer.headers.get("content-type", "").startswith("application/problem+json"):
        return {}
    try:
        document = answer.json()
    except ValueError:
        return {}
    return document if isinstance(document, dict) else {}


def _message(error: Exception) -> str:
    return str(error) or type(error).__name__


def _no_address(given: str) -> WrongInputError:
    return WrongInputError(f"{given!r} is not the address of a service; give one such as http://127.0.0.1:8000")
