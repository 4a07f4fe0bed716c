"""Why evaluations of a run failed: the distinct reasons, how many evaluations each has, and where the first one is."""

from __future__ import annotations

from dataclasses import dataclass

from campaigns.results.base import EXCLUDED, OK, STATUS
from worker.running.runs.store import MemoryStore

MOST = 12
"""Reasons that are printed; evaluations.csv has that of every evaluation."""
OUTPUT = "; its last output: "
"""Before the last lines that a simulator wrote, which may differ from evaluation to evaluation."""
UNKNOWN = "no reason was stored"


@dataclass
class Failure:
    """A reason without the simulator's output, the evaluations that failed for it, and the first; as in result.json."""

    status: str
    reason: str
    stage: int
    index: int
    output: str
    """The last lines that the simulator wrote in the first of them; empty if there are none."""
    evaluations: int = 0


def failures(store: MemoryStore) -> list[Failure]:
    """The reasons of failed and timed-out evaluations of all stages, the most frequent first."""
    found: dict[tuple[str, str], Failure] = {}
    for stage in range(len(store.stages)):
        columns = store.evaluations(stage)
        for index, code in enumerate([] if columns is None else columns.status.tolist()):
            if columns is None or code in (OK, EXCLUDED):
                continue
            reason, _, output = (columns.reasons.get(index) or UNKNOWN).partition(OUTPUT)
            one = found.setdefault((STATUS[code], reason), Failure(STATUS[code], reason, stage, index, output))
            one.evaluations += 1
    return sorted(found.values(), key=lambda one: -one.evaluations)


def not_stored(store: MemoryStore) -> int:
    """How many failed evaluations are counted and not stored, so that their reasons are not known."""
    return sum(stage.result.beside.failed for stage in store.stages if stage.result is not None)


def lines(store: MemoryStore) -> list[str]:
    """The reasons for the terminal; empty if nothing failed."""
    found, more = failures(store), not_stored(store)
    if not found and not more:
        return []
    text = ["Failed evaluations by reason, with the stage and index of the first:"]
    for one in found[:MOST]:
        output = f"{OUTPUT}{' '.join(one.output.split())}" if one.output else ""
        text.append(f"  {one.evaluations:,} {one.status} ({one.stage}:{one.index}): {one.reason}{output}")
    if len(found) > MOST:
        text.append(f"  and {len(found) - MOST:,} further reasons, in evaluations.csv and result.json of --out")
    if more:
        text.append(f"  {more:,} more of the sample, which are counted and not stored")
    return text
