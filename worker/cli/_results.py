"""What `clearance run --out DIR` leaves behind: result.json, campaign.json, evaluations.csv, a trace per case."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

from campaigns import Campaign
from worker.problem import Problem
from worker.search.base import STATUS
from worker.store import MemoryStore, Trace


def write_results(folder: Path, campaign: Campaign, store: MemoryStore, result: dict[str, Any]) -> None:
    """Write everything into the folder; numbers with all their digits."""
    (folder / "result.json").write_text(json.dumps(result, indent=2, allow_nan=False) + "\n", encoding="utf-8")
    (folder / "campaign.json").write_text(json.dumps(campaign.document(), indent=2) + "\n", encoding="utf-8")
    _write_evaluations(folder / "evaluations.csv", Problem(campaign), store)
    for trace in store.traces.values():
        _write_trace(folder / f"trace-{trace.name}.csv", trace)


def _write_evaluations(path: Path, problem: Problem, store: MemoryStore) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["stage", "kind", "method", "index", "status", "cost", *(r.path for r in problem.ranges)])
        for position, record in enumerate(store.stages):
            columns = store.evaluations(position)
            if columns is None:
                continue
            plan = record.plan
            values = problem.values(columns.points)
            for i, (status, costs) in enumerate(zip(columns.status.tolist(), columns.costs, strict=True)):
                cost = repr(float(costs[0])) if status == 0 else ""
                row = [position, plan.kind, plan.method or "", i, STATUS[status], cost]
                writer.writerow([*row, *map(repr, values[i].tolist())])


def _write_trace(path: Path, trace: Trace) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow([f"{c['name']} [{c['unit']}]" for c in trace.columns])
        writer.writerows([repr(v) for v in row] for row in trace.data.tolist())
