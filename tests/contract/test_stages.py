"""What every stage is held to: a plan can name it, and its result is one of those that a run may store."""

from __future__ import annotations

from typing import Any, get_args

import pytest

from campaigns.asked.plan import StageKind, plan
from campaigns.results import StageResult
from tests.unit.cases import campaign
from worker.stages.found import stages
from worker.stages.parts.outcome import Stage

MEMBERS = get_args(get_args(StageResult)[0])
EACH = pytest.mark.parametrize("stage", stages().values(), ids=lambda s: s.kind)


@EACH
def test_a_plan_can_name_it(stage: Stage) -> None:
    asked: dict[str, Any] = {
        "sensitivity": {"points": 3},
        "search": [{"method": "direct", "evaluations": 1}],
        "certify": {"samples": 1},
    }
    assert stage.kind in {planned.kind for planned in plan(campaign(stages=asked))}


@EACH
def test_its_result_is_one_that_a_run_may_store_and_says_of_which_stage_it_is(stage: Stage) -> None:
    assert stage.result in MEMBERS
    field = stage.result.model_fields["stage"]
    assert get_args(field.annotation) == (stage.kind,)
    assert field.default == stage.kind, "the worker need not give it"


def test_every_kind_that_a_plan_names_and_every_result_has_its_stage() -> None:
    assert stages().keys() == set(get_args(StageKind))
    assert {stage.result for stage in stages().values()} == set(MEMBERS)
    assert len(MEMBERS) == len(stages())
