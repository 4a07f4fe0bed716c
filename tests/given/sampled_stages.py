"""A stage on a problem whose probabilities are known: evaluations are a formula instead of flights.

Two uniform parameters u, v; d = threshold - 0.2 + u + v, so that P(d <= threshold) is 0.02.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from campaigns import Campaign
from campaigns.results.base import EXCLUDED, FAILED, OK
from campaigns.sample_seed import SampleSeed
from campaigns.stored.records import StagePlan
from clearance.testing.problems import Problem
from tests.given.case_campaigns import campaign, case1
from worker.engine.search.base import Batch, Floats
from worker.engine.stages.parts.context import Context
from worker.running.catalogue.installed import methods
from worker.running.runs.store import MemoryStore

THRESHOLD = 0.5
PROBABILITY = 0.02
"""Of a violation."""


def quantile(share: float) -> float:
    """The quantile of d, for fractions below one half: u + v is at most s with probability s^2 / 2."""
    return THRESHOLD - 0.2 + float(np.sqrt(2 * share))


def costs(points: Floats) -> Floats:
    return np.asarray(THRESHOLD - 0.2 + points.sum(axis=1))


def evaluate(
    failing: Callable[[Floats], Any] = lambda points: np.zeros(len(points), dtype=bool),
    excluded: Callable[[Floats], Any] = lambda points: np.zeros(len(points), dtype=bool),
) -> Callable[[Floats], tuple[Batch, dict[int, str]]]:
    """Evaluations of the formula, some of which fail or are excluded."""

    def flown(points: Floats) -> tuple[Batch, dict[int, str]]:
        status = np.where(excluded(points), EXCLUDED, np.where(failing(points), FAILED, OK)).astype(np.uint8)
        return Batch(np.where(status == OK, costs(points), np.nan)[:, None], status), {}

    return flown


def asked(stages: dict[str, Any], **changes: Any) -> Campaign:
    """A campaign with these stages, with no more than must be."""
    given = {"search": [{"method": "direct", "evaluations": 1}], "sensitivity": None} | stages
    return campaign(stages=given, **changes)


DRAWN = SampleSeed(1, stated=False)
"""The seed of a sample, as if it had been drawn at launch: every test has the same points."""


def context(asked: Campaign, flown: Any = None, problem: Problem | None = None, seed: int | None = None) -> Context:
    """A run of one stage, at position 0, in memory."""
    seeded = asked if seed is None else asked.model_copy(update={"seed": seed})
    store = MemoryStore(sample_seed=SampleSeed(seeded.seed, stated=False))
    planned = [StagePlan("certify", None, 1)]
    store.plan(planned)
    return Context(seeded, problem or case1(), flown or evaluate(), store, plan=planned, methods=methods())
