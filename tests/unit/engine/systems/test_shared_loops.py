"""A process keeps its last loops: a second run of a scenario generates and loads nothing twice."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

from tests.given.case_campaigns import campaign, document
from worker.engine.kernels import maths
from worker.engine.systems.closed_loop import assemble
from worker.engine.systems.closed_loop.flights import Flights
from worker.running.opening import opened

MASSES = (4.6, 4.8, 5.1, 5.3)

NOISE = [{"component": "sensor_noise", "parameters": {"sigma": 0.01}}]


def plain(**changes: Any) -> Flights:
    return opened.flights(campaign(scenario__horizon=0.1, **changes), compiled=False, lanes=1)


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


def test_a_loop_whose_code_uses_something_that_changed_is_made_again(monkeypatch: pytest.MonkeyPatch) -> None:
    one = plain()
    before = one.loop.digest
    assert plain().loop is one.loop
    # As in a notebook, where a constant is changed and the component stays.
    monkeypatch.setattr(maths, "PI", 3.0)
    changed = plain()
    assert changed.loop is not one.loop
    assert changed.loop.digest != before == one.loop.digest


def test_only_the_loops_used_last_are_stored(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(assemble, "SHARED", 2)
    monkeypatch.setattr(assemble, "_SHARED", type(assemble._SHARED)())
    parts = plain().parts
    first, second = (assemble.shared(parts, lanes, compiled=False) for lanes in (1, 2))
    assert assemble.shared(parts, 1, compiled=False) is first
    assemble.shared(parts, 3, compiled=False)
    assert assemble.shared(parts, 1, compiled=False) is first
    assert assemble.shared(parts, 2, compiled=False) is not second, "it was used longest ago"


def test_threads_that_ask_at_the_same_time_share_one_and_get_their_own_results(monkeypatch: pytest.MonkeyPatch) -> None:
    alone = [plain(scenario__vehicle__parameters__m=m) for m in MASSES]
    expected = [made.simulate_vectors(made.nominal[None])[0].costs for made in alone]
    monkeypatch.setattr(assemble, "_SHARED", type(assemble._SHARED)())
    ready = threading.Barrier(len(MASSES))

    def fly(m: float) -> tuple[Flights, Any]:
        ready.wait()
        made = plain(scenario__vehicle__parameters__m=m)
        return made, made.simulate_vectors(made.nominal[None])[0].costs

    with ThreadPoolExecutor(len(MASSES)) as threads:
        found = list(threads.map(fly, MASSES))
    assert len({id(made.loop) for made, _ in found}) == 1
    assert [costs.tolist() for _, costs in found] == [costs.tolist() for costs in expected]
    assert len({costs.tobytes() for costs in expected}) == len(MASSES), "the mass changes the cost"
