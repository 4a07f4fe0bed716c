"""The files of a folder that repeat what others have: the table of evaluations, and the trajectories."""

from __future__ import annotations

import csv
import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from campaigns import Campaign, Catalogue, cube
from campaigns.checked.check import parameters
from campaigns.results.base import OK, STATUS

TABLE = "evaluations.csv"


def compared(
    folder: Path, evidence: Mapping[str, Any], campaign: Campaign, arrays: Sequence[Any], stage: Any
) -> dict[str, tuple[Any, Any]]:
    """By name: the digest of each file as stated and as it is; the number of evaluations, and of those in the table."""
    known = evidence.get("files")
    if not isinstance(known, dict):
        return {}
    found: dict[str, tuple[Any, Any]] = {
        f"files.{name}": (stated, _digest(folder / name)) for name, stated in known.items()
    }
    beside = {path.name for path in folder.glob("trace-*.csv")} - known.keys()
    found |= {f"files.{name}": ("no such file", _digest(folder / name)) for name in beside}
    if isinstance(evidence.get("components"), Catalogue):
        found["files.rows"] = (len(stage), _rows(folder / TABLE, campaign, evidence["components"], arrays, stage))
    return found


def _digest(path: Path) -> str:
    if path.name != str(path.relative_to(path.parent)) or not path.is_file():
        return "no such file"
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _rows(path: Path, campaign: Campaign, components: Catalogue, arrays: Sequence[Any], stage: Any) -> int:
    """How many rows of the table are the evaluations in their order: stage, index, status, cost and parameters."""
    points, costs, status = arrays
    known = parameters(campaign, components)
    bounds = [u.interval(known[name][1]) for name, u in campaign.uncertain.items()]
    low, high = (np.array(ends) for ends in zip(*bounds, strict=True))
    values = cube.natural(points, [known[name][1] for name in campaign.uncertain], low, high)
    index = np.concatenate([np.arange(n) for n in np.unique(stage, return_counts=True)[1]])
    same = 0
    with path.open(newline="", encoding="utf-8") as file:
        for k, row in enumerate(csv.DictReader(file)):
            if k < len(stage):
                cost = repr(float(costs[k, 0])) if status[k] == OK else ""
                expected = [
                    str(stage[k]),
                    str(index[k]),
                    dict(enumerate(STATUS)).get(status[k]),
                    cost,
                    *map(repr, values[k].tolist()),
                ]
                names = ["stage", "index", "status", "cost", *campaign.uncertain]
                same += [row.get(name) for name in names] == expected
            else:
                same -= 1
    return same
