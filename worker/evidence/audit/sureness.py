"""How sure a search is, estimated again from the stored evaluations: the model a second time, on purpose.

A test compares the coefficients with those of `worker.evidence.verdicts.sureness`.
"""

from __future__ import annotations

import math

import numpy as np

from campaigns.limits import SEARCH
from campaigns.results.base import OK
from worker.evidence.audit import limits
from worker.evidence.audit.recompute import Run, Tree

MODEL, LOW, FEW, ENOUGH = (321, -0.297, -1.325), (434, -0.898, -1.586), 3, 100
"""Landscapes, constant and coefficient; and of so many parameters and fewer."""
FEWEST, MOST = (2, 50), (20, 2500)
"""Parameters, and evaluations for each of them."""


def sureness(run: Run) -> Tree | None:
    """What the record must state; None if it must state nothing."""
    if len(run.searches) != 1 or run.campaign.objectives or run.calls.noisy:
        return None
    (k,) = run.searches
    _, costs, status = run.rows(k)
    asked, n = run.campaign.stages.search[0], len(run.bounds)
    small, large = ((ends[0], ends[1] * n) for ends in (FEWEST, MOST))
    fits = small[0] <= n <= large[0] and small[1] <= asked.evaluations <= large[1]
    if asked.method != SEARCH or asked.options.get("seconds", 0.0) >= 0.02 or not fits:
        return None
    ok = np.flatnonzero(status == OK)
    if len(status) != asked.evaluations or not len(ok) or math.isnan(run.nominal):
        return None
    best = float(costs[ok].min())
    fall = run.nominal - best
    lower = limits.SAME_COST * fall
    if not lower > limits.ROUNDING * max(abs(run.nominal), abs(best)):
        return None
    as_low = np.sum((costs[ok] - best) / fall <= limits.SAME_COST)
    # Records of before `LOW` was set have the coefficients of all others, which state more.
    former = (run.claims.get("sureness") or {}).get("landscapes") == MODEL[0]
    landscapes, constant, near = LOW if n <= FEW and not former else MODEL
    z = constant + near * math.log10(min(as_low, ENOUGH))
    return {
        "chance": 1.0 / (1.0 + math.exp(-z)),
        "lower": lower,
        "landscapes": landscapes,
    }
