"""What can go wrong with a service, as exceptions; their messages are the service's own sentences (RFC 9457)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from campaigns.asked.problem import Problem


class ClearanceError(Exception):
    """Every error of the client."""


class InvalidAddressError(ClearanceError, ValueError):
    """The address or the token cannot be used for any request; nothing was sent."""


class UnreachableError(ClearanceError):
    """The service did not respond in time, or is busy for longer than the client waits."""


class ReplacedError(ClearanceError):
    """The number of a run or sweep is that of another one now: the database was probably restored or replaced."""


class NotAClearanceServiceError(ClearanceError):
    """What responds at the address is not a Clearance service, or not of a version that this client can read."""


@dataclass
class RefusedError(ClearanceError):
    """The service refused the request.

    status: of HTTP; kind: the problem type, such as "not-found"; detail: what was given, what is allowed, what to do;
    problems: the invalid fields.
    """

    status: int
    kind: str
    detail: str
    address: str = ""
    problems: tuple[Problem, ...] = ()

    def __str__(self) -> str:
        return f"{self.address}: {self.detail}" if self.address else self.detail


class NotSignedInError(RefusedError):
    """401: there is no such token, or it has expired."""


class ForbiddenError(RefusedError):
    """403: the role of the user or the scope of the token does not permit it, or it belongs to another user."""


class NotFoundError(RefusedError):
    """404: there is no such run, finding or file."""


class ConflictError(RefusedError):
    """409: something else has happened meanwhile; or 412."""


class PurgedError(RefusedError):
    """410: the results of the run were permanently deleted."""


class InvalidCampaignError(RefusedError):
    """422: the campaign can be read, but cannot be run; `problems` lists the fields."""


class InvalidRequestError(RefusedError):
    """Any other 4xx: an argument does not match the description of the API."""


class RunFailedError(ClearanceError):
    """A run ended without a verdict, where one was asked for; `state` is failed or cancelled."""

    def __init__(self, run: str, state: str, reason: str) -> None:
        self.run, self.state = run, state
        super().__init__(f"{run} {state} without a verdict: {reason}")


_CLASSES: dict[int, type[RefusedError]] = {
    401: NotSignedInError,
    403: ForbiddenError,
    404: NotFoundError,
    409: ConflictError,
    410: PurgedError,
    412: ConflictError,
}


def refused(status: int, phrase: str, problem: Mapping[str, Any], address: str) -> RefusedError:
    """The exception of an answer; problem: its problem document, empty if it has none."""
    kind = str(problem.get("type", "")).rpartition(":")[2]
    detail = str(problem.get("detail") or f"it responded with {status} {phrase}".rstrip())
    errors = problem.get("errors") or ()
    found = tuple(Problem(str(e.get("field")), str(e.get("given")), str(e.get("message"))) for e in errors)
    invalid = InvalidCampaignError if status == 422 and found else InvalidRequestError
    return _CLASSES.get(status, invalid)(status, kind, detail, address, found)
