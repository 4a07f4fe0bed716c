"""Which findings the modes of an estimate are, from the stored evaluations on the lines between them."""

from __future__ import annotations

from typing import Any

import numpy as np

from campaigns import cube
from campaigns.claims.stages import estimate as templates
from campaigns.results.base import OK
from campaigns.results.estimate import NamedModes
from worker.evidence.audit.parts import OMIT, made
from worker.evidence.audit.recompute import Run

BETWEEN = (0.2, 0.4, 0.6, 0.8)
"""Positions on a line that must violate."""
NEAR = 1e-9
"""Fraction of a range: parameters are converted to points and back."""


def named(run: Run) -> NamedModes | None:
    """What the result of validation must state of the modes; earlier versions stated nothing of them."""
    results = run.claims["results"]
    with_modes = [k for k, planned in enumerate(run.plan) if planned.kind == "estimate" and results[k]["modes"]]
    if not with_modes or (run.reworded and results[-1].get("modes") is None):
        return None
    (k,) = with_modes
    pairs = zip(run.findings, run.claims["findings"], strict=True)
    violating = [(f, r) for f, r in pairs if f.cost <= run.threshold]
    modes = results[k]["modes"]
    lines = [{f.label: _line(run, mode["parameters"], r["point"]) for f, r in violating} for mode in modes]
    names = [[label for label, whole in of.items() if whole] for of in lines]
    compared = [[label for label, whole in of.items() if whole is not None] for of in lines]
    statement = OMIT
    if not run.reworded:
        shares = None if results[k]["alarms"] else [mode["share"] for mode in results[k]["modes"]]
        unknown = [len(of) < len(violating) for of in compared]
        unconfirmed = {f.label for f, _ in violating if not f.validation.violates}
        statement = templates.named(names, shares, unknown, unconfirmed)
    return made(NamedModes, position=k, findings=names, compared=compared, statement=statement)


def _line(run: Run, at: dict[str, float], end: Any) -> bool | None:
    """Whether all of the line violates; None if it is not stored."""
    points, costs, status = run.rows(len(run.plan) - 1)
    begin = cube.share(np.array([at[path] for path in run.bounds]), run.low, run.high)
    violates = []
    for part in BETWEEN:
        rows = np.flatnonzero((np.abs(points - (begin + part * (np.array(end) - begin))) <= NEAR).all(axis=1))
        if not len(rows):
            return None
        violates.append(bool(status[rows[0]] == OK and costs[rows[0]] <= run.threshold))
    return all(violates)
