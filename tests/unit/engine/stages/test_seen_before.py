"""A finding of the baseline is compared only if flights of this campaign show what those of the baseline did."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.claims.stages.earlier_run import unknown_calls
from campaigns.results.baselines import with_baseline
from campaigns.results.finding import ClosestApproach
from tests.given import verdict_evidence as given
from tests.given.case_campaigns import campaign, document
from worker.engine.stages import baseline
from worker.evidence.audit import limits, reevaluation

NOISE: Any = [{"component": "sensor_noise"}]

CASES = {
    "the same": ({}, {}, True),
    "more seeds": ({"seeds": [3]}, {"seeds": [1, 3]}, True),
    "fewer seeds": ({"seeds": [1, 3]}, {"seeds": [3]}, False),
    "another seed": ({"seeds": [3]}, {"seeds": [4]}, False),
    "averaged": ({"seeds": [1, 3]}, {"seeds": [1, 3], "combine": "mean"}, False),
    "averaged in both": ({"seeds": [1, 3], "combine": "mean"}, {"seeds": [3, 1], "combine": "mean"}, True),
    "averaged over more": ({"seeds": [3], "combine": "mean"}, {"seeds": [1, 3], "combine": "mean"}, False),
    "averaged before": ({"seeds": [1, 3], "combine": "mean"}, {"seeds": [1, 3]}, True),
}


def compared(before: Any, now: Any, time: float | None, random: bool = True, drawn: int | None = None) -> bool:
    """By the stage; the audit has the same rule."""
    found = given.finding(0.4).model_copy(update={"closest": ClosestApproach(time=time, at="inside")})
    later = with_baseline(now, "R-0001", before, [found])
    assert later.baseline is not None
    case = later.baseline.cases[0].model_copy(update={"realisation": drawn})
    seen = not [*baseline._unseen(later, case, random)]
    run: Any = SimpleNamespace(campaign=later, random=["faults.0.seed"] if random else [], wording=limits.EACH)
    assert reevaluation.looked(run, case) == seen
    return seen


@pytest.mark.parametrize("name", CASES)
def test_by_the_noise(name: str) -> None:
    before, now, seen = CASES[name]
    one, other = (campaign(scenario__faults=NOISE, scenario__realisations=r) for r in (before, now))
    assert compared(one, other, 2.0) is seen
    assert compared(one, other, 2.0, random=False), "without noise seeds have no effect"
    assert compared(one, other, 2.0, drawn=7), "a finding with its own noise is evaluated with that"


@pytest.mark.parametrize(
    ("before", "now", "time", "seen"),
    [
        (9.0, 9.0, 3.0, True),
        (9.0, 12.0, 3.0, True),
        (9.0, 5.0, 3.0, True),
        (9.0, 2.0, 3.0, False),
        (9.0, 5.0, None, False),
        (9.0, 9.0, None, True),
    ],
)
def test_by_the_horizon(before: float, now: float, time: float | None, seen: bool) -> None:
    assert compared(campaign(scenario__horizon=before), campaign(scenario__horizon=now), time) is seen


def test_a_baseline_of_an_earlier_version_states_neither() -> None:
    made = with_baseline(campaign(scenario__horizon=2.0), "R-0001", campaign(), [given.finding(0.4)])
    assert made.baseline is not None
    (case,) = (one.model_copy(update={"time": None}) for one in made.baseline.cases)
    older = made.model_copy(
        update={"baseline": made.baseline.model_copy(update={"horizon": None, "realisations": None, "cases": [case]})}
    )
    assert not [*baseline._unseen(older, case, random=True)]


QUANTILE: Any = {"count": 20, "combine": "quantile"}
CALLS: dict[str, tuple[Any, Any, bool]] = {
    "one call each": (None, None, True),
    "as many": ({"count": 20}, {"count": 20}, True),
    "more": ({"count": 20}, {"count": 40}, True),
    "fewer": ({"count": 200}, {"count": 2}, False),
    "one": ({"count": 2}, None, False),
    "averaged": ({"count": 20}, {"count": 20, "combine": "mean"}, False),
    "one, then averaged": (None, {"count": 5, "combine": "mean"}, False),
    "averaged in both": ({"count": 5, "combine": "mean"}, {"count": 9, "combine": "mean"}, True),
    "averaged before": ({"count": 5, "combine": "mean"}, {"count": 5}, True),
    "another quantile": (QUANTILE | {"quantile": 0.1}, QUANTILE | {"quantile": 0.5}, False),
    "the worst of fewer": ({"count": 20, "combine": "mean"}, {"count": 5}, False),
}  # fmt: skip


@pytest.mark.parametrize("name", CALLS)
def test_by_the_calls_of_a_simulator(name: str) -> None:
    then, now, seen = CALLS[name]
    assert compared(simulated(then), simulated(now), None) is seen


def test_combined_otherwise_is_stated_with_what_differs() -> None:
    made = with_baseline(
        simulated(CALLS["another quantile"][1]), "R-0001", simulated(CALLS["another quantile"][0]), [given.finding(0.4)]
    )
    assert made.baseline is not None
    (why,) = baseline._unseen(made, made.baseline.cases[0], False)
    assert [why.count(each) for each in ("quantile 0.1;", "quantile 0.5,")] == [1, 1]


def simulated(repeats: Any) -> Campaign:
    asked = document()
    del asked["scenario"]
    asked["simulator"] = {"name": "drop"} | ({"repeats": repeats} if repeats else {})
    return load_document(asked | {"criterion": {"result": "d_min", "threshold": 0.5}})


def test_of_a_simulator_the_calls_of_an_earlier_version_are_not_known() -> None:
    made = with_baseline(simulated(None), "R-0001", simulated(None), [given.finding(0.4)])
    assert made.baseline is not None
    older = made.model_copy(update={"baseline": made.baseline.model_copy(update={"repeats": None})})
    assert [*baseline._unseen(older, made.baseline.cases[0], False)] == [unknown_calls("R-0001")]
