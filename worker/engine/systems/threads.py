"""The number of simulation threads of this process."""

from __future__ import annotations

import os


def usual_threads() -> int:
    """CLEARANCE_THREADS, else the number of cores available to this process."""
    setting = os.environ.get("CLEARANCE_THREADS", "")
    stated = int(setting) if setting.isascii() and setting.isdigit() else 0
    return stated or len(os.sched_getaffinity(0))
