"""Ends what takes too long in the file of a component, and names the line that it is at."""

from __future__ import annotations

import contextlib
import signal
from collections.abc import Iterator
from pathlib import Path
from types import FrameType

from worker.engine.components.own import BUSY
from worker.running.examination.mistake import Mistake

AGAIN = 1.0
"""Time after which it is ended again, if the file has caught the exception [s]."""


class Overdue(Mistake):
    """It took too long; on a busy machine that may pass."""


@contextlib.contextmanager
def limited(seconds: float, file: Path, doing: str) -> Iterator[None]:
    """Raises `Overdue` in the block after this time, 0 for no limit; doing: such as "while importing it"."""

    def ended(number: int, frame: FrameType | None) -> None:
        while frame is not None and frame.f_code.co_filename != str(file):
            frame = frame.f_back
        if frame is None:
            raise Overdue(f"the check stopped after {seconds:g} s, {doing}: look for a loop that does not end; {BUSY}")
        where = frame.f_code.co_name
        place = "a loop at the top of the file" if where == "<module>" else where
        stopped = f"the check stopped after {seconds:g} s in {place}, {doing}"
        raise Overdue(f"{stopped}: give every loop a maximum number of turns; {BUSY}", frame.f_lineno)

    if not seconds:
        yield
        return
    before = signal.signal(signal.SIGALRM, ended)
    signal.setitimer(signal.ITIMER_REAL, seconds, AGAIN)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
