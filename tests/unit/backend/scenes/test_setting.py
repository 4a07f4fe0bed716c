"""What a view takes from the campaign of its run."""

from __future__ import annotations

from typing import Any

import pytest

from backend.scenes.base.setting import searches
from campaigns import Campaign
from campaigns.stages.plan import plan
from tests.given.small_catalogue import campaign

BASELINE: dict[str, Any] = {
    "run": "R-0001",
    "digest": "0" * 64,
    "threshold": 1.0,
    "cases": [{"label": "F1", "parameters": {"vehicle.m": 1.0}, "cost": 0.5}],
}


@pytest.mark.parametrize("baseline", [None, BASELINE])
@pytest.mark.parametrize("sensitivity", [None, {}])
def test_a_search_is_drawn_from_its_own_stage(baseline: Any, sensitivity: Any) -> None:
    document: dict[str, Any] = campaign()
    budgets = [{"method": method, "evaluations": 100} for method in ("direct", "auto")]
    document["stages"] |= {"sensitivity": sensitivity, "search": budgets}
    asked = Campaign.model_validate(document | {"baseline": baseline})
    drawn = [(position, name) for position, name, _ in searches(asked, None)]
    assert drawn == [(k, stage.method) for k, stage in enumerate(plan(asked)) if stage.kind == "search"]
