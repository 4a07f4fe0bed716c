"""A process keeps its last loops: a second run of a scenario generates and loads nothing twice."""

from __future__ import annotations

from typing import Any

import pytest

from tests.unit.cases import campaign, document
from worker.systems.closed_loop import assemble
from worker.systems.closed_loop.flights import Flights

NOISE = [{"component": "sensor_noise", "parameters": {"sigma": 0.01}}]


def plain(**changes: Any) -> Flights:
    return Flights(campaign(scenario__horizon=0.1, **changes), compiled=False, lanes=1)


def test_only_the_same_parts_share_a_loop() -> None:
    one = plain()
    assert plain(scenario__step=0.01, seed=7).loop is one.loop
    others = [
        plain(scenario__faults=NOISE),
        plain(scenario__avoider={"component": "none"}),
        plain(scenario__obstacles=document()["scenario"]["obstacles"] * 2),
        plain(scenario__guidance={"period": 0.1}),
        plain(objectives=[{"component": "goal_miss"}]),
    ]
    loops = {id(made.loop) for made in (one, *others)}
    assert len(loops) == 1 + len(others)
    assert assemble.shared(one.parts, 2, compiled=False) is not one.loop
    assert assemble.shared(one.parts, 1).compiled


def test_no_more_than_the_last_ones_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(assemble, "SHARED", 2)
    monkeypatch.setattr(assemble, "_SHARED", type(assemble._SHARED)())
    parts = plain().parts
    first, second = (assemble.shared(parts, lanes, compiled=False) for lanes in (1, 2))
    assert assemble.shared(parts, 1, compiled=False) is first
    assemble.shared(parts, 3, compiled=False)
    assert assemble.shared(parts, 1, compiled=False) is first
    assert assemble.shared(parts, 2, compiled=False) is not second, "it was used longest ago"
