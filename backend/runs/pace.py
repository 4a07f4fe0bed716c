"""Estimates the speed and the remaining time of a run."""

from __future__ import annotations

from collections.abc import Sequence

from backend.runs.schemas import StageProgress
from campaigns.runs import StageState

FEWEST = 8
"""With fewer evaluations than this no speed is reported."""


def estimate(stages: Sequence[StageProgress]) -> tuple[float | None, float | None]:
    """Evaluations per second of the running stage, and the time left [s] if every stage uses its whole budget.

    A stage that has just started is assumed to be as fast as the run so far. Stages that end by their own rule finish
    earlier.
    """
    running = next((s for s in stages if s.state == StageState.RUNNING), None)
    if running is None:
        return None, None
    speed = _speed([running]) or _speed([s for s in stages if s.position])
    if speed is None:
        return None, None
    left = sum(max(0, s.planned - s.evaluations) for s in stages if s.state != StageState.DONE)
    return speed, left / speed


def _speed(stages: Sequence[StageProgress]) -> float | None:
    evaluations, seconds = sum(s.evaluations for s in stages), sum(s.seconds for s in stages)
    return evaluations / seconds if evaluations >= FEWEST and seconds > 0 else None
