"""With a baseline two violating minima with a clear ridge between them are two findings: whatever the nominal case
returns, and however large the distance is within which the campaign counts minima as one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.given.baseline_stage import against, context, ran, since
from worker.engine.search.base import Floats
from worker.engine.stages.parts import between, findings
from worker.engine.stages.parts.base import drive
from worker.engine.stages.parts.context import Context
from worker.engine.stages.parts.left import Left

NO_ENCOUNTER = 1e6
"""What a simulator may return where nothing is met."""


def wells(apart: float, nominal: float) -> Callable[[Floats], Floats]:
    """1 but for two wells so far apart, whose bottoms violate; near the nominal point, beside the line between them,
    another value."""

    def costs(points: Floats) -> Floats:
        width = apart / 4.0
        places = np.array([[0.15, 0.15], [0.15 + apart, 0.15]])
        deep = (np.array([0.7, 0.6]) * np.exp(-((points[:, None] - places) ** 2).sum(axis=2) / width**2)).sum(axis=1)
        met = np.abs(points - 0.5).max(axis=1) > 0.05
        return np.where(met, 1.0 - deep, nominal)

    return costs


def searched(apart: float, nominal: float, **changes: Any) -> tuple[Context, findings.Found]:
    """The end of a search from two cases of a baseline, one in each well."""
    function = wells(apart, nominal)
    problem = context(against({"parameters": {"vehicle.m": 5.0}}), function).problem
    places = [problem.named(np.array([x, 0.16])) for x in (0.15, 0.15 + apart)]
    made = context(against(*({"parameters": at, "cost": 0.3} for at in places), **changes), function)
    ran(made)
    found = findings.Found()
    drive(made, 2, findings.search(made, 2, found), 10**5, repeats=True)
    assert not findings.settle(made, 2, found, Left(made.campaign, False, 0))
    return made, found


@pytest.mark.parametrize("nominal", [1.0, NO_ENCOUNTER])
@pytest.mark.parametrize(
    ("apart", "distance"), [(0.6, 0.03), (0.6, 0.5), (0.085, 0.03), (0.085, 0.1), (0.085, 0.5), (0.3, 0.5)]
)
def test_a_ridge_separates_what_violates(apart: float, distance: float, nominal: float) -> None:
    made, found = searched(apart, nominal, stages__findings={"distance": distance})
    labels = [f"F{i}" for i in range(1, len(found.basins) + 1)]
    assert len([basin for basin in found.basins if basin.cost <= made.problem.threshold]) == 2
    first, second = since(made, found, labels)
    assert None not in (first, second)
    assert first != second


def test_what_separates_rests_on_the_known_violations_alone() -> None:
    for cost, allowed in ((0.3, 5e-7), (0.4999999, 1e-8), (0.5, 5e-16), (0.9, 0.0)):
        made = context(against({"parameters": {"vehicle.m": 5.0}, "cost": cost}), wells(0.6, NO_ENCOUNTER))
        assert between.ceiling(made) - 0.5 == pytest.approx(allowed, rel=1e-6, abs=1e-15)
    rough = against({"parameters": {"vehicle.m": 5.0}, "cost": 0.3}, regression={"tolerance": 0.01})
    assert between.ceiling(context(rough, wells(0.6, NO_ENCOUNTER))) == 0.51
