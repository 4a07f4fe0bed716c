"""Campaigns and evaluations that the fault tests use."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from campaigns import Campaign
from campaigns.results import Finding
from campaigns.results.base import OK
from campaigns.stored.records import Columns, StagePlan, Trace
from tests import results

PLAN = [StagePlan("nominal", None, 1), StagePlan("search", "direct", 100), StagePlan("validate", None, 10)]


def campaign(**changes: Any) -> Campaign:
    """Case 1, the unicycle past one obstacle; `changes` replace its top-level entries."""
    document: Mapping[str, Any] = {
        "name": "unicycle past a pillar",
        "scenario": {
            "vehicle": {"component": "unicycle", "parameters": {"m": 5, "J": 0.05}},
            "controller": {"component": "pid_speed"},
            "avoider": {"component": "potential_field"},
            "goal": {"x": 6, "y": 7},
            "obstacles": [{"component": "static_circle", "parameters": {"position": {"x": 4, "y": 4}}}],
            "horizon": 15,
            "step": 0.005,
        },
        "uncertain": {"vehicle.m": {"plus_minus": "20%"}, "vehicle.J": {"plus_minus": "20%"}},
        "criterion": {"threshold": 0.5},
        "stages": {"search": [{"method": "direct", "evaluations": 100}]},
    }
    return Campaign.model_validate({**document, **changes})


def columns(first: int, count: int, seed: int = 1) -> Columns:
    """Evaluations whose every bit depends on the seed and the index: some failed, some timed out, some excluded."""
    rows = [np.random.default_rng([seed, first + i]).random(4) for i in range(count)]
    values = np.array(rows).reshape(count, 4)
    status = np.array([(0, 0, 0, 0, 0, 1, 2, 3)[int(8 * v)] for v in values[:, 3]], dtype=np.uint8)
    costs = np.where(status == OK, values[:, 2], np.nan)[:, None]
    seconds = 0.01 * (first + 1 + np.arange(count))
    reasons = {first + i: f"diverged at {values[i, 0]:.3f} s" for i in range(count) if status[i]}
    return Columns(np.ascontiguousarray(values[:, :2]), costs, status, seconds, reasons)


def finding(label: str = "F1", cost: float = 0.1 + 0.2) -> Finding:
    """A finding with numbers that have no short decimal form."""
    parameters = {"vehicle.m": 1 / 3 * 18, "vehicle.J": float(np.nextafter(0.06, 1))}
    known = {"point": [1.0, float(np.nextafter(1, 0))], "at_bounds": {"vehicle.m": "high"}}
    return results.finding(label, cost, cost - 0.5, parameters, **known)


def trace(name: str = "F1") -> Trace:
    """A short flight."""
    data = np.array([[0.0], [-0.0], [1e-310], [np.nan]])
    return Trace(name, results.columns(("t", "s", "time")), data, results.head(threshold=0.5))
