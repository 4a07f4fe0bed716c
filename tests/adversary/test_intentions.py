"""What an author states as intended waives no violation: obstacles that arrive after the horizon or turn between steps,
with each condition of the encounter stated as intended, and with all of them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from campaigns import Campaign
from campaigns.results.verdict import VerdictWord
from tests.audited import audited, recorded
from tests.given.case_campaigns import CASE1, searching
from tests.given.corrupted_records import DIRECT, SQP, TURNING
from tests.given.sampled_stages import DRAWN
from worker.engine.stages.parts import encounter as parts
from worker.evidence.audit import limits
from worker.evidence.audit.judge import audit
from worker.evidence.verdicts import encounter
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

OBSTACLES = CASE1["scenario"]["obstacles"]
LATE = {
    "component": "moving_circle",
    "parameters": {"position": {"x": 6.0, "y": 19.0}, "goal": {"x": 6.0, "y": -10.0}, "speed": 1.0, "radius": 0.3},
}
"""It passes the goal after the horizon."""
ATTACKS: dict[str, dict[str, Any]] = {
    "closest approach": {
        "scenario__obstacles": [*OBSTACLES, LATE],
        "scenario__horizon": 10.5,
        "criterion__threshold": 0.8,
    },
    "sampling": {"scenario__obstacles": [*OBSTACLES, TURNING]},
}
"""By the check that bars "cleared"."""
CONDITIONS = ("closest_approach", "motion", "avoidance", "influence")


def asked(check: str, intended: list[str]) -> Campaign:
    stated = {"intended": dict.fromkeys(intended, "the mission ends at the goal")}
    return searching(DIRECT, SQP, encounter=stated, stages__certify={"samples": 60}, **ATTACKS[check])


BY_DAY = (
    ("closest approach", (CONDITIONS[0],)),
    ("closest approach", CONDITIONS),
    ("sampling", CONDITIONS),
)
"""The intention that would permit it, and all together."""


@pytest.fixture(autouse=True)
def fewer() -> Iterator[None]:
    """Few evaluations besides the sample are simulated on beyond the horizon."""
    with pytest.MonkeyPatch.context() as changed:
        changed.setattr(parts, "OTHERS", 100)
        changed.setattr(limits, "OTHERS", 100)
        yield


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    ("check", "intended"),
    [
        pytest.param(
            check, [*intended], id=f"{check}-{'+'.join(intended)}",
            marks=[] if (check, intended) in BY_DAY else [pytest.mark.nightly],
        )
        for check in ATTACKS
        for intended in (*((each,) for each in CONDITIONS), CONDITIONS)
    ],
)  # fmt: skip
def test_no_intention_clears_what_comes_after_the_horizon_or_between_steps(check: str, intended: list[str]) -> None:
    campaign, store = asked(check, intended), MemoryStore(sample_seed=DRAWN)
    conclusion = execute(campaign, store, threads=1)
    assert conclusion.verdict is VerdictWord.INCONCLUSIVE
    assert [found.code for found in conclusion.checks if not found.ok] == [check]
    audited(store, campaign)


@pytest.mark.nightly
def test_the_audit_refuses_a_verdict_by_which_a_violation_beyond_the_horizon_is_intended(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    campaign, store = asked("closest approach", ["closest_approach"]), MemoryStore(sample_seed=DRAWN)
    monkeypatch.setattr(encounter, "_permitted", lambda *_: True)
    assert execute(campaign, store, threads=1).verdict is VerdictWord.CLEARED
    monkeypatch.undo()
    wrong = [item.name for item in audit(recorded(store, campaign)) if item.agrees is False]
    assert {"verdict", "checks.closest approach"} <= {*wrong}
