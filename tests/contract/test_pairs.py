"""Every avoider with every vehicle of its dimension, with every controller of that vehicle.

In plain Python: what is compiled from it is held to it elsewhere.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from campaigns import check
from campaigns.asked.load import load_document
from campaigns.results.base import OK
from clearance.testing.problems import Problem
from clearance.testing.scenes import around
from worker.engine.kernels.component import Avoider, Controller, Vehicle
from worker.running.catalogue.installed import catalogue, components

STEPS = 12


def of(kind: type) -> list[Any]:
    return [c for c in components().values() if isinstance(c, kind)]


PAIRS = [(a, v, c) for a in of(Avoider) for v in of(Vehicle) if a.dimension == v.dimension
         for c in of(Controller) if v.name in c.fits]  # fmt: skip


LOOPS = list(dict.fromkeys((v.name, c.name) for _, v, c in PAIRS))
SOME = [
    pytest.param(a, v, c, marks=() if (of(Avoider).index(a) + LOOPS.index((v.name, c.name))) % 2 == 0
                 else pytest.mark.nightly)
    for a, v, c in PAIRS
]  # fmt: skip
"""By day every avoider with every other pair of a vehicle and a controller, the next avoider with the others."""


def document(avoider: Avoider, vehicle: Vehicle, controller: Controller) -> dict[str, Any]:
    made = around(vehicle)
    scenario = made["scenario"] | {
        "avoider": around(avoider)["scenario"]["avoider"],
        "controller": around(controller)["scenario"]["controller"],
        "goal": around(avoider)["scenario"]["goal"],
        "obstacles": around(avoider)["scenario"]["obstacles"],
    }
    return made | {"scenario": scenario, "uncertain": {"start.x": {"low": -1.0, "high": 1.0}}}


def test_there_are_pairs_in_the_plane_and_in_space() -> None:
    assert {a.dimension for a, _, _ in PAIRS} == {2, 3}
    assert {v.name for _, v, _ in PAIRS} == {v.name for v in of(Vehicle)}
    assert {a.name for a, _, _ in PAIRS} == {a.name for a in of(Avoider)}


@pytest.mark.by_day(7)
@pytest.mark.parametrize(("avoider", "vehicle", "controller"), SOME, ids=lambda c: c.name)
def test_they_can_be_simulated_together(avoider: Avoider, vehicle: Vehicle, controller: Controller) -> None:
    campaign = load_document(document(avoider, vehicle, controller))
    assert check(campaign, catalogue()) == []
    problem = Problem(campaign, compiled=False)
    vectors = problem.vectors(np.array([[0.0], [0.5], [1.0]]))
    flown = problem.system.loop.simulate(vectors, problem.system.step, STEPS)
    status, reasons = problem.system.judge(flown.status, flown.when)
    assert status.tolist() == [OK] * 3, reasons
    assert np.isfinite(flown.costs).all()
    held = np.repeat(vectors[1:2], 2, axis=0)
    held[1, problem.paths["start.x"]] += 1e-3
    apart = problem.system.loop.simulate(held, problem.system.step, STEPS, traced=1).trace
    assert np.isfinite(apart).all()
