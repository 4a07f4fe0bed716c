"""Whether what a worker has published is of its files as they are now, also while its child executes a run.

An idle child reports it; a busy one cannot, so that the supervisor compares the files, and another process publishes
what was edited. Requirements and the reuse of verdicts rest on this.
"""

from __future__ import annotations

import time
from collections.abc import Callable

from worker.running.processes.children import Child, ChildEndedError, Message
from worker.running.runs import sources

LEISURE = 10.0
"""Time between two comparisons, in multiples of what one takes."""
LONGEST = 300.0
"""Time for publishing [s]."""
AGAIN = 10.0
"""Time after which publishing that failed is tried again [s]."""


class Watch:
    """The files of one worker; `start` starts a process that publishes them and then reports that it is ready."""

    def __init__(self, start: Callable[[], Child]) -> None:
        self._start = start
        self._files = self._next_files = sources.present()
        self._publisher: Child | None = None
        self.superseded = False
        """Whether another process has begun to publish since the child did."""
        self._deadline = self._next = 0.0
        self._compared: float | None = None

    @property
    def age(self) -> float | None:
        """Time since the last comparison began that found no difference [s]; None if there was none."""
        return None if self._compared is None else time.monotonic() - self._compared

    @property
    def due(self) -> bool:
        """Whether it is time for another comparison."""
        return time.monotonic() >= self._next

    def child(self) -> Child:
        """A child that first publishes the files as they are now."""
        self.end()
        self.superseded = False
        self._files = sources.present()
        return self._start()

    def compared(self, began: float, same: bool) -> None:
        """Note a comparison, which began at this time of the monotonic clock."""
        ended = time.monotonic()
        self._next = ended + LEISURE * (ended - began)
        if same:
            self._compared = began

    def look(self) -> Message | None:
        """Compare the files if that is due, and have them published if they differ; what was published, once it is."""
        if self._publisher is not None:
            return self._answer(self._publisher)
        if self.due:
            began = time.monotonic()
            files = sources.present()
            self.compared(began, files == self._files)
            if files != self._files:
                self._next_files, self._publisher, self._deadline = files, self._start(), began + LONGEST
                self.superseded = True
        return None

    def end(self) -> None:
        """End the process that publishes, if there is one."""
        if self._publisher is not None:
            self._publisher.kill()
            self._publisher = None

    def _answer(self, publisher: Child) -> Message | None:
        try:
            message = publisher.receive(0.0)
            if message is None and time.monotonic() < self._deadline:
                return None
        except ChildEndedError:
            message = None
        self.end()
        if message is None:
            self._next = time.monotonic() + AGAIN
        elif message["fresh"]:
            self._files = self._next_files
            return message
        return None
