"""What a folder repeats: the table of evaluations, the trajectories, the identity; and what it has besides."""

from __future__ import annotations

import csv
import hashlib
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from campaigns import Campaign, Catalogue, cube
from campaigns.cells import safe
from campaigns.checked.check import parameters
from campaigns.identity.identity import identity_of, simulator_of
from campaigns.results.base import EXCLUDED, FLAKY, OK, STATUS
from campaigns.versions import Versions
from worker.evidence.audit.limits import BASELINES, VIOLATING

TABLE = "evaluations.csv"
LISTED = 200
"""Reasons of failures that a record lists."""
OUTPUT, NO_REASON = "; its last output: ", "no reason was stored"
EVIDENCE = {"results", "components", "files"}
"""Of evidence.json, and of no other file."""
PARTS = EVIDENCE | {
    "verdict", "reason", "sentence", "scope", "statement", "holds_for", "values", "nominal", "worst", "stages",
    "comparison", "evaluations", "checks", "statistics", "regression", "sureness", "findings", "failures", "digest",
    "seed", "identity", "versions", "continues", "command_given", "labels", "baseline",
    "most_likely_violation", "failures_not_stored",
}  # fmt: skip
"""Of result.json and evidence.json; what has another name is no part of a record, and nothing compares it."""


def compared(
    folder: Path,
    evidence: Mapping[str, Any],
    campaign: Campaign,
    arrays: Sequence[Any],
    stage: Any,
    reasons: Mapping[int, Mapping[str, str]],
) -> dict[str, tuple[Any, Any]]:
    """By name: the digest of each file as stated and as it is; the number of evaluations, and of those in the table."""
    known = evidence.get("files")
    if not isinstance(known, dict):
        return {"files": ("absent", "files")}
    found: dict[str, tuple[Any, Any]] = {
        f"files.{name}": (stated, _digest(folder / name)) for name, stated in known.items()
    }
    beside = {path.name for path in folder.glob("trace-*.csv")} - known.keys()
    found |= {f"files.{name}": ("no such file", _digest(folder / name)) for name in beside}
    expected = {TABLE, *(f"trace-{name}.csv" for name in ("nominal", *(f["label"] for f in evidence["findings"])))}
    found["files.table"] = (TABLE if TABLE in known else "absent", TABLE)
    found["files.others"] = (sorted(known.keys() - expected), [])
    found["files.names"] = (sorted(evidence.keys() - PARTS), [])
    found |= {f"identity.{name}": pair for name, pair in _identity(evidence, campaign).items()}
    if isinstance(evidence.get("components"), Catalogue):
        found["files.rows"] = (len(stage), _rows(folder / TABLE, campaign, evidence, arrays, stage, reasons))
    if (Versions.of(evidence["versions"]).wording or 0) >= BASELINES:
        found["files.failures"] = (evidence.get("failures", []), _failures(arrays[2], stage, reasons))
        follows = _not_stored(evidence.get("results") or (), arrays[2], stage)
        states = (Versions.of(evidence["versions"]).wording or 0) >= VIOLATING  # earlier versions did not
        found["files.failures_not_stored"] = (evidence.get("failures_not_stored", 0 if states else follows), follows)
    if note := evidence.get("baseline"):
        named = "No baseline: " if campaign.baseline is None else campaign.baseline.run
        found["files.baseline"] = (note, note if named in note else f"one that states {named}")
    return found


def _failures(status: Any, stage: Any, reasons: Mapping[int, Mapping[str, str]]) -> list[Mapping[str, Any]]:
    """The reasons of failed evaluations, the most frequent first, each with the first that it has."""
    found: dict[tuple[str, str], Mapping[str, Any]] = {}
    many: Counter[tuple[str, str]] = Counter()
    for k in np.unique(stage).tolist():
        for index, code in enumerate(status[stage == k].tolist()):
            if code in (OK, EXCLUDED) or code >= len(STATUS):
                continue
            why, _, output = (reasons.get(k, {}).get(str(index)) or NO_REASON).partition(OUTPUT)
            key = (STATUS[code], why)
            many[key] += 1
            found.setdefault(key, {"status": key[0], "reason": why, "stage": k, "index": index, "output": output})
    return [{**found[key], "evaluations": times} for key, times in many.most_common(LISTED)]


def _not_stored(results: Sequence[Any], status: Any, stage: Any) -> int:
    """How many failed evaluations are only counted."""
    failed, found = (status != OK) & (status != EXCLUDED), 0
    for k, result in enumerate(results):
        if blocks := (result or {}).get("blocks"):
            found += sum(blocks["failed"]) - int(np.count_nonzero(failed & (stage == k)))
    return found


def _identity(evidence: Mapping[str, Any], campaign: Campaign) -> dict[str, tuple[Any, Any]]:
    """The identity as stated, and as it follows from the versions; a folder has no others for the rest of it."""
    of = identity_of(Versions.of(evidence["versions"]), simulator_of(campaign)).model_dump(mode="json")
    stated = evidence.get("identity") or {}
    return {name: (stated.get(name), of[name]) for name in of if name not in ("evaluating", "machine")}


def _digest(path: Path) -> str:
    if path.name != str(path.relative_to(path.parent)) or not path.is_file():
        return "no such file"
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _rows(
    path: Path, campaign: Campaign, evidence: Mapping[str, Any], arrays: Sequence[Any], stage: Any,
    reasons: Mapping[int, Mapping[str, str]],
) -> int:  # fmt: skip
    """How many rows of the table are the evaluations in their order, with nothing else; none under another header."""
    points, costs, status = arrays
    known = parameters(campaign, evidence["components"])
    bounds = [u.interval(known[name][1]) for name, u in campaign.uncertain.items()]
    low, high = (np.array(ends) for ends in zip(*bounds, strict=True))
    values = cube.natural(points, [known[name][1] for name in campaign.uncertain], low, high)
    index = np.concatenate([np.arange(n) for n in np.unique(stage, return_counts=True)[1]])
    plan = dict(enumerate(evidence["stages"]))
    criteria: list[dict[str, str]] = next(
        (r["criteria"] for r in evidence.get("results", ()) if r and "criteria" in r), []
    )
    further = [f"{one['name']} [{one['unit']}]" if one["unit"] else one["name"] for one in criteria[1:]]
    signs = np.array([-1.0 if one["worse"] == "high" else 1.0 for one in criteria[1:]])
    header = ["stage", "kind", "method", "index", "status", "cost", *further, *campaign.uncertain, "reason"]
    same, states = 0, dict(enumerate(STATUS))
    stages, indices, codes, first = (each.tolist() for each in (stage, index, status, costs[:, 0]))
    with path.open(newline="", encoding="utf-8") as file:
        table = csv.reader(file)
        if next(table, None) != header:
            return 0
        for k, row in enumerate(table):
            if k >= len(stages):
                same -= 1
                continue
            of, ok = plan.get(stages[k], {"kind": None, "method": None}), codes[k] == OK
            state, cost = states.get(codes[k]), repr(float(first[k])) if ok else ""
            beside = [""] * len(further)
            if ok and further:
                beside = [*map(repr, (signs * costs[k, 1:]).tolist())]
            begin = [str(stages[k]), of["kind"], of["method"] or "", str(indices[k]), state, cost, *beside]
            why = reasons.get(stages[k], {}).get(str(indices[k]), "")
            fits = row == [*begin, *map(repr, values[k].tolist()), safe(why)]
            # What succeeded has no reason, but that of an earlier call that failed.
            same += fits and (not ok or not why or why.startswith(FLAKY))
    return same
