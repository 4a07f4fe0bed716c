"""Evaluations besides the sample are simulated on beyond the horizon: those that are far from each other."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from campaigns import Campaign, rules
from campaigns.results.validate import Beyond, ValidateResult
from campaigns.results.verdict import VerdictWord
from tests.audited import audited
from tests.given.beyond_horizon import travelling
from tests.given.case_campaigns import searching
from tests.given.corrupted_records import DIRECT, SQP, counting
from tests.given.sampled_stages import DRAWN
from worker.engine.stages.parts import encounter
from worker.evidence.audit import limits
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore


def test_those_that_are_chosen_are_far_from_each_other() -> None:
    corners = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]])
    inside = np.random.default_rng(1).uniform(0.4, 0.6, (500, 2))
    points = np.concatenate([inside, corners])
    chosen = encounter.apart(points, 5)
    assert set(chosen) == {0, 500, 501, 502, 503}
    assert encounter.apart(points, 5) == chosen == sorted(chosen)
    assert encounter.apart(points, 504) == encounter.apart(points, 1000) == [*range(504)]
    many = encounter.apart(points[[0] * 50], 7)
    assert len(set(many)) == 7, "of equal points, too, so many are chosen as are requested"


def test_of_very_many_some_are_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(encounter, "MOST", 60)
    chosen = encounter.apart(np.random.default_rng(1).random((500, 3)), 20)
    assert len(set(chosen)) == 20
    assert max(chosen) < 500
    assert {k % 9 for k in chosen} == {0}


def blind(**changes: Any) -> Campaign:
    """Two posts on a line; the vehicle goes blind after the first one. Draws lie in the middle of the bounds of its
    goal, from where nothing is met; from their ends the second post is hit after the horizon."""
    posts = [((1.1, 1.7), 0.5), ((5.4, 3.9), 0.5)]
    obstacles = [
        {"component": "circle", "parameters": {"position": {"x": x, "y": y}, "radius": r}} for (x, y), r in posts
    ]
    narrow = {"kind": "truncated_normal", "mean": 6.0, "deviation": 0.2}
    return searching(
        DIRECT, SQP, scenario__obstacles=obstacles, scenario__horizon=2.0,
        scenario__faults=[{"component": "blackout", "parameters": {"at": 1.99, "duration": 60.0}}],
        uncertain={
            "vehicle.m": {"plus_minus": "20%", "unit": "kg"}, "vehicle.J": {"plus_minus": "20%"},
            "goal.x": {"low": 5.0, "high": 8.0, "distribution": narrow},
        },
        stages__certify={"samples": 60}, **changes,
    )  # fmt: skip


def later(store: MemoryStore) -> Beyond:
    result = store.stages[-1].result
    assert isinstance(result, ValidateResult)
    assert result.encounter.beyond is not None
    return result.encounter.beyond


@pytest.fixture
def usual(monkeypatch: pytest.MonkeyPatch) -> None:
    """As many evaluations besides the sample are simulated on as in a run."""
    for module in (encounter, limits):
        monkeypatch.setattr(module, "OTHERS", rules.OTHERS.value)


@pytest.mark.usefixtures("usual")
def test_what_only_flights_of_a_search_meet_after_the_horizon_is_not_cleared() -> None:
    campaign, store = blind(), MemoryStore(sample_seed=DRAWN)
    conclusion = execute(campaign, store, threads=1)
    assert conclusion.verdict is VerdictWord.INCONCLUSIVE
    assert [found.code for found in conclusion.checks if not found.ok] == ["closest approach"]
    found = later(store)
    assert found.not_continued == 0
    assert found.lowest is not None
    assert found.lowest.value < 0.5
    assert "of the sample" not in found.lowest.name
    audited(store, campaign)


@pytest.mark.parametrize("intended", [{}, {"closest_approach": "elsewhere"}])
def test_what_a_vehicle_that_is_still_under_way_would_come_to_is_not_cleared(intended: dict[str, str]) -> None:
    """It goes on to a far goal, 15 horizons away; the obstacle is on its line after two more."""
    post = {"component": "circle", "parameters": {"position": {"x": 39.2, "y": 46.5}, "radius": 0.3}}
    campaign = travelling(post, encounter={"intended": intended}, stages__certify={"samples": 60})
    store = MemoryStore(sample_seed=DRAWN)
    conclusion = execute(campaign, store, threads=1)
    assert "closest approach" in [found.code for found in conclusion.checks if not found.ok]
    found = later(store).unknown
    assert found is not None
    assert found.vehicle
    assert found.value < 1.0
    audited(store, campaign)


def test_how_many_are_not_simulated_on_is_stated(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(encounter, "OTHERS", 30)
    monkeypatch.setattr(limits, "OTHERS", 30)
    campaign, store = searching(DIRECT, SQP, stages__certify={"samples": 60}), MemoryStore(sample_seed=DRAWN)
    conclusion = execute(campaign, store, threads=1)
    found, succeeded = later(store), conclusion.evaluations.succeeded
    assert conclusion.verdict is VerdictWord.CLEARED
    assert found.flights == 1 + len(store.findings) + 60 + 30
    assert found.not_continued == succeeded - 60 - 30
    (stated,) = (check for check in conclusion.checks if check.code == "closest approach")
    assert stated.values["not_continued"] == found.not_continued
    assert "continued" not in conclusion.values, "all flights of the sample are simulated on"
    audited(store, campaign)


@pytest.mark.usefixtures("usual")
@pytest.mark.nightly
def test_of_a_counted_sample_those_that_are_not_stored_are_among_them() -> None:
    campaign, store = counting(3500), MemoryStore(sample_seed=DRAWN)
    conclusion = execute(campaign, store, threads=1)
    blocks = next(record.result.counted for record in store.stages if record.result and record.result.counted)
    assert later(store).not_continued == blocks.beside.evaluations > 0
    assert conclusion.values["continued"] == later(store).flights
