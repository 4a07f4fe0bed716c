"""Whether a child that executes a run still moves: so long without a new result that it never will have one.

A process may be stopped, hang in native code or wait for memory while it looks alive. The time that it may stand still
follows from what it has shown so far and from what one evaluation may take.
"""

from __future__ import annotations

import time

from worker.running.runs.pulse import Pulse

FLOOR = 600.0
"""Time for which a child may always stand still [s]: compiling and integrations with error control take minutes."""
GAPS = 10.0
"""Multiples of the longest time between two results of this attempt."""
EVALUATIONS = 30.0
"""Multiples of the limit of one evaluation: some findings are confirmed one evaluation after the other."""


class Standstill:
    """Of one attempt, from its begin; `floor` in place of `FLOOR` [s]."""

    def __init__(self, pulse: Pulse, floor: float = FLOOR) -> None:
        self._pulse, self._floor = pulse, floor
        self._beats, self._since, self._gap = pulse.beats, time.monotonic(), 0.0

    def excuse(self) -> None:
        """Not by its fault it cannot store anything: the time begins again."""
        self._since = time.monotonic()

    def look(self) -> str:
        """Why the child is to be replaced, completing "the worker process ..."; empty if it may go on."""
        now, beats = time.monotonic(), self._pulse.beats
        if beats != self._beats:
            self._gap = max(self._gap, now - self._since)
            self._beats, self._since = beats, now
            return ""
        stood = now - self._since
        allowed = max(self._floor, GAPS * self._gap, EVALUATIONS * self._pulse.longest)
        if stood <= allowed:
            return ""
        return f"stood still: it has had no new result for {stood:.0f} s and was given {allowed:.0f} s"
