"""The request, the limits and the outcome of one evaluation in a slot, and the interface of slots."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any, Literal, Self

Kind = Literal["ok", "excluded", "error", "timeout", "crash", "not started", "wrong answer"]


@dataclass(frozen=True)
class Limits:
    """The limits of one slot.

    timeout: of an evaluation [s]; start: until a process is ready [s]; memory: address space of each of its processes
    [bytes], 0 for no limit; answer: size of one answer [bytes]; recycle: evaluations until its process is replaced, 0
    for never.
    """

    timeout: float = 60.0
    start: float = 60.0
    memory: int = 0
    answer: int = 16_000_000
    recycle: int = 0


@dataclass(frozen=True)
class Outcome:
    """One evaluation: its kind, the answer where it is ok, the reason and the last lines of output where it is not.

    An excluded one has the reason alone, so that equal reasons can be counted.

    duration [s]; answer: the JSON value that the simulator returned, not yet checked.
    """

    kind: Kind
    answer: Any = None
    reason: str = ""
    output: str = ""
    duration: float = 0.0

    @property
    def sentence(self) -> str:
        """The reason, and the last lines that the simulator wrote."""
        return f"{self.reason}; its last output: {self.output}" if self.output else self.reason


Request = Mapping[str, Any]
"""What a simulator is sent: an object of JSON."""


class Slots(ABC):
    """Slots that evaluate side by side, here or elsewhere; usable from any thread, and as a context manager."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @abstractmethod
    def submit(self, request: Request) -> Future[Outcome]:
        """Queue one evaluation; raises RuntimeError once closed."""

    def evaluate(self, requests: Sequence[Request]) -> list[Outcome]:
        """Evaluate all, in any order; the outcomes in the order of the requests."""
        return [future.result() for future in [self.submit(request) for request in requests]]

    def changed(self) -> str:
        """A sentence on files of the simulator that have changed on another machine; empty if there are none."""
        return ""

    @abstractmethod
    def close(self) -> None:
        """End all slots; what waits or runs is answered with "cancelled"."""
