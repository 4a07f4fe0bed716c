"""Ctrl-C while the modules of the command line are loaded: the process ends at once, with the code of an interrupt.

Nothing has begun yet that could be lost, and libraries turn an interrupt of their loading into errors of their own.
"""

import os
import signal
from types import FrameType

INTERRUPTED = 130


def _end(number: int, frame: FrameType | None) -> None:
    os.write(2, b"interrupted\n")
    os._exit(INTERRUPTED)


def over() -> None:
    """An interrupt raises `KeyboardInterrupt` again."""
    if signal.getsignal(signal.SIGINT) is _end:
        signal.signal(signal.SIGINT, signal.default_int_handler)


if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # not where a shell in the background ignores it
    signal.signal(signal.SIGINT, _end)
