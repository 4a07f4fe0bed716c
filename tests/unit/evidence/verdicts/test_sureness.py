"""How sure a search is: where there is an estimate, and what it says of searches that differ."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from campaigns.claims import sureness as templates
from campaigns.results.base import FAILED, OK
from campaigns.results.sureness import Sureness
from campaigns.stages.nominal import NominalResult
from clearance.testing.problems import Problem
from tests.given.case_campaigns import searching
from tests.given.stated_facts import facts
from tests.given.timed_simulators import measured
from tests.given.verdict_evidence import NOMINAL, changed, concluded, nominal
from worker.evidence.audit import sureness as audited
from worker.evidence.verdicts import sureness as module
from worker.evidence.verdicts.sureness import FEW, FORMER, FORMER_LOW, LOW, MODEL, Model, Stored, chance, sureness

BUDGET = 400
AUTO = {"method": "auto", "evaluations": BUDGET}
"""200 evaluations for each of the two parameters."""


def costs(as_low: int, evaluations: int = BUDGET) -> Any:
    """Costs of a search with so many evaluations at its lowest."""
    return np.where(np.arange(evaluations) < as_low, 0.5, np.linspace(0.8, 2.0, evaluations))


def estimated(
    *requests: dict[str, Any], first: NominalResult | None = None, found: Any = None, **changes: Any
) -> Sureness | None:
    campaign = searching(*(requests or [AUTO]), **changes)
    ranked = costs(30) if found is None else found
    stored = {2: Stored(ranked[:, None], np.where(np.isfinite(ranked), OK, FAILED).astype(np.uint8))}
    return sureness(Problem(campaign), [first or nominal()], stored)


def in_slots(slots: int, start: float | None) -> NominalResult:
    """Of a simulator that was measured in so many slots; without a start it was called in the worker's own process."""
    return changed(nominal(), measured=measured(slots=slots, start_seconds=start))


def test_there_is_one_where_calls_follow_each_other_in_one_process() -> None:
    for alone in ({"first": in_slots(1, None)}, {"first": changed(nominal(), measured=measured(slots=None))}):
        assert estimated(**alone) == estimated() is not None
    assert estimated(AUTO | {"options": {"at_once": 1}}) == estimated()


def test_the_estimate_and_its_sentence() -> None:
    found = estimated()
    assert found is not None
    assert found.lower == pytest.approx(0.01 * (NOMINAL - 0.5))
    assert found.chance == pytest.approx(chance(costs(30), NOMINAL, LOW))
    assert LOW.parameters is not None
    rounded = [float(f"{found.lower:.3g}"), float(f"{found.chance:.2g}"), LOW.landscapes, LOW.parameters[0]]
    assert facts(found.statement) == rounded
    assert "not a bound" in found.text


def test_the_sentence_states_how_many_parameters_the_landscapes_have() -> None:
    """Also where the run has others: two parameters are judged by three, four by five and more."""
    for of, stated in ((LOW, [324, 3]), (MODEL, [696, 5, 18])):
        assert facts(templates.sureness(0.1, 0.01, "m", of.landscapes, of.parameters))[2:] == stated
    found = estimated()
    assert found is not None
    assert facts(found.statement)[2:] == [324, 3]


@pytest.mark.parametrize("by", [LOW, MODEL])
def test_the_more_evaluations_are_as_low_as_the_lowest_the_surer_it_is(by: Model) -> None:
    counts = (1, 3, 10, 30, 100, 300)
    stated = [chance(costs(as_low), NOMINAL, by) for as_low in counts]
    told = 1 + counts.index(by.enough)
    assert stated[:told] == sorted(set(stated[:told]), reverse=True)
    assert set(stated[told:]) == {stated[told - 1]}
    assert stated[0] == pytest.approx(1 / (1 + np.exp(-by.constant)))
    assert 0.07 < chance(costs(30), NOMINAL, MODEL) < 0.13


def test_few_parameters_have_coefficients_of_their_own() -> None:
    assert [module.model(n) for n in (2, FEW, FEW + 1, 20)] == [LOW, LOW, MODEL, MODEL]


