"""The name of a run, its states and those of its stages, for the service and the worker."""

from __future__ import annotations

import re
from enum import StrEnum


class RunState(StrEnum):
    """The state of a run."""

    QUEUED = "queued"
    RUNNING = "running"
    CANCELLING = "cancelling"
    CANCELLED = "cancelled"
    FAILED = "failed"
    DONE = "done"


class StageState(StrEnum):
    """The state of a stage of a run."""

    WAITING = "waiting"
    RUNNING = "running"
    DONE = "done"


HELD = (RunState.RUNNING, RunState.CANCELLING)
"""A worker holds the run."""
ACTIVE = (RunState.QUEUED, *HELD)
"""States in which the run still changes."""
ENDED = (RunState.DONE, RunState.FAILED, RunState.CANCELLED)
"""States in which the run no longer changes."""

_NAME = re.compile(r"R-([0-9]{1,15})")
_SWEEP = re.compile(r"S-([0-9]{1,9})")


def run_name(run_id: int) -> str:
    """The name of a run: R-0001 for number 1."""
    return f"R-{run_id:04d}"


def run_number(name: str) -> int | None:
    """1 of R-0001; None if this is not the name of a run."""
    match = _NAME.fullmatch(name)
    return None if match is None else int(match[1])


def sweep_name(sweep_id: int) -> str:
    """The name of a sweep: S-0001 for number 1."""
    return f"S-{sweep_id:04d}"


def sweep_number(name: str) -> int | None:
    """1 of S-0001; None if this is not the name of a sweep."""
    match = _SWEEP.fullmatch(name)
    return None if match is None else int(match[1])
