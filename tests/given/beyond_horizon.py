"""What the nominal flight of case 1 meets beyond its horizon."""

from __future__ import annotations

from typing import Any

from campaigns.results.validate import Beyond
from clearance.testing.problems import Problem
from tests.given.case_campaigns import campaign
from worker.engine.systems import optional

HORIZON, STEP, KNOWN = 9.0, 0.02, 0.9
GOAL = (6.0, 7.0)
"""The unicycle of case 1 is near it when the horizon ends."""


def place(x: float, y: float) -> dict[str, float]:
    return {"x": x, "y": y}


def beyond(component: str, criterion: str = "separation", **parameters: Any) -> Beyond:
    """What the nominal case meets with this obstacle besides that of case 1."""
    fixed = {"component": "circle", "parameters": {"position": place(4.0, 4.0), "radius": 0.5}}
    moving = {"component": component, "parameters": parameters | {"radius": 0.1}}
    made = campaign(
        scenario__obstacles=[fixed, moving], scenario__horizon=HORIZON, scenario__step=STEP,
        scenario__guidance={"period": STEP}, criterion__component=criterion,
        criterion__from_centre=criterion == "separation",
        scenario__vehicle__parameters__J=0.5,  # stable with that step
        stages__search=[{"method": "direct", "evaluations": 50}],
    )  # fmt: skip
    problem = Problem(made, compiled=False)
    vectors = problem.vectors(problem.nominal_point[None, :])
    found = optional.beyond(problem.system, ["nominal"], vectors, [None], KNOWN, lambda: False)
    assert found is not None
    assert found.flights == 1
    return found