@pytest.mark.parametrize(
    ("parameters", "landscapes", "expected"),
    [
        (2, None, LOW),
        (2, FORMER.landscapes, FORMER),
        (2, FORMER_LOW.landscapes, FORMER_LOW),
        (4, FORMER.landscapes, FORMER),
        (4, FORMER_LOW.landscapes, MODEL),
        (4, LOW.landscapes, MODEL),
        (2, MODEL.landscapes, LOW),
    ],
)
def test_records_of_earlier_versions_keep_their_coefficients(
    parameters: int, landscapes: int | None, expected: Model
) -> None:
    assert module.model(parameters, landscapes) == expected


def test_failed_evaluations_are_never_the_lowest() -> None:
    with_failures = costs(30)
    with_failures[-50:] = np.inf
    found = estimated(found=with_failures)
    assert found is not None
    assert found.chance == pytest.approx(chance(costs(30), NOMINAL, LOW))


@pytest.mark.parametrize(
    ("requests", "changes"),
    [
        ([{"method": "direct", "evaluations": BUDGET}], {}),
        ([AUTO, AUTO], {}),
        ([AUTO, {"method": "sqp", "evaluations": 100}], {}),
        ([AUTO | {"options": {"seconds": 0.5}}], {}),
        ([AUTO | {"options": {"at_once": 2}}], {}),
        ([AUTO], {"first": in_slots(2, 0.1)}),
        ([AUTO], {"first": in_slots(1, 0.0)}),
        ([AUTO | {"evaluations": 60}], {"found": costs(30, 60)}),
        ([AUTO], {"objectives": [{"component": "time_to_goal"}]}),
        ([AUTO], {"first": nominal(None, "it failed")}),
        ([AUTO], {"first": nominal(0.5)}),
        ([AUTO], {"found": np.full(BUDGET, np.inf)}),
    ],
    ids=["method", "two", "another one", "costly", "at once", "slots", "one slot", "few", "criteria", "nominal",
         "nothing lower", "all failed"],
)  # fmt: skip
def test_there_is_none_of_what_it_was_not_set_on(requests: list[dict[str, Any]], changes: dict[str, Any]) -> None:
    assert estimated(*requests, **changes) is None


def test_there_is_none_where_another_stage_has_found_a_case_lower_by_so_much() -> None:
    search, ok = Stored(costs(30)[:, None], np.zeros(BUDGET, dtype=np.uint8)), np.zeros(1, dtype=np.uint8)
    lower = 0.01 * (NOMINAL - 0.5)

    def beside(cost: float) -> Sureness | None:
        problem = Problem(searching(AUTO))
        return sureness(problem, [nominal()], {1: Stored(np.array([[cost]]), ok), 2: search})

    assert beside(0.5 - 0.9 * lower) == estimated()
    assert beside(0.5 - 1.1 * lower) is None


def test_there_is_none_of_a_search_that_ended_early() -> None:
    campaign = searching(AUTO)
    stored = {2: Stored(costs(30)[:-1, None], np.zeros(BUDGET - 1, dtype=np.uint8))}
    assert sureness(Problem(campaign), [nominal()], stored) is None


@pytest.mark.parametrize(("lost", "stated"), [(BUDGET // 2, True), (BUDGET // 2 + 1, False)])
def test_there_is_none_where_more_than_half_has_no_value(lost: int, stated: bool) -> None:
    found = np.where(np.arange(BUDGET) < BUDGET - lost, costs(30), np.inf)
    assert (estimated(found=found) is not None) == stated


def test_it_enters_no_verdict() -> None:
    stated = Sureness(chance=0.99, lower=0.1, landscapes=10, statement=())
    without = concluded()
    sure = concluded(sureness=stated)
    assert sure.sureness == stated
    assert sure.model_copy(update={"sureness": None}) == without
    assert "sureness" not in without.model_dump()


def test_the_audit_has_the_same_coefficients() -> None:
    assert (MODEL[:4], LOW[:4], FEW) == (audited.MODEL, audited.LOW, audited.FEW)
    assert (FORMER[:4], FORMER_LOW[:4]) == (audited.FORMER, audited.FORMER_LOW)
    ends = tuple(zip(module.PARAMETERS, module.EVALUATIONS, strict=True))
    assert ends == (audited.FEWEST, audited.MOST)
