"""A finding of a baseline is "fixed" only if nothing that the run knows in its basin violates; truth by dense lines.

Two vehicles with other avoidance: the findings of the earlier one are cases of its violations, found by brute force.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from campaigns.asked.load import load_document
from campaigns.results import Finding
from campaigns.results.base import OK
from campaigns.results.regression import Regression, Standing
from clearance.testing.problems import Problem
from tests.adversary.classes import MASSES, avoider, campaign, circle
from worker.engine.systems.base import Floats
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

COUNTS = [1, pytest.param(40, marks=[pytest.mark.nightly, pytest.mark.timeout(1200)])]
"""Campaigns by day and by night."""
STEPS = 60
"""Points between a case and a violation."""


def costs(document: dict[str, Any], points: Floats) -> Floats:
    problem = Problem(load_document(document))
    batch, _ = problem.system.simulate_vectors(problem.vectors(points), problem.system.step)
    return np.where(batch.status == OK, batch.costs[:, 0], np.inf)


def changed_avoidance(random: np.random.Generator) -> tuple[dict[str, Any], list[list[float]]]:
    """A campaign whose baseline violated in several places, and the points of these."""
    gain, y = float(random.uniform(2.0, 5.0)), float(random.uniform(3.3, 4.7))
    uncertain = MASSES | {"obstacles.0.position.x": {"low": 3.3, "high": 4.7}}
    made = campaign(
        "changed avoidance", random, frozenset(), scenario__obstacles=[circle(4.0, y)], uncertain=uncertain,
        scenario__avoider=avoider(gain), stages__certify={"samples": 60},
    ).document  # fmt: skip
    points = random.random((400, 3))
    before = costs(made, points)
    threshold = float(np.quantile(before, random.uniform(0.05, 0.5)))
    rows = random.choice(np.flatnonzero(before <= threshold), 4, replace=False)
    problem = Problem(load_document(made))
    cases = [
        {"label": f"F{k}", "parameters": problem.named(points[row]), "cost": float(before[row]), "difference": 0.0}
        for k, row in enumerate(sorted(rows, key=lambda row: before[row]), 1)
    ]
    made["scenario"]["avoider"] = avoider(gain * float(random.uniform(0.9, 3.0)))
    made["criterion"] = made["criterion"] | {"threshold": threshold}
    made["baseline"] = {"run": "R-0001", "digest": "0" * 64, "threshold": threshold, "cases": cases}
    return made, [points[row].tolist() for row in sorted(rows, key=lambda row: before[row])]


def ran(document: dict[str, Any]) -> tuple[Regression, list[Finding]]:
    store = MemoryStore()
    execute(load_document(document), store, threads=1)
    assert store.verdict is not None
    assert store.verdict.regression is not None
    return store.verdict.regression, store.findings


@pytest.mark.parametrize("count", COUNTS)
def test_nothing_is_fixed_that_falls_to_a_violation_without_a_rise(count: int) -> None:
    fixed = violating = 0
    for seed in range(count):
        document, points = changed_avoidance(np.random.default_rng([20_261_124, 8, seed]))
        regression, findings = ran(document)
        threshold = document["criterion"]["threshold"]
        low = [np.array(f.point) for f in findings if f.cost <= threshold]
        violating += bool(low)
        for case in regression.cases:
            if case.standing is not Standing.FIXED:
                continue
            fixed += 1
            start = np.array(points[int(case.before[1:]) - 1])
            assert costs(document, start[None, :])[0] > threshold, case.text
            for end in low:
                along = costs(document, np.linspace(start, end, STEPS))
                assert (np.diff(along) > 1e-6).any(), f"{case.text}: it falls to {end}, which violates"
    assert fixed or count < 40, "no attack had anything that is fixed"
    assert violating >= count / 4, violating
