"""What the nominal flight of case 1 meets beyond its horizon."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from campaigns import Campaign
from campaigns.results.validate import Beyond
from clearance.testing.problems import Problem
from tests.given.case_campaigns import campaign
from worker.engine.systems import optional
from worker.engine.systems.closed_loop.trace import trace

HORIZON, STEP, KNOWN = 9.0, 0.02, 0.9
GOAL = (6.0, 7.0)
"""The unicycle of case 1 is near it when the horizon ends."""


TRAVELS = 0.04
"""The step of a vehicle that is under way [s]; near its goal it would be unstable with that."""


def place(x: float, y: float) -> dict[str, float]:
    return {"x": x, "y": y}


def beyond(component: str, criterion: str = "separation", **parameters: Any) -> Beyond:
    """What the nominal case meets with this obstacle besides that of case 1."""
    return met(scene(component, criterion, **parameters))


def scene(component: str, criterion: str = "separation", **parameters: Any) -> Campaign:
    """Case 1 with this obstacle besides its own, and another step."""
    fixed = {"component": "circle", "parameters": {"position": place(4.0, 4.0), "radius": 0.5}}
    moving = {"component": component, "parameters": parameters | {"radius": 0.1}}
    return campaign(
        scenario__obstacles=[fixed, moving], scenario__horizon=HORIZON, scenario__step=STEP,
        scenario__guidance={"period": STEP}, criterion__component=criterion,
        criterion__from_centre=criterion == "separation",
        scenario__vehicle__parameters__J=0.5,  # stable with that step
        stages__search=[{"method": "direct", "evaluations": 50}],
    )  # fmt: skip


def met(made: Campaign) -> Beyond:
    """What the nominal case of a campaign meets."""
    problem = Problem(made, compiled=False)
    vectors = problem.vectors(problem.nominal_point[None, :])
    found = optional.beyond(problem.system, ["nominal"], vectors, [None], KNOWN, lambda: False)
    assert found is not None
    assert found.flights == 1
    return found


def travelling(*obstacles: dict[str, Any], **changes: Any) -> Campaign:
    """Case 1 with a goal so far away that the vehicle is under way when the horizon ends."""
    behind = {"component": "circle", "parameters": {"position": place(4.0, -60.0), "radius": 0.3}}
    far = {
        "scenario__obstacles": [behind, *obstacles], "scenario__horizon": 5.0, "scenario__step": TRAVELS,
        "scenario__guidance": {"period": TRAVELS}, "criterion__component": "surface_separation",
        "criterion__threshold": 0.1, "scenario__goal": place(600.0, 700.0), "scenario__vehicle__parameters__J": 0.5,
        "scenario__avoider__parameters__k_att": 0.05, "scenario__avoider__parameters__k_rep": 0.3,
        "stages__search": [{"method": "direct", "evaluations": 50}],
    }  # fmt: skip
    return campaign(**far | changes)


@cache
def under_way() -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Place and velocity of that vehicle after twice its horizon."""
    longer = Problem(travelling(scenario__horizon=10.0), compiled=False)
    path = trace(longer.system, "nominal", {}).data  # type: ignore[arg-type]
    return path[-1, 1:3], (path[-1, 1:3] - path[-2, 1:3]) / TRAVELS
