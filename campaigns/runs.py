"""What the service and the worker both say of a run: its name, its states and those of its stages."""

from __future__ import annotations

import re
from enum import StrEnum


class RunState(StrEnum):
    """What becomes of a run."""

    QUEUED = "queued"
    RUNNING = "running"
    CANCELLING = "cancelling"
    CANCELLED = "cancelled"
    FAILED = "failed"
    DONE = "done"


class StageState(StrEnum):
    """How far a stage of a run is."""

    WAITING = "waiting"
    RUNNING = "running"
    DONE = "done"


HELD = (RunState.RUNNING, RunState.CANCELLING)
"""A worker holds the run."""
ACTIVE = (RunState.QUEUED, *HELD)
"""The run goes on changing."""
ENDED = (RunState.DONE, RunState.FAILED, RunState.CANCELLED)
"""The run does not change any more."""

_NAME = re.compile(r"R-([0-9]{1,15})")


def run_name(run_id: int) -> str:
    """R-0001 of 1."""
    return f"R-{run_id:04d}"


def run_number(name: str) -> int | None:
    """1 of R-0001; None for what is no run's name."""
    match = _NAME.fullmatch(name)
    return None if match is None else int(match[1])
