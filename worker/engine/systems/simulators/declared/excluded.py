"""Cases that a simulator excludes because they show nothing, such as a start inside the zone that must stay clear.

Only the standard library is imported: the process of a slot loads it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

LONGEST = 200
"""Characters of a reason that are stored."""


class Excluded(Exception):
    """Raised by a simulator for a case that does not count: its scenario's precondition does not hold.

    The reason is stored and counted with equal ones: state the precondition, without the numbers of the case. A
    violation is never a reason; more than a tenth of excluded evaluations bars "cleared".
    """

    def __init__(self, reason: str) -> None:
        if not isinstance(reason, str) or not reason.strip():
            needs = "Excluded needs the reason in words, such as 'starts inside the zone'"
            raise ValueError(f"{needs}, given {reason!r:.60}")
        super().__init__(reason)
        self.excluded = stated(reason)


def stated(reason: str) -> str:
    """A reason as it is stored, in one line."""
    line = "".join(c if c.isprintable() else "?" for c in " ".join(reason.split()))
    return line if len(line) <= LONGEST else f"{line[: LONGEST - 3]}..."


def misstated(answer: Mapping[str, Any]) -> str:
    """Why an answer with `excluded` cannot be used; empty if it can."""
    reason = answer["excluded"]
    if not isinstance(reason, str) or not reason.strip():
        return f'its answer has excluded {reason!r:.60}; the reason in words is expected, such as "starts inside"'
    if "results" in answer:
        return "its answer has both `results` and `excluded`; give one of them"
    return ""
