"""Which findings the modes of an estimate are, from the stored evaluations on the lines between them."""

from __future__ import annotations

from typing import Any

import numpy as np

from campaigns import cube
from campaigns.claims.stages import estimate as templates
from campaigns.results.base import OK
from worker.evidence.audit.recompute import Run, Tree

BETWEEN = (0.2, 0.4, 0.6, 0.8)
"""Positions on a line that must violate."""
NEAR = 1e-9
"""Fraction of a range: parameters are converted to points and back."""


def named(run: Run) -> Tree:
    """What the result of validation must state of the modes; earlier versions stated nothing of them."""
    results = run.claims["results"]
    with_modes = [k for k, planned in enumerate(run.plan) if planned.kind == "estimate" and results[k]["modes"]]
    if not with_modes or (run.reworded and results[-1].get("modes") is None):
        return {}
    (k,) = with_modes
    violating = [
        (f, r) for f, r in zip(run.findings, run.claims["findings"], strict=True) if f["cost"] <= run.threshold
    ]
    lines = [{f["label"]: _line(run, mode, r["point"]) for f, r in violating} for mode in results[k]["modes"]]
    names = [[label for label, whole in of.items() if whole] for of in lines]
    compared = [[label for label, whole in of.items() if whole is not None] for of in lines]
    found: Tree = {"position": k, "findings": names, "compared": compared}
    if not run.reworded:
        shares = None if results[k]["alarms"] else [mode["share"] for mode in results[k]["modes"]]
        unknown = [len(of) < len(violating) for of in compared]
        unconfirmed = {f["label"] for f, _ in violating if not f["validation"]["violates"]}
        found["statement"] = templates.named(names, shares, unknown, unconfirmed)
    return {"modes": found}


def _line(run: Run, mode: Tree, end: Any) -> bool | None:
    """Whether all of the line violates; None if it is not stored."""
    points, costs, status = run.rows(len(run.plan) - 1)
    begin = cube.share(np.array([mode["parameters"][path] for path in run.bounds]), run.low, run.high)
    violates = []
    for part in BETWEEN:
        rows = np.flatnonzero((np.abs(points - (begin + part * (np.array(end) - begin))) <= NEAR).all(axis=1))
        if not len(rows):
            return None
        violates.append(bool(status[rows[0]] == OK and costs[rows[0]] <= run.threshold))
    return all(violates)
