"""The reasons why evaluations failed are counted without the output of the simulator, and shown with one example."""

from __future__ import annotations

import numpy as np

from campaigns.results.base import EXCLUDED, FAILED, OK, TIMEOUT
from campaigns.stored.records import Columns, StagePlan, StageRecord
from clearance.local.failures import MOST, OUTPUT, UNKNOWN, failures, lines
from worker.running.runs.store import MemoryStore


def store(*stages: tuple[list[int], dict[int, str]]) -> MemoryStore:
    """Stages with these statuses and reasons."""
    chunks = {}
    for k, (status, reasons) in enumerate(stages):
        n = len(status)
        chunks[k] = [Columns(np.zeros((n, 1)), np.zeros((n, 1)), np.array(status, np.uint8), np.zeros(n), reasons)]
    return MemoryStore(stages=[StageRecord(StagePlan("search", "direct", 9)) for _ in stages], chunks=chunks)


def test_what_failed_is_counted_by_reason_and_status() -> None:
    crash, late = "its process was killed by SIGSEGV", "no answer within 5 s"
    found = failures(
        store(
            ([OK, FAILED, EXCLUDED], {1: f"{crash}; its last output: working on 3", 2: "it starts inside"}),
            ([TIMEOUT, FAILED, FAILED, OK], {0: late, 1: crash, 3: "succeeded when tried again: x"}),
        )
    )
    assert [(f.evaluations, f.status, f.stage, f.index, f.reason) for f in found] == [
        (2, "failed", 0, 1, crash),
        (1, "timeout", 1, 0, late),
        (1, "failed", 1, 2, UNKNOWN),
    ]
    assert found[0].output == "working on 3"


def test_lines_for_the_terminal() -> None:
    assert lines(store(([OK, OK], {}))) == []
    one = lines(store(([FAILED], {0: f"it crashed{OUTPUT}a\nb"})))
    assert one[1:] == [f"  1 failed (0:0): it crashed{OUTPUT}a b"]
    many = lines(store(([FAILED] * 20, {k: f"reason {k}" for k in range(20)})))
    assert len(many) == 1 + MOST + 1
    assert many[-1].startswith(f"  and {20 - MOST} further reasons")
