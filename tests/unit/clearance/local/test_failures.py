"""The reasons why evaluations failed are counted without the output of the simulator, and shown with one example."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from campaigns.asked.load import load_document
from campaigns.results.base import EXCLUDED, FAILED, OK, TIMEOUT
from campaigns.stored.records import Columns, StagePlan, StageRecord
from clearance.local.failures import MOST, OUTPUT, UNKNOWN, failures, lines, not_stored
from tests.audited import audited
from tests.given.corrupted_records import Folder, copied, made
from tests.given.sampled_stages import DRAWN
from tests.simulators import noisy
from tests.simulators.adversaries import adversary
from worker.evidence.audit.judge import closing
from worker.evidence.audit.limits import VIOLATING
from worker.running.runs.runner import execute
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


@pytest.mark.nightly
def test_what_failed_and_is_only_counted_is_in_the_list_as_well(tmp_path: Path) -> None:
    """The list and that number are all failures of the verdict, in the terminal, in the files and for the audit."""
    document = noisy.campaign().document()
    document["stages"]["certify"] = {"samples": 4000, "keep": "lowest"}
    with adversary(lost=lambda call: FAILED if call.b > 0.5 else OK):
        campaign = load_document(document)
        ran = MemoryStore(sample_seed=DRAWN)
        verdict = execute(campaign, ran, threads=1)
        assert verdict.evaluations is not None
        more = not_stored(ran)
        assert more > 0
        assert more + sum(one.evaluations for one in failures(ran)) == verdict.evaluations.failed
        assert lines(ran)[-1].startswith(f"  {more:,} more ")
        folder = Folder(copied(made(campaign, ran), tmp_path))
        assert folder.result["failures_not_stored"] == more
        audited(folder.path)
        for wrong in ({"failures_not_stored": more - 1}, {}):
            del folder.result["failures_not_stored"]
            folder.result |= wrong
            folder.reseal()
            assert [item.name for item in folder.items() if item.agrees is False] == ["files.failures_not_stored"]
            folder.result["failures_not_stored"] = more
        del folder.result["failures_not_stored"]
        folder.result["versions"]["wording"] = VIOLATING - 1
        folder.reseal()
        assert closing(folder.items())[0]  # earlier versions did not state it


def test_lines_for_the_terminal() -> None:
    assert lines(store(([OK, OK], {}))) == []
    one = lines(store(([FAILED], {0: f"it crashed{OUTPUT}a\nb"})))
    assert one[1:] == [f"  1 failed (0:0): it crashed{OUTPUT}a b"]
    many = lines(store(([FAILED] * 20, {k: f"reason {k}" for k in range(20)})))
    assert len(many) == 1 + MOST + 1
    assert many[-1].startswith(f"  and {20 - MOST} further reasons")
