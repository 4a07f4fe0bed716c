"""The request, the limits and the outcome of one evaluation in a slot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

Kind = Literal["ok", "error", "timeout", "crash", "not started", "wrong answer"]


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
