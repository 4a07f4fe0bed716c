"""Whether the results of a simulator repeat, and how long a call takes, measured before anything is searched."""

from __future__ import annotations

from typing import Annotated

from campaigns.documented import UNLESS_NONE
from campaigns.results.base import Described


class Measured(Described):
    """Whether evaluations of a simulator repeat, measured before anything is searched."""

    points: int
    """The nominal point, and others spread over the bounds."""
    evaluations: int
    """Of each point the same number; the last of each was in a fresh process."""
    failed: int
    identical: bool
    """All evaluations of the same point have the same status and, bit by bit, the same value."""
    declared: bool = True
    """Whether the simulator declares that it repeats."""
    by_process: bool = False
    """Evaluations in used processes are identical, those in fresh ones differ: calls in one process share their
    noise."""
    spread: float | None
    """The largest difference between evaluations of the same point, in the criterion's unit; null if no point has two
    values."""
    deviation: float | None
    """The standard deviation between evaluations of the same point, pooled over the points; null likewise."""
    seconds: float | None
    """Time per evaluation in used processes [s]: the rate at which they ended, however many ran side by side."""
    call_seconds: Annotated[float | None, UNLESS_NONE] = None
    """Time that one call took in a used process, with as many side by side as there are slots [s]; omitted where it
    was not measured."""
    slots: Annotated[int | None, UNLESS_NONE] = None
    """Calls that ran side by side; omitted where `call_seconds` is."""
    start_seconds: Annotated[float | None, UNLESS_NONE] = None
    """Time that the start of a process adds to a call in it [s], measured in fresh processes; omitted where it was not
    measured, or where calls are made in the worker's own process."""
    recycle: Annotated[int | None, UNLESS_NONE] = None
    """Calls after which a process is replaced by a fresh one; omitted if it never is."""

    @property
    def repeats(self) -> bool:
        """Whether evaluations repeat as measured and as declared."""
        return self.identical and self.declared
