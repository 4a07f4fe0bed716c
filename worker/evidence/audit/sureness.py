"""How sure a search is, estimated again from the stored evaluations: the model a second time, on purpose.

A test compares the coefficients with those of `worker.evidence.verdicts.sureness`.
"""

from __future__ import annotations

import math

import numpy as np

from campaigns.limits import SEARCH
from campaigns.results.base import OK
from campaigns.results.sureness import Sureness
from worker.evidence.audit import limits
from worker.evidence.audit.finders import far_above
from worker.evidence.audit.parts import made
from worker.evidence.audit.recompute import Run

MODEL, LOW, FEW = (696, -0.466, -1.231, 100), (324, -0.689, -3.026, 10), 3
"""Landscapes, constant, coefficient, and evaluations that are enough; and of so many parameters and fewer."""
FORMER, FORMER_LOW = (321, -0.297, -1.325, 100), (434, -0.898, -1.586, 100)
"""Those that earlier versions stated."""
FEWEST, MOST = (2, 50), (20, 2500)
"""Parameters, and evaluations for each of them."""
HALF = 0.5
"""The fraction of the evaluations that must have a value."""


def sureness(run: Run) -> Sureness | None:
    """What the record must state; None if it must state nothing."""
    if len(run.searches) != 1 or run.campaign.objectives or not run.calls.alike or _side_by_side(run):
        return None
    (k,) = run.searches
    _, costs, status = run.rows(k)
    request, n = run.campaign.stages.search[0], len(run.bounds)
    small, large = ((ends[0], ends[1] * n) for ends in (FEWEST, MOST))
    fits = small[0] <= n <= large[0] and small[1] <= request.evaluations <= large[1]
    if request.method != SEARCH or request.options.get("seconds", 0.0) >= 0.02 or not fits:
        return None
    ok = np.flatnonzero(status == OK)
    if len(status) != request.evaluations or len(ok) < HALF * len(status) or math.isnan(run.nominal):
        return None
    best = float(costs[ok].min())
    fall = run.nominal - best
    if run.wording >= limits.EACH and far_above(costs[ok], best, fall):
        return None
    lower = limits.SAME_COST * fall
    if not math.inf > lower > limits.ROUNDING * max(abs(run.nominal), abs(best)):
        return None
    if best - run.lowest > lower:
        return None
    as_low = np.sum((costs[ok] - best) / fall <= limits.SAME_COST)
    stated = (run.claims.get("sureness") or {}).get("landscapes")
    accepted = (LOW, FORMER, FORMER_LOW) if n <= FEW else (MODEL, FORMER)
    landscapes, constant, near, enough = next((one for one in accepted if one[0] == stated), accepted[0])
    z = constant + near * math.log10(min(as_low, enough))
    chance = 1.0 / (1.0 + math.exp(-z))
    return made(Sureness, chance=chance, lower=lower, landscapes=landscapes)


def _side_by_side(run: Run) -> bool:
    """Whether evaluations ran side by side: as the options of the search state it, or as the first stage measured, with
    a time that a process takes to start or several slots."""
    measured = (run.claims["results"][0] or {}).get("measured") or {}
    slots = measured.get("start_seconds") is not None or (measured.get("slots") or 1) > 1
    return slots or any(search.options.get("at_once", 1) != 1 for search in run.campaign.stages.search)
