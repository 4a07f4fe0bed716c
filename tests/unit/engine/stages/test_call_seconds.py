"""What one call took, read from the times at which the evaluations of the first stage ended."""

from __future__ import annotations

import numpy as np
import pytest

from campaigns.results.measured import Measured
from campaigns.stored.records import Columns
from worker.engine.stages.parts.noise import call_seconds, start_seconds

POINTS = 5
START = 3.0
"""Of the first process [s]."""


def ended(slots: int, each: float, calls: int = 1) -> Columns:
    """The first stage of a simulator of which every call takes `each` [s]; the fresh processes take twice as long."""
    turns = [-(-(k + 1) * calls // slots) * each for k in range(POINTS)]
    first = START + each * -(-calls // slots)
    seconds = [first, *(first + t for t in turns[: POINTS - 1])]
    seconds += [seconds[-1] + t for t in turns]
    seconds += [seconds[-1] + 2 * t for t in turns]
    zeros = np.zeros((len(seconds), 1))
    return Columns(zeros, zeros, np.zeros(len(seconds), dtype=np.uint8), np.array(seconds), {})


@pytest.mark.parametrize(("slots", "calls"), [(1, 1), (2, 1), (4, 1), (5, 1), (64, 1), (1, 5), (2, 3), (4, 5), (64, 5)])
def test_it_is_that_of_one_call_however_many_run_side_by_side(slots: int, calls: int) -> None:
    assert call_seconds(ended(slots, 0.42, calls), POINTS, slots, calls) == pytest.approx(0.42)


@pytest.mark.parametrize(("slots", "calls"), [(1, 1), (2, 1), (4, 1), (5, 1), (64, 1), (1, 5), (2, 3), (4, 5), (64, 5)])
def test_a_start_is_what_a_call_in_a_fresh_process_takes_longer(slots: int, calls: int) -> None:
    assert start_seconds(ended(slots, 0.42, calls), POINTS, slots, calls) == pytest.approx(0.42)


def test_a_start_takes_no_negative_time() -> None:
    """As of noise, where each call has a process of its own anyway."""
    columns = ended(1, 0.42)
    seconds = columns.seconds.copy()
    seconds[2 * POINTS :] = seconds[2 * POINTS - 1] + np.arange(1, POINTS + 1) * 0.1
    assert start_seconds(Columns(columns.points, columns.costs, columns.status, seconds, {}), POINTS, 1, 1) == 0.0


def test_it_is_unknown_where_nothing_was_measured() -> None:
    whole = ended(1, 0.42)
    short = Columns(*(of[: 2 * POINTS - 1] for of in (whole.points, whole.costs, whole.status, whole.seconds)), {})
    assert call_seconds(short, POINTS, 1, 1) is None
    still = Columns(whole.points, whole.costs, whole.status, np.zeros_like(whole.seconds), {})
    assert call_seconds(still, POINTS, 1, 1) is None
    assert start_seconds(still, POINTS, 1, 1) is None
    two_rounds = Columns(*(of[: 2 * POINTS] for of in (whole.points, whole.costs, whole.status, whole.seconds)), {})
    assert start_seconds(two_rounds, POINTS, 1, 1) is None


def test_results_of_earlier_versions_have_none_and_stay_as_they_were() -> None:
    before = {"points": 5, "evaluations": 15, "failed": 0, "identical": True, "declared": True, "by_process": False}
    before |= {"spread": 0.0, "deviation": 0.0, "seconds": 0.1, "statement": []}
    measured = Measured.model_validate(before)
    assert (measured.call_seconds, measured.slots, measured.start_seconds, measured.recycle) == (None, None, None, None)
    assert measured.model_dump(mode="json") == {**before, "text": ""}
